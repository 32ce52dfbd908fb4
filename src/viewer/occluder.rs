//! A thing beside the asset: grey, opaque, lit, and between the light and the fur.

use crate::asset::Asset;
use crate::error::Result;
use crate::math::{DVec3, Vec2, Vec3};
use crate::runtime::SkinMesh;

/// Its base colour.
const GREY: Vec3 = Vec3::splat(0.5);

/// All of `thing` in its rest pose as one surface. Its file's units and axes are the asset's: one is `metres_per_unit` long, and
/// the picture's origin lies at `origin_m`.
///
/// # Errors
/// As [`Asset::rest_pose`].
pub fn skin(thing: &Asset, metres_per_unit: f64, origin_m: DVec3) -> Result<SkinMesh<'static>> {
    let pose = thing.rest_pose()?;
    let mut skin = SkinMesh { guest: true, ..SkinMesh::default() };
    for part in &thing.parts {
        let moved = (part.centre_units * metres_per_unit - origin_m).as_vec3();
        for &node in &part.nodes {
            let posed = part.posed(thing, &pose, node, metres_per_unit);
            let first = skin.positions_m.len() as u32;
            skin.positions_m.extend(posed.positions_m.iter().map(|&p| p + moved));
            skin.normals.extend(&posed.normals);
            skin.triangles.extend(part.stored.triangles.iter().map(|t| t.map(|v| first + v)));
        }
    }
    let count = skin.positions_m.len();
    skin.colour = vec![GREY; count];
    // Without a tile the coat over it hides nothing; being there, it takes the shine.
    skin.coat_uv = vec![Vec2::ZERO; count];
    skin.coat_density = vec![1.0; count];
    Ok(skin)
}
