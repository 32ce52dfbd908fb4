//! A tile on a skin: the coat primitive.

use super::fins::edges::{Surface, edges};
use crate::data::coat::{CoatPrimitive, Sampled, Tile};
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

/// What a primitive wears, from its mesh, its fields and its patches. `local_offset` takes a skin vertex and a world
/// offset in metres to the base primitive's own space.
pub fn wear(
    mesh: &Mesh,
    fields: &Fields,
    patches: &Patches,
    tile: &Tile,
    seed: u64,
    local_offset: impl Fn(usize, Vec3) -> Vec3,
) -> CoatPrimitive {
    let of = |v: &u32| *v as usize;
    let positions_m: Vec<Vec3> = patches.base_vertex.iter().map(|v| mesh.positions_m[of(v)]).collect();
    let position_class: Vec<u32> = patches.base_vertex.iter().map(|v| mesh.position_class[of(v)]).collect();
    let furred = |triangle: &&[u32; 3]| {
        triangle.iter().any(|&v| {
            let base = of(&patches.base_vertex[v as usize]);
            fields.length[base] > SHORTEST && fields.density[base] > 0.0
        })
    };
    let triangles: Vec<[u32; 3]> = patches.triangles.iter().filter(furred).copied().collect();
    let surface = Surface { positions_m: &positions_m, position_class: &position_class, triangles: &triangles };
    // Hair that was sampled on the skin itself is as dense as it grows there.
    let even = match tile.sampled {
        Sampled::Square => evenly(mesh, patches, tile.edge_m),
        Sampled::Skin => vec![1.0; patches.uv.len()],
    };
    let offset = |v: usize| offset_over_height(fields, v) * tile.height_m;
    CoatPrimitive {
        tile: 0,
        mesh: 0,
        primitive: 0,
        fins: edges(&surface, &tile.fin, seed),
        offset: patches.base_vertex.iter().map(|v| local_offset(of(v), offset(of(v)))).collect(),
        tint: patches
            .base_vertex
            .iter()
            .zip(&even)
            .map(|(v, even)| fields.tint[of(v)].extend(fields.density[of(v)] * even))
            .collect(),
        base_vertex: patches.base_vertex.clone(),
        uv: patches.uv.clone(),
        patch: patches.patch.clone(),
        triangles,
        blend: None,
    }
}

/// Stretch that is made up for at most: hair of a texture drawn out further stays sparse.
const MOST_EVEN: f32 = 2.5;

/// Per coat vertex: the factor on density that keeps the number of hairs per skin area where the texture is drawn out
/// (above 1) or squeezed (below): skin area over texture area of the triangles around it.
pub fn evenly(mesh: &Mesh, patches: &Patches, tile_edge_m: f32) -> Vec<f32> {
    let mut areas = vec![(0.0_f64, 0.0_f64); patches.uv.len()];
    for (t, triangle) in patches.triangles.iter().enumerate() {
        let [a, b, c] = triangle.map(|v| patches.uv[v as usize].as_dvec2() * f64::from(tile_edge_m));
        let texture_m2 = 0.5 * (b - a).perp_dot(c - a).abs();
        for &v in triangle {
            let sum = &mut areas[v as usize];
            *sum = (sum.0 + f64::from(mesh.area_m2(t)), sum.1 + texture_m2);
        }
    }
    let factor = |(skin, texture): (f64, f64)| if texture > 0.0 { (skin / texture) as f32 } else { 1.0 };
    areas.into_iter().map(|sums| factor(sums).clamp(1.0 / MOST_EVEN, MOST_EVEN)).collect()
}
