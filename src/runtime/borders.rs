//! Where a coat ends.

use super::draw_list::CoatMesh;
use crate::data::distance::along_edges;
use crate::math::Vec3;
use std::collections::HashMap;

/// Cosine between the faces beside an edge below which they are the two sides of a sheet.
const BACK: f32 = -0.98;

/// How far each coat vertex is from where the coat ends, along edges, m.
pub fn away_from_borders(furs: &[CoatMesh<'_>]) -> Vec<Vec<f32>> {
    // Places by the micrometre: what touches is drawn from nearly the same numbers.
    let mut places: HashMap<[i64; 3], usize> = HashMap::new();
    let mut at = Vec::new();
    let mut place = |p: Vec3| {
        *places.entry(p.to_array().map(|x| (f64::from(x) * 1e6).round() as i64)).or_insert_with(|| {
            at.push(p);
            at.len() - 1
        })
    };
    let of: Vec<Vec<usize>> = furs.iter().map(|fur| fur.positions_m.iter().map(|&p| place(p)).collect()).collect();
    let mut edges: HashMap<[usize; 2], Vec<Vec3>> = HashMap::new();
    for (fur, of) in furs.iter().zip(&of).filter(|(fur, _)| !fur.over_last) {
        for triangle in fur.triangles {
            let corners = triangle.map(|v| of[v as usize]);
            let [p, q, r] = corners.map(|place| at[place]);
            let normal = (q - p).cross(r - p).normalize_or_zero();
            for k in 0..3 {
                let [a, b] = [corners[k], corners[(k + 1) % 3]];
                edges.entry([a.min(b), a.max(b)]).or_default().push(normal);
            }
        }
    }
    // The two sides of a sheet end in each other.
    let ends = |normals: &[Vec3]| normals.iter().skip(1).all(|normal| normal.dot(normals[0]) <= BACK);
    let borders = edges.iter().filter(|(_, normals)| ends(normals)).flat_map(|(edge, _)| *edge);
    let away_m = along_edges(&at, edges.keys().copied(), borders);
    of.iter().map(|of| of.iter().map(|&place| away_m[place]).collect()).collect()
}
