//! How skin bends, and how the coat's outer side lies over it.

use super::draw_list::CoatMesh;
use crate::math::Vec3;
use std::collections::HashMap;

/// Cosines between the normals of both sides, and how far hair stands out of the outer one over how far out of the skin, at which the outer
/// one is folded, and at which it is not.
const AGREEMENT: [f32; 2] = [0.2, 0.6];

/// Unit normals of the coat's outer side at each vertex, outwards: where hair grows longer along the skin, it leans away from the skin's.
pub fn outer_normals(fur: &CoatMesh<'_>) -> Vec<Vec3> {
    let bits = |v: Vec3| v.to_array().map(|x| (x + 0.0).to_bits());
    // Vertices of one place whose skin is smooth share a normal, whichever patch they belong to.
    let key = |v: usize| [bits(fur.positions_m[v]), bits(fur.normals[v])];
    let mut sums: HashMap<[[u32; 3]; 2], Vec3> = HashMap::new();
    for triangle in fur.triangles {
        let corners = triangle.map(|v| v as usize);
        let [a, b, c] = corners.map(|v| fur.positions_m[v] + fur.offsets_m[v]);
        let face = (b - a).cross(c - a);
        let outwards = face * face.dot(corners.iter().map(|&v| fur.offsets_m[v]).sum()).signum();
        for v in corners {
            *sums.entry(key(v)).or_default() += outwards;
        }
    }
    let normal = |v: usize| {
        let outer = sums.get(&key(v)).map_or(Vec3::ZERO, |sum| sum.normalize_or_zero());
        // Folds say nothing, nor do slabs along which hair lies.
        let [least, most] = AGREEMENT;
        let upright_m = fur.normals[v].dot(fur.offsets_m[v]).max(f32::MIN_POSITIVE);
        let agreement = outer.dot(fur.normals[v]).min(outer.dot(fur.offsets_m[v]) / upright_m);
        let share = ((agreement - least) / (most - least)).clamp(0.0, 1.0);
        fur.normals[v].lerp(outer, share).normalize_or(fur.normals[v])
    };
    (0..fur.normals.len()).map(normal).collect()
}

/// Sum of the principal curvatures at each coat vertex, 1/m, outwards positive: what the normal changes by along the triangles around it.
pub fn bends_per_m(fur: &CoatMesh<'_>) -> Vec<f32> {
    let mut sums = vec![[0.0_f32; 2]; fur.positions_m.len()];
    for triangle in fur.triangles {
        let [a, b, c] = triangle.map(|v| v as usize);
        let edges = [b, c].map(|v| fur.positions_m[v] - fur.positions_m[a]);
        let turns = [b, c].map(|v| fur.normals[v] - fur.normals[a]);
        let face = edges[0].cross(edges[1]);
        let area2 = face.length_squared();
        if area2 > 0.0 {
            // The trace of the map that takes edges to turns, by the edges' dual basis.
            let duals = [edges[1].cross(face), face.cross(edges[0])];
            let bend = (turns[0].dot(duals[0]) + turns[1].dot(duals[1])) / area2;
            for v in [a, b, c] {
                sums[v] = [sums[v][0] + bend * area2.sqrt(), sums[v][1] + area2.sqrt()];
            }
        }
    }
    sums.into_iter().map(|[sum, weight]| if weight > 0.0 { sum / weight } else { 0.0 }).collect()
}

/// Length of an edge of the coat's outer side, m: the median.
pub fn outer_edge_m(fur: &CoatMesh<'_>) -> f32 {
    let tip = |v: u32| fur.positions_m[v as usize] + fur.offsets_m[v as usize];
    let lengths = |t: &[u32; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]].map(|[a, b]| tip(a).distance(tip(b)));
    let mut lengths: Vec<f32> = fur.triangles.iter().flat_map(lengths).collect();
    let middle = lengths.len() / 2;
    if lengths.is_empty() { 0.0 } else { *lengths.select_nth_unstable_by(middle, f32::total_cmp).1 }
}
