//! Hair on a mesh.

use super::{course, empty, individual};
use crate::data::fields::Fields;
use crate::data::mesh::Mesh;
use crate::data::strands::{Root, Strands};
use crate::fur::groom::clump;
use crate::fur::groom::fibre::Fibre;
use crate::math::hash::{combine, unit_f32};
use crate::math::{Vec2, Vec3, orthonormal_basis, sampling};
use rayon::prelude::*;

/// Grows one kind of hair on the whole mesh.
///
/// Each triangle decides its own count and roots from its index, so order and threads do not matter. A posed mesh wears
/// the hairs of its rest pose: as many, with the same ids, lengths and shapes.
pub fn grow(fibre: &Fibre, mesh: &Mesh, fields: &Fields, seed: u64) -> Strands {
    let all: Vec<usize> = (0..mesh.triangles.len()).collect();
    grow_on(fibre, mesh, fields, seed, &all)
}

/// The hair of `triangles` alone, as [`grow`] would grow it.
pub fn grow_on(fibre: &Fibre, mesh: &Mesh, fields: &Fields, seed: u64, triangles: &[usize]) -> Strands {
    let normals = mesh.smooth_normals();
    let per_triangle: Vec<Strands> = triangles
        .par_iter()
        .map(|&t| grow_triangle(fibre, mesh, &normals, fields, t, combine(seed, t as u64)))
        .collect();
    let mut all = empty(fibre, per_triangle.iter().map(Strands::len).sum());
    for part in per_triangle {
        all.points_m.extend(part.points_m);
        all.roots.extend(part.roots);
        all.root_radius_m.extend(part.root_radius_m);
        all.tint.extend(part.tint);
    }
    all.id = (0..all.len() as u32).collect();
    all
}

fn grow_triangle(fibre: &Fibre, mesh: &Mesh, normals: &[Vec3], fields: &Fields, t: usize, key: u64) -> Strands {
    let corners = mesh.triangles[t].map(|v| v as usize);
    let greatest = corners.iter().map(|&v| fields.density[v]).fold(0.0, f32::max);
    let expected = fibre.density_per_m2 * mesh.rest_area_m2(t) * greatest;
    let count = (expected + unit_f32(key)).floor() as u64;
    let mut strands = empty(fibre, count as usize);
    let mut points = vec![Vec3::ZERO; strands.points_per_strand];
    let posed_from_rest = mesh.posed_from_rest(t);
    for i in 0..count {
        let key = combine(key, i);
        let b = sampling::square_to_triangle(sampling::r2(i, key & !0xFFFF));
        let mix3 = |values: [Vec3; 3]| values[0] * b.x + values[1] * b.y + values[2] * b.z;
        let mix1 = |values: [f32; 3]| values[0] * b.x + values[1] * b.y + values[2] * b.z;
        let length = mix1(corners.map(|v| fields.length[v]));
        if unit_f32(combine(key, 2)) * greatest >= mix1(corners.map(|v| fields.density[v])) || length <= 0.0 {
            continue;
        }
        let root = mix3(mesh.corners_m(t));
        let normal = mix3(corners.map(|v| normals[v])).normalize_or(Vec3::Z);
        let lean = mix3(corners.map(|v| fields.lean[v])).normalize_or(normal);
        let x_axis = tangent(mix3(corners.map(|v| fields.direction[v])), normal);
        let y_axis = normal.cross(x_axis);
        let rest_root = mix3(mesh.rest_corners_m(t));
        let to_clump = clump::to_centre_in_space(rest_root, fibre.shape.clump.spacing_mm * 1e-3, 0);
        let to_clump = posed_from_rest * to_clump;
        let to_clump = Vec2::new(to_clump.dot(x_axis), to_clump.dot(y_axis));
        let (length_m, brightness) = individual(fibre, fibre.length_m * length, key);
        course(fibre, length_m, mix1(corners.map(|v| fields.clump[v])), to_clump, key, &mut points);
        // Shell space to the world: sheared along the lean, as the coat's offsets shear a tile.
        strands.points_m.extend(points.iter().map(|p| root + x_axis * p.x + y_axis * p.y + lean * p.z));
        strands.roots.push(Root { triangle: t as u32, barycentric: [b.x, b.y] });
        strands.root_radius_m.push(fibre.radius_m);
        strands.tint.push(mix3(corners.map(|v| fields.tint[v])) * brightness);
    }
    strands
}

/// The comb direction as a unit vector at a right angle to the normal; any such vector where there is none.
fn tangent(direction: Vec3, normal: Vec3) -> Vec3 {
    let along = direction - normal * direction.dot(normal);
    along.try_normalize().unwrap_or_else(|| orthonormal_basis(normal).0)
}
