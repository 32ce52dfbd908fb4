//! A tile on a skin: the coat primitive.

use super::fins::edges::{FinSurface, edges};
use crate::data::coat::{CoatPrimitive, Tile};
use crate::data::fields::Fields;
use crate::data::mesh::Mesh;
use crate::data::patches::Patches;
use crate::math::Vec3;

/// Shortest hair over the stack's height: below it a shell would lie in the skin and fight it for depth.
const SHORTEST: f32 = 1e-3;

/// The coat's offset at a skin vertex over the stack's height: the lean, as long as the hair there is over the preset's.
pub fn offset_over_height(fields: &Fields, v: usize) -> Vec3 {
    fields.lean[v] * fields.length[v].max(SHORTEST)
}

/// Whether hair grows on a triangle of these skin vertices.
pub fn is_furred(fields: &Fields, triangle: [usize; 3]) -> bool {
    // What is painted between the vertices counts by the longest hair around them.
    let density = |v: usize| match fields.paint.as_deref() {
        Some(paint) if paint.parts[paint.part_of[v] as usize].bare => 0.0,
        Some(paint) => paint.density[v],
        None => fields.density[v],
    };
    triangle.iter().any(|&v| fields.length[v] > SHORTEST && density(v) > 0.0)
}

/// How vectors of the world become those of the base primitive's own space at a skin vertex.
pub struct Local<'a> {
    /// An offset in metres.
    pub offset: &'a dyn Fn(usize, Vec3) -> Vec3,
    /// A unit normal.
    pub normal: &'a dyn Fn(usize, Vec3) -> Vec3,
}

/// What a primitive carries, from its mesh, its fields and its patches. Base vertices are the mesh's. `axes` has the tile's x axis
/// for each (see [`axes`](super::axes::axes)).
pub fn coat_primitive(
    mesh: &Mesh,
    fields: &Fields,
    axes: &[Vec3],
    patches: &Patches,
    tile: &Tile,
    seed: u64,
    local: &Local<'_>,
) -> CoatPrimitive {
    let of = |v: &u32| *v as usize;
    let positions_m: Vec<Vec3> = patches.base_vertex.iter().map(|v| mesh.positions_m[of(v)]).collect();
    let position_class: Vec<u32> = patches.base_vertex.iter().map(|v| mesh.position_class[of(v)]).collect();
    let furred = |triangle: &&[u32; 3]| is_furred(fields, triangle.map(|v| of(&patches.base_vertex[v as usize])));
    let triangles: Vec<[u32; 3]> = patches.triangles.iter().filter(furred).copied().collect();
    let surface = FinSurface { positions_m: &positions_m, position_class: &position_class, triangles: &triangles };
    let offset = |v: usize| offset_over_height(fields, v) * tile.height_m;
    let normals = mesh.smooth_normals();
    CoatPrimitive {
        tile: 0,
        mesh: 0,
        primitive: 0,
        fins: edges(&surface, &tile.fin, seed),
        offset: patches.base_vertex.iter().map(|v| (local.offset)(of(v), offset(of(v)))).collect(),
        axis: patches.base_vertex.iter().map(|v| (local.offset)(of(v), axes[of(v)])).collect(),
        normal: patches.base_vertex.iter().map(|v| (local.normal)(of(v), normals[of(v)])).collect(),
        tint: patches.base_vertex.iter().map(|v| fields.tint[of(v)].extend(fields.density[of(v)])).collect(),
        base_vertex: patches.base_vertex.clone(),
        uv: patches.uv.clone(),
        patch: patches.patch.clone(),
        triangles,
        blend: None,
        colour: None,
        painted: None,
        longest: Vec::new(),
        cut: None,
    }
}
