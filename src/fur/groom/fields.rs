//! A coat's fields over a mesh: preset, vertex attributes and maps into one value per vertex.

use super::Groom;
use super::lean::lean;
use super::maps::{Maps, sample, sample_colour};
use super::unfold::unfold;
use crate::data::fields::Fields;
use crate::data::mesh::Mesh;
use crate::math::{Vec2, Vec3};

/// Gathers the fields.
///
/// `comb` is a unit tangent per vertex, zero where the hair stands upright; `tint` the colour under each vertex; `height_m` that
/// of the hair that is combed so that it does not cross, m. Maps are sampled at the mesh's first UV set and left
/// out where it has none.
pub fn gather(mesh: &Mesh, groom: &Groom, maps: &Maps, comb: Vec<Vec3>, tint: Vec<Vec3>, height_m: f32) -> Fields {
    let count = mesh.positions_m.len();
    let normals = mesh.smooth_normals();
    let at = |v: usize| mesh.uv_sets.first().map_or(Vec2::ZERO, |uv| uv[v]);
    let has_uv = !mesh.uv_sets.is_empty();
    let grey = |map: &Option<crate::data::image::Image8>, v: usize| match map {
        Some(image) if has_uv => sample(image, at(v)).x,
        _ => 1.0,
    };
    let comb_length = |v: usize| match &maps.comb {
        Some(image) if has_uv => sample(image, at(v)).w,
        _ => 1.0,
    };
    let attribute = |v: usize| mesh.fur_length.as_ref().map_or(1.0, |length| length[v].max(0.0));
    let mut length: Vec<f32> = (0..count).map(|v| attribute(v) * grey(&maps.length, v) * comb_length(v)).collect();
    let mut lean: Vec<Vec3> = (0..count).map(|v| lean(groom, normals[v], comb[v])).collect();
    unfold(mesh, &normals, height_m, &mut lean, &mut length);
    Fields {
        length,
        lean,
        density: (0..count).map(|v| grey(&maps.density, v)).collect(),
        clump: (0..count).map(|v| grey(&maps.clump, v)).collect(),
        direction: comb,
        tint: match &maps.colour {
            Some(image) if has_uv => (0..count).map(|v| sample_colour(image, at(v))).collect(),
            _ => tint,
        },
    }
}
