//! Triangles of an implicit surface: surface nets (Gibson 1998), then evened out and drawn onto the surface.

use crate::math::Vec3;
use rayon::prelude::*;
use std::collections::HashMap;

/// Edge of a grid cell, m.
const CELL_M: f32 = 0.0105;
/// Lowest corner of the grid, m.
const LOW_M: Vec3 = Vec3::new(-0.12, -0.012, -0.48);
/// Cells along each axis.
const CELLS: [i32; 3] = [23, 48, 80];

/// A closed triangle mesh.
pub struct Surface {
    /// Vertices, m.
    pub positions: Vec<Vec3>,
    /// Their unit normals.
    pub normals: Vec<Vec3>,
    /// Counter-clockwise from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// The zero level of `distance`.
pub fn extract(distance: impl Fn(Vec3) -> f32 + Sync) -> Surface {
    let corner = |i: i32, j: i32, k: i32| LOW_M + CELL_M * Vec3::new(i as f32, j as f32, k as f32);
    let step = [1, CELLS[0] + 1, (CELLS[0] + 1) * (CELLS[1] + 1)];
    let index = |c: [i32; 3]| (c[0] * step[0] + c[1] * step[1] + c[2] * step[2]) as usize;
    let rows: Vec<(i32, i32)> = (0..=CELLS[2]).flat_map(|k| (0..=CELLS[1]).map(move |j| (j, k))).collect();
    let row = |&(j, k): &(i32, i32)| (0..=CELLS[0]).map(|i| distance(corner(i, j, k))).collect::<Vec<f32>>();
    let values: Vec<f32> = rows.par_iter().flat_map_iter(row).collect();
    // One vertex in every cell that the surface crosses, found when a quad first needs it.
    let mut positions = Vec::new();
    let mut of_cell: HashMap<[i32; 3], u32> = HashMap::new();
    let mut quads = Vec::new();
    for k in 1..CELLS[2] {
        for j in 1..CELLS[1] {
            for i in 1..CELLS[0] {
                let here = [i, j, k];
                let inside = values[index(here)] < 0.0;
                for axis in 0..3 {
                    let mut there = here;
                    there[axis] += 1;
                    if inside == (values[index(there)] < 0.0) {
                        continue;
                    }
                    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                    let mut quad = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(du, dv)| {
                        let mut cell = here;
                        cell[u] -= du;
                        cell[v] -= dv;
                        *of_cell.entry(cell).or_insert_with(|| {
                            positions.push(corner(cell[0], cell[1], cell[2]) + Vec3::splat(0.5 * CELL_M));
                            positions.len() as u32 - 1
                        })
                    });
                    if !inside {
                        quad.reverse();
                    }
                    quads.push(quad);
                }
            }
        }
    }
    for _ in 0..3 {
        positions = evened(&positions, &quads).into_par_iter().map(|p| onto(p, &distance)).collect();
    }
    let normals = positions.par_iter().map(|&p| gradient(p, &distance).normalize_or_zero()).collect();
    let triangles = quads.iter().flat_map(|&quad| split(quad, &positions)).collect();
    Surface { positions, normals, triangles }
}

/// Every vertex halfway to the mean of its neighbours.
fn evened(positions: &[Vec3], quads: &[[u32; 4]]) -> Vec<Vec3> {
    let mut sums = vec![(Vec3::ZERO, 0.0); positions.len()];
    for quad in quads {
        for i in 0..4 {
            let (a, b) = (quad[i] as usize, quad[(i + 1) % 4] as usize);
            // Each edge is met from both of its quads, so both directions are counted once per quad.
            sums[a].0 += positions[b];
            sums[a].1 += 1.0;
            sums[b].0 += positions[a];
            sums[b].1 += 1.0;
        }
    }
    positions.iter().zip(sums).map(|(&p, (sum, n))| if n > 0.0 { p.lerp(sum / n, 0.5) } else { p }).collect()
}

/// Two Newton steps along the gradient.
fn onto(mut point: Vec3, distance: &impl Fn(Vec3) -> f32) -> Vec3 {
    for _ in 0..2 {
        let slope = gradient(point, distance);
        let step = distance(point) * slope / slope.length_squared().max(0.05);
        point -= step.clamp_length_max(CELL_M);
    }
    point
}

fn gradient(point: Vec3, distance: &impl Fn(Vec3) -> f32) -> Vec3 {
    const H: f32 = 5e-4;
    let slope = |axis: Vec3| (distance(point + H * axis) - distance(point - H * axis)) / (2.0 * H);
    Vec3::new(slope(Vec3::X), slope(Vec3::Y), slope(Vec3::Z))
}

/// A quad as two triangles, along its shorter diagonal.
fn split([a, b, c, d]: [u32; 4], positions: &[Vec3]) -> [[u32; 3]; 2] {
    let length = |i: u32, j: u32| positions[i as usize].distance_squared(positions[j as usize]);
    if length(a, c) <= length(b, d) { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
}
