//! Which edges of a coat may carry a fin, and what part of the texture each shows.

use crate::data::coat::{FinEdge, FinTexture};
use crate::math::Vec3;
use crate::math::hash::{combine, unit_f32};
use std::collections::BTreeMap;

/// A coat's surface as fins need it.
pub struct FinSurface<'a> {
    /// Coat vertex positions, m.
    pub positions_m: &'a [Vec3],
    /// Which coat vertices are one point.
    pub position_class: &'a [u32],
    /// Coat vertex indices.
    pub triangles: &'a [[u32; 3]],
}

/// A face beside an edge: the edge's coat vertices in the face's order, the vertex opposite, the face's area in m².
type Face = ([u32; 2], u32, f32);

/// One fin per edge of the welded surface, borders included; edges of no length are left out.
///
/// Each triangle gives a third of its area to each of its edges, so a fin's thickness is that area over the edge's
/// length and all fins together hold the coat once.
pub fn edges(surface: &FinSurface<'_>, texture: &FinTexture, seed: u64) -> Vec<FinEdge> {
    // Edge of the welded surface → its first sighting: coat vertices, opposite vertex, area; then a second face.
    let mut faces: BTreeMap<[u32; 2], Vec<Face>> = BTreeMap::new();
    for &[a, b, c] in surface.triangles {
        let [pa, pb, pc] = [a, b, c].map(|v| surface.positions_m[v as usize]);
        let area_m2 = 0.5 * (pb - pa).cross(pc - pa).length();
        for (from, to, opposite) in [(a, b, c), (b, c, a), (c, a, b)] {
            let classes = [from, to].map(|v| surface.position_class[v as usize]);
            let key = [classes[0].min(classes[1]), classes[0].max(classes[1])];
            faces.entry(key).or_default().push(([from, to], opposite, area_m2));
        }
    }
    let fin = |faces: &Vec<Face>| {
        let (ends, opposite, _) = faces[0];
        let length_m = surface.positions_m[ends[0] as usize].distance(surface.positions_m[ends[1] as usize]);
        if length_m <= 0.0 {
            return None;
        }
        let area_m2 = faces.iter().map(|f| f.2).sum::<f32>() / 3.0;
        // By place, so that the order of vertices does not matter.
        let mut places = ends.map(|v| surface.positions_m[v as usize].to_array().map(|x| (x + 0.0).to_bits()));
        places.sort_unstable();
        let start = unit_f32(places.as_flattened().iter().fold(seed, |key, &bits| combine(key, u64::from(bits))));
        Some(FinEdge {
            ends,
            opposite: [opposite, faces.get(1).map_or(opposite, |f| f.1)],
            u: [start, start + length_m / texture.width_m],
            thickness: area_m2 / length_m / texture.thickness_m,
        })
    };
    faces.values().filter_map(fin).collect()
}
