//! Where in its tile each patch lies.
//!
//! Any offset is as good as another for the patch itself. But all patches run along the comb at the same scale: where
//! two meet, an offset exists at which the texture goes on across most of the border. Crumbs vanish that way.

use crate::data::mesh::Mesh;
use crate::data::patches::Patches;
use crate::data::topology::Topology;
use crate::fur::patch::measure::{Edge, seams};
use crate::math::hash::{combine, unit_f32};
use crate::math::{DVec2, Vec2};

/// Moves each patch, the largest first, to where it fits those before it best: by the mean step across their common
/// borders, each weighted by its length and taken round the tile. A patch without settled neighbours gets a place by
/// chance.
pub(super) fn settle(mesh: &Mesh, topology: &Topology, seed: u64, patches: &mut Patches) {
    let count = patches.patch.iter().max().map_or(0, |&p| p as usize + 1);
    let mut faces = vec![0_usize; count];
    for triangle in &patches.triangles {
        faces[patches.patch[triangle[0] as usize] as usize] += 1;
    }
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by_key(|&p| (std::cmp::Reverse(faces[p]), p));
    let mut borders: Vec<Vec<Edge>> = vec![Vec::new(); count];
    for seam in seams(topology, patches) {
        let [a, b] = seam.ends.map(|ends| patches.patch[ends[0]] as usize);
        if a != b {
            borders[a].push(seam);
            borders[b].push(Edge { edges: [seam.edges[1], seam.edges[0]], ends: [seam.ends[1], seam.ends[0]] });
        }
    }
    let mut offsets: Vec<Option<Vec2>> = vec![None; count];
    for p in order {
        // Steps as points on a circle, one circle per axis: 0.1 and −0.9 are the same step.
        let (mut u, mut v) = (DVec2::ZERO, DVec2::ZERO);
        for border in &borders[p] {
            let there = patches.patch[border.ends[1][0]] as usize;
            let Some(moved) = offsets[there] else { continue };
            let [a, b] = border.ends[0].map(|c| mesh.positions_m[patches.base_vertex[c] as usize]);
            let middle = |ends: [usize; 2]| 0.5 * (patches.uv[ends[0]] + patches.uv[ends[1]]);
            let step = (middle(border.ends[1]) + moved - middle(border.ends[0])).as_dvec2() * std::f64::consts::TAU;
            let length = f64::from(a.distance(b));
            u += length * DVec2::new(libm::cos(step.x), libm::sin(step.x));
            v += length * DVec2::new(libm::cos(step.y), libm::sin(step.y));
        }
        let part = |sum: DVec2, chance: f32| {
            if sum == DVec2::ZERO { chance } else { (libm::atan2(sum.y, sum.x) / std::f64::consts::TAU) as f32 }
        };
        let chance = by_chance(seed, p as u64);
        offsets[p] = Some(Vec2::new(part(u, chance.x), part(v, chance.y)));
    }
    let placed = |offset: &dyn Fn(u32) -> Vec2| {
        patches.uv.iter().zip(&patches.patch).map(|(&uv, &p)| uv + offset(p)).collect::<Vec<_>>()
    };
    let settled = placed(&|p| offsets[p as usize].unwrap_or_default());
    patches.chance_uv = placed(&|p| by_chance(seed, u64::from(p)));
    patches.uv = settled;
}

/// A place in the tile for patch `p`.
fn by_chance(seed: u64, p: u64) -> Vec2 {
    let chance = combine(seed, p);
    Vec2::new(unit_f32(combine(chance, 0)), unit_f32(combine(chance, 1)))
}
