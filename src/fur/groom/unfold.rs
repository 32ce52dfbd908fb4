//! Combs hair apart that would cross its neighbours in creases (`docs/steps/groom.md`).
//!
//! Hair in a hollow narrower than it is long runs into itself. Real hair gives way: leans are averaged with those around them
//! until no prism of the shell turns inside out, and nowhere else. What cannot give way is as short as there is room.

use super::lean::Standing;
use crate::data::mesh::Mesh;
use crate::math::Vec3;
use rayon::prelude::*;

/// Least area of a prism at a height over its area on the skin.
const LEAST_AREA: f32 = 0.1;

/// Heights at which areas are tried, in shares of the hair's.
const TRIED: [f32; 3] = [1.0 / 3.0, 2.0 / 3.0, 1.0];

/// How often leans are averaged: three quarters of a scan's crossings are gone by then, and the rest go slowly.
const ROUNDS: usize = 60;

/// Rounds after which averaging reaches one ring of vertices further.
const ROUNDS_PER_RING: usize = 8;

/// Factor on lengths that still cross, and how often at most.
const SHORTER: f32 = 0.9;
const MOST_SHORTENINGS: usize = 16;

/// What stands around the places of a skin: vertices that differ by seams only are one.
struct SkinGraph<'a> {
    mesh: &'a Mesh,
    height_m: f32,
    triangles: Vec<[u32; 3]>,
    /// Neighbours of each vertex that stands for a place, each as often as triangles hold both.
    around: Vec<Vec<u32>>,
    /// Its triangles.
    of: Vec<Vec<u32>>,
}

/// Changes `lean`, and where that does not help `length`, so that hair `height_m` tall times its length does not cross.
/// `standing` is how hair may stand on the skin.
pub fn unfold(mesh: &Mesh, standing: &Standing, height_m: f32, lean: &mut [Vec3], length: &mut [f32]) {
    let triangles: Vec<[u32; 3]> = mesh.triangles.iter().map(|t| t.map(|v| mesh.position_class[v as usize])).collect();
    let mut around = vec![Vec::new(); lean.len()];
    let mut of = vec![Vec::new(); lean.len()];
    for (t, &[a, b, c]) in (0..).zip(&triangles) {
        for [v, p, q] in [[a, b, c], [b, c, a], [c, a, b]] {
            around[v as usize].extend([p, q]);
            of[v as usize].push(t);
        }
    }
    let skin = SkinGraph { mesh, height_m, triangles, around, of };
    let mut crossing = skin.crossing(&skin.triangles, lean, length);
    for round in 0..ROUNDS {
        if crossing.is_empty() {
            break;
        }
        let reached = skin.reached(&crossing, 1 + round / ROUNDS_PER_RING);
        let average = |&v: &u32| {
            let (own, around) = (lean[v as usize], &skin.around[v as usize]);
            let mean = around.iter().map(|&near| lean[near as usize]).sum::<Vec3>() / around.len() as f32;
            standing.raised(v as usize, v as usize, (own + mean).normalize_or(own))
        };
        let averages: Vec<Vec3> = reached.par_iter().map(average).collect();
        reached.iter().zip(averages).for_each(|(&v, average)| lean[v as usize] = average);
        crossing = skin.crossing(&skin.touched(&reached), lean, length);
    }
    for _ in 0..MOST_SHORTENINGS {
        if crossing.is_empty() {
            break;
        }
        let reached = skin.reached(&crossing, 0);
        reached.iter().for_each(|&v| length[v as usize] *= SHORTER);
        crossing = skin.crossing(&skin.touched(&reached), lean, length);
    }
    for (v, &class) in mesh.position_class.iter().enumerate() {
        (lean[v], length[v]) = (lean[class as usize], length[class as usize]);
    }
}

impl SkinGraph<'_> {
    /// Those of `triangles` over which hair crosses.
    fn crossing(&self, triangles: &[[u32; 3]], lean: &[Vec3], length: &[f32]) -> Vec<[u32; 3]> {
        let crosses = |corners: &[u32; 3]| {
            let corners = corners.map(|v| v as usize);
            let foot_m = corners.map(|v| self.mesh.positions_m[v]);
            let offset_m = corners.map(|v| lean[v] * (self.height_m * length[v]));
            let area = |t: f32| {
                let [p, q, r] = [0, 1, 2].map(|i| foot_m[i] + offset_m[i] * t);
                (q - p).cross(r - p)
            };
            let least = area(0.0) * LEAST_AREA;
            TRIED.iter().any(|&t| corners.iter().any(|&v| (area(t) - least).dot(lean[v]) < 0.0))
        };
        triangles.par_iter().filter(|corners| crosses(corners)).copied().collect()
    }

    /// Triangles with a corner among `vertices`. Hair over others is as it was; where it crossed, all corners are changed.
    fn touched(&self, vertices: &[u32]) -> Vec<[u32; 3]> {
        let mut touched: Vec<u32> = vertices.iter().flat_map(|&v| &self.of[v as usize]).copied().collect();
        touched.sort_unstable();
        touched.dedup();
        touched.into_iter().map(|t| self.triangles[t as usize]).collect()
    }

    /// The corners of triangles and what lies up to some rings around them.
    fn reached(&self, triangles: &[[u32; 3]], rings: usize) -> Vec<u32> {
        let mut reached = Vec::new();
        let mut is_reached = vec![false; self.around.len()];
        let mut reach = |v: u32, reached: &mut Vec<u32>| {
            if !std::mem::replace(&mut is_reached[v as usize], true) {
                reached.push(v);
            }
        };
        triangles.as_flattened().iter().for_each(|&v| reach(v, &mut reached));
        let mut begin = 0;
        for _ in 0..rings {
            let end = reached.len();
            for i in begin..end {
                self.around[reached[i] as usize].iter().for_each(|&near| reach(near, &mut reached));
            }
            begin = end;
        }
        reached
    }
}
