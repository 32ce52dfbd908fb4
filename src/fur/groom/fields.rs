//! A coat's fields over a mesh: preset, vertex attributes and what is painted into one value per vertex.

use super::Groom;
use super::lean::{Standing, lean};
use crate::data::fields::Fields;
use crate::data::mesh::Mesh;
use crate::data::paint::{Paint, Painted, PaintedPoint};
use crate::error::Result;
use crate::math::Vec3;
use std::sync::Arc;

/// Gathers the fields.
///
/// `comb` is a unit tangent per vertex, zero where the hair stands upright; `paint` what is painted on the mesh; `unfold` combs leans and
/// lengths so that hair does not cross ([`unfold`](super::unfold::unfold)). Lengths are the longest that are painted around a vertex.
///
/// # Errors
/// As `unfold`.
pub fn gather(
    mesh: &Mesh,
    groom: &Groom,
    mut paint: Paint,
    comb: Vec<Vec3>,
    unfold: impl FnOnce(&Standing, Vec<Vec3>, Vec<f32>) -> Result<(Vec<Vec3>, Vec<f32>)>,
) -> Result<Fields> {
    let count = mesh.positions_m.len();
    let standing = Standing::new(mesh);
    paint.find_longest(mesh);
    let attribute = |v: usize| mesh.fur_length.as_ref().map_or(1.0, |length| length[v].max(0.0));
    let length: Vec<f32> = (0..count).map(|v| attribute(v) * paint.longest[v]).collect();
    let class = |v: usize| mesh.position_class[v] as usize;
    let lean: Vec<Vec3> =
        (0..count).map(|v| standing.raised(v, class(v), lean(groom, standing.normals[v], comb[v]))).collect();
    let (lean, length) = unfold(&standing, lean, length)?;
    let painted: Vec<PaintedPoint> = (0..count).map(|v| paint.at_vertex(mesh, v)).collect();
    Ok(Fields {
        length,
        lean,
        density: painted.iter().map(|p| p.density).collect(),
        clump: painted.iter().map(|p| p.clump).collect(),
        direction: comb,
        tint: painted.iter().map(|p| p.tint).collect(),
        paint: paint.parts.iter().any(Painted::varies).then(|| Arc::new(paint)),
        partings: Vec::new(),
    })
}
