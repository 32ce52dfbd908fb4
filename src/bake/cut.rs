//! Coat primitives cut so finely that vertex colours show the pattern: for fallback shells, whose one texture is the hair's.

use crate::asset::Part;
use crate::data::coat::{CoatPrimitive, Cut};
use crate::data::fields::Fields;
use crate::data::mesh::Mesh;
use crate::data::paint::Paint;
use crate::fur::groom::refine::{Finest, refine};
use crate::math::{Vec2, Vec3, Vec4};
use std::sync::Arc;

/// The finest pattern that is kept, in parts of what is furred.
const FINEST: f32 = 150.0;
/// Triangles that are made at most: so many, and so many times as many as there were.
const MOST_TRIANGLES: (usize, usize) = (6000, 2);

/// Cuts what `part` carries where `paint` varies; its vertices lie on the skin's `vertices`.
pub fn cut(
    part: &Part,
    part_index: usize,
    carried: &CoatPrimitive,
    paint: &Paint,
    vertices: &[u32],
    diagonal_m: f32,
    metres_per_unit: f64,
) -> Option<Cut> {
    let painted = &paint.parts[part_index];
    if !painted.varies() || carried.triangles.is_empty() {
        return None;
    }
    let count = carried.base_vertex.len();
    let base = |list: &[Vec2]| -> Vec<Vec2> { carried.base_vertex.iter().map(|&v| list[v as usize]).collect() };
    let position_m = |&v: &u32| ((part.world_units(v as usize) - part.centre_units) * metres_per_unit).as_vec3();
    let mesh = Mesh {
        positions_m: carried.base_vertex.iter().map(position_m).collect(),
        normals: vec![Vec3::Y; count],
        hair_normals: Some(vec![Vec3::Y; count]),
        triangles: carried.triangles.clone(),
        position_class: classes(part, carried),
        uv_sets: part.stored.uv_sets.iter().map(|set| base(set)).collect(),
        ..Mesh::default()
    };
    let own = Paint {
        parts: vec![painted.clone()],
        part_of: vec![0; count],
        factor: vertices.iter().map(|&v| paint.factor[v as usize]).collect(),
        longest: vertices.iter().map(|&v| paint.longest[v as usize]).collect(),
        density: vec![1.0; count],
    };
    let zeros = || vec![Vec3::ZERO; count];
    let fields = Fields {
        // Lengths are the offsets'; what is shorter is thinner, as vertex colours cannot end it lower.
        length: vec![1.0; count],
        density: vec![1.0; count],
        direction: zeros(),
        lean: zeros(),
        clump: vec![1.0; count],
        tint: zeros(),
        paint: Some(Arc::new(own)),
        partings: Vec::new(),
    };
    let most = MOST_TRIANGLES.0 + MOST_TRIANGLES.1 * carried.triangles.len();
    let density = |corners: [u32; 3], b: Vec3| Vec3::from(corners.map(|c| carried.tint[c as usize].w)).dot(b);
    let refined = refine(&mesh, &fields, Finest { edge_m: diagonal_m / FINEST, triangles: most })?;
    // Vertices that no furred triangle uses stay behind.
    let mut new = vec![u32::MAX; refined.origin.len()];
    let mut used = Vec::new();
    let mut renumbered = |v: u32| {
        if new[v as usize] == u32::MAX {
            new[v as usize] = used.len() as u32;
            used.push(v as usize);
        }
        new[v as usize]
    };
    let triangles = refined.mesh.triangles.iter().map(|t| t.map(&mut renumbered)).collect();
    let tint = |&v: &usize| -> Vec4 {
        let at = refined.origin[v];
        let here = density(mesh.triangles[at.triangle as usize], at.b);
        refined.fields.tint[v].extend(here * refined.fields.density[v] * refined.fields.length[v])
    };
    Some(Cut {
        inside: used
            .iter()
            .map(|&v| &refined.origin[v])
            .map(|at| (mesh.triangles[at.triangle as usize], at.b.to_array()))
            .collect(),
        tint: used.iter().map(tint).collect(),
        triangles,
        coarse: refined.coarse,
    })
}

/// Coat vertices at one place, by their base vertices.
fn classes(part: &Part, carried: &CoatPrimitive) -> Vec<u32> {
    let mut first = vec![u32::MAX; part.vertices()];
    let class = |(&base, v): (&u32, u32)| {
        let slot = &mut first[part.stored.position_class[base as usize] as usize];
        if *slot == u32::MAX {
            *slot = v;
        }
        *slot
    };
    carried.base_vertex.iter().zip(0..).map(class).collect()
}
