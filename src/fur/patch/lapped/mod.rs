//! Lapped patches without overlap (Lengyel et al. 2001 §2.1, after Praun et al. 2000): grown over the skin one by one,
//! each flattened along the comb, until every triangle is in exactly one.
//!
//! Tiles are toroidal, so a patch may be larger than its tile and lie over itself: it need not be a disc, and only
//! stretch and the angle to the comb stop it.

mod absorb;
mod flatten;
mod grow;
mod offset;
mod patch;
mod seed;
mod stitch;

use super::face::Face;
use super::measure::measure;
use crate::data::mesh::Mesh;
use crate::data::patches::Patches;
use crate::data::topology::Topology;
use crate::math::{DVec2, Vec2, Vec3};
use patch::Patch;
use std::collections::HashMap;

/// The skin as growth sees it.
pub(super) struct Surface<'a> {
    /// The skin.
    pub mesh: &'a Mesh,
    /// Its triangles in their planes.
    pub faces: &'a [Face],
    /// Neighbours across edges, over the mesh's own seams.
    pub topology: Topology,
    /// Comb over each face in its axes; its length says how well the corners agree.
    pub comb: Vec<DVec2>,
    /// How much skin without comb one patch may have, m².
    pub most_free_m2: f64,
}

/// A comb shorter than this (its corners disagree, or hair stands upright) is not followed.
const FAINT: f64 = 0.05;
/// Share of the skin that one patch may have of upright hair (`docs/steps/patch.md`, "Upright hair").
const FREE_SHARE: f64 = 1.0 / 6.0;

impl Surface<'_> {
    /// Whether triangle `t` has no comb to lie along.
    pub fn is_free(&self, t: usize) -> bool {
        self.comb[t].length() < FAINT
    }

    /// The place of corner `k` of triangle `t`: one number for all vertices there.
    pub fn place(&self, t: usize, k: usize) -> u32 {
        self.mesh.position_class[self.mesh.triangles[t][k] as usize]
    }
}

/// See [`super::parameterise`].
pub(super) fn parameterise(mesh: &Mesh, direction: &[Vec3], tile_edge_m: f32, seed: u64) -> Patches {
    let faces = Face::all(mesh);
    let surface = Surface {
        mesh,
        faces: &faces,
        topology: Topology::new(&mesh.triangles, |v| mesh.position_class[v as usize]),
        comb: faces.iter().zip(&mesh.triangles).map(|(f, t)| f.comb(t.map(|v| direction[v as usize]))).collect(),
        most_free_m2: FREE_SHARE * faces.iter().map(|f| f.area_m2).sum::<f64>(),
    };
    let mut owner = vec![patch::FREE; faces.len()];
    let mut patches = Vec::new();
    let mut seeds = seed::Seeds::new(faces.len(), seed);
    while let Some(face) = seeds.next(&owner) {
        let patch = grow::grow(&surface, face, patches.len() as u32, seed, &mut owner);
        seeds.cover(&surface.topology, &patch.faces, &owner);
        patches.push(patch);
    }
    absorb::absorb(&surface, &mut patches, &mut owner);
    let mut result = assemble(mesh, &patches, &owner, f64::from(tile_edge_m));
    offset::settle(mesh, &surface.topology, seed, &mut result);
    stitch::stitch(&surface, f64::from(tile_edge_m), &mut result);
    result.stats = measure(mesh, &surface.topology, &faces, direction, f64::from(tile_edge_m), &result);
    on_vertices(mesh, result)
}

/// The same on coat vertices of their own for every mesh vertex at a place, so that the mesh's own seams stay.
fn on_vertices(mesh: &Mesh, places: Patches) -> Patches {
    let mut made: HashMap<(u32, u32), u32> = HashMap::new();
    let mut old = Vec::new();
    let mut base_vertex = Vec::new();
    let mut triangles = Vec::with_capacity(places.triangles.len());
    for (triangle, at_places) in mesh.triangles.iter().zip(&places.triangles) {
        triangles.push(std::array::from_fn(|k| {
            *made.entry((at_places[k], triangle[k])).or_insert_with(|| {
                old.push(at_places[k] as usize);
                base_vertex.push(triangle[k]);
                base_vertex.len() as u32 - 1
            })
        }));
    }
    let at = |list: &[Vec2]| -> Vec<Vec2> {
        if list.is_empty() { Vec::new() } else { old.iter().map(|&v| list[v]).collect() }
    };
    Patches {
        base_vertex,
        uv: at(&places.uv),
        chance_uv: at(&places.chance_uv),
        patch: old.iter().map(|&v| places.patch[v]).collect(),
        triangles,
        ..places
    }
}

/// Coat vertices: one per flat vertex of a patch. What is between patches depends on places alone: where the mesh keeps several
/// vertices in one place does not matter to hair.
fn assemble(mesh: &Mesh, patches: &[Patch], owner: &[u32], tile_edge_m: f64) -> Patches {
    let mut number = vec![u32::MAX; patches.len()];
    let mut used = 0;
    let mut slots = vec![0_u32; mesh.triangles.len()];
    for patch in patches {
        for (slot, &face) in patch.faces.iter().enumerate() {
            slots[face as usize] = slot as u32;
        }
    }
    let mut result = Patches::default();
    let mut made: HashMap<(u32, u32), u32> = HashMap::new();
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        let home = owner[t];
        let patch = &patches[home as usize];
        let corners = patch.corners[slots[t] as usize];
        if number[home as usize] == u32::MAX {
            number[home as usize] = used;
            used += 1;
        }
        result.triangles.push(std::array::from_fn(|k| {
            *made.entry((home, corners[k])).or_insert_with(|| {
                result.base_vertex.push(mesh.position_class[triangle[k] as usize]);
                result.patch.push(number[home as usize]);
                result.uv.push((patch.uv[corners[k] as usize] / tile_edge_m).as_vec2());
                result.base_vertex.len() as u32 - 1
            })
        }));
    }
    result
}
