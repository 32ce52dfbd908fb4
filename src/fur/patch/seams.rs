//! Whether seams show: what a tile looks like on both sides of them, against the same inside patches.
//!
//! A window of 16 × 16 texels is laid along an edge on either side. Across a seam the two show different parts of the
//! tile. A *fake* border is an edge inside a patch, with its far side moved by a random offset. If seams can only be
//! seen as much as the randomness of the tile makes them, the mean squared difference between the windows' means is the
//! same for both. As blurring would pass this, the variance within windows along seams is set against that along edges
//! inside.

use super::face::Face;
use super::measure::{Edge, edges};
use crate::data::mesh::Mesh;
use crate::data::patches::Patches;
use crate::data::topology::Topology;
use crate::math::hash::{combine, unit_f32};
use crate::math::{DVec2, Vec2};
use rayon::prelude::*;

/// Texels along each side of a window.
const WINDOW: usize = 16;
/// Edges of each kind that are measured at most, spread evenly over the mesh.
const MOST_EDGES: usize = 20_000;

/// How much seams show; see the head of this file. Ratios are means over the three views, 1 where there is nothing to
/// compare.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeamStats {
    /// Seams measured.
    pub seams: usize,
    /// Mean squared difference across seams over that across fake borders: 1 is as random as the tile, less is better.
    pub difference: f64,
    /// Variance within windows along seams over that inside patches: 1 is as sharp as the rest.
    pub variance: f64,
}

/// Measures the seams of `patches` on `mesh` for tiles of `tile_edge_m` with `texels` along an edge.
///
/// `sample` gives what is seen at a coordinate of a triangle, in three views (say coverage or luminance at 0, 40 and
/// 60° to the normal).
pub fn measure_seams(
    mesh: &Mesh,
    patches: &Patches,
    tile_edge_m: f32,
    texels: u32,
    sample: impl Fn(u32, Vec2) -> [f32; 3] + Sync,
) -> SeamStats {
    let topology = Topology::new(&mesh.triangles, |v| mesh.position_class[v as usize]);
    let faces = Face::all(mesh);
    let texel_m = f64::from(tile_edge_m) / f64::from(texels.max(1));
    let usable = |edge: &Edge| edge.edges.iter().all(|&e| faces[e / 3].area_m2 > 0.0);
    let continued = |edge: &Edge| (0..2).all(|k| patches.uv[edge.ends[0][k]] == patches.uv[edge.ends[1][k]]);
    let (inside, seams): (Vec<Edge>, Vec<Edge>) = edges(&topology, patches).filter(usable).partition(continued);
    let compare = |edges: &[Edge], fake: bool| {
        let stride = edges.len().div_ceil(MOST_EDGES).max(1);
        let chosen: Vec<&Edge> = edges.iter().step_by(stride).collect();
        let sides = |edge: &&Edge| {
            let chance = combine(0x5ea3, edge.edges[0] as u64);
            let moved =
                if fake { Vec2::new(unit_f32(combine(chance, 0)), unit_f32(combine(chance, 1))) } else { Vec2::ZERO };
            let window = |side: usize, moved| window(&faces, patches, edge.edges[side], texel_m, moved, &sample);
            [window(0, Vec2::ZERO), window(1, moved)]
        };
        let windows: Vec<[Window; 2]> = chosen.par_iter().map(sides).collect();
        let count = windows.len().max(1) as f64;
        let difference = |v: usize| windows.iter().map(|[a, b]| (a.mean[v] - b.mean[v]).powi(2)).sum::<f64>() / count;
        let variance =
            |v: usize| windows.iter().map(|[a, b]| 0.5 * (a.variance[v] + b.variance[v])).sum::<f64>() / count;
        [[0, 1, 2].map(difference), [0, 1, 2].map(variance)]
    };
    let [seam_difference, seam_variance] = compare(&seams, false);
    let [fake_difference, inside_variance] = compare(&inside, true);
    let ratio = |a: [f64; 3], b: [f64; 3]| {
        if seams.is_empty() || b.contains(&0.0) {
            return 1.0;
        }
        (0..3).map(|v| a[v] / b[v]).sum::<f64>() / 3.0
    };
    SeamStats {
        seams: seams.len(),
        difference: ratio(seam_difference, fake_difference),
        variance: ratio(seam_variance, inside_variance),
    }
}

/// Mean and variance over a window, per view.
struct Window {
    mean: [f64; 3],
    variance: [f64; 3],
}

/// The window along edge `e` (`3 t + k`) inside its triangle's plane, around the edge's middle; where the triangle is
/// narrower, its map goes on.
fn window(
    faces: &[Face],
    patches: &Patches,
    e: usize,
    texel_m: f64,
    moved: Vec2,
    sample: &impl Fn(u32, Vec2) -> [f32; 3],
) -> Window {
    let (t, k) = (e / 3, e % 3);
    let flat = faces[t].corners_m();
    let uv = patches.triangles[t].map(|v| patches.uv[v as usize].as_dvec2());
    let [x, y] = faces[t].jacobian(uv).unwrap_or_default();
    let along = (flat[(k + 1) % 3] - flat[k]).normalize_or(DVec2::X);
    let inwards = DVec2::new(-along.y, along.x);
    let middle = 0.5 * (flat[k] + flat[(k + 1) % 3]);
    let (mut sum, mut squares) = ([0.0; 3], [0.0; 3]);
    for row in 0..WINDOW {
        for column in 0..WINDOW {
            let [i, j] = [column as f64 + 0.5 - 0.5 * WINDOW as f64, row as f64 + 0.5];
            let p = middle + (along * i + inwards * j) * texel_m;
            let seen = sample(t as u32, (uv[0] + x * p.x + y * p.y).as_vec2() + moved);
            for ((sum, square), value) in sum.iter_mut().zip(&mut squares).zip(seen.map(f64::from)) {
                *sum += value;
                *square += value * value;
            }
        }
    }
    let count = (WINDOW * WINDOW) as f64;
    let mean = sum.map(|s| s / count);
    Window { mean, variance: [0, 1, 2].map(|v| squares[v] / count - mean[v] * mean[v]) }
}
