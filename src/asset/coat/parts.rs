//! What reading and writing share: which part of the asset a coat primitive lies on, and where the extension goes.

use super::NAME;
use crate::asset::{Asset, Part};
use crate::data::coat::{Blend, CoatPrimitive, Sampled, Tile};
use crate::error::{Error, Result};
use serde_json::{Map, Value};

/// The part that a coat primitive belongs to.
pub(super) fn part_of<'a>(asset: &'a Asset, primitive: &CoatPrimitive) -> Result<&'a Part> {
    let found = asset.parts.iter().find(|p| p.mesh == primitive.mesh && p.primitive == primitive.primitive);
    found.ok_or_else(|| {
        Error::input("a coat primitive belongs to no part of the asset")
            .with_field("coat.primitives")
            .with_found(format!("mesh {}, primitive {}", primitive.mesh, primitive.primitive))
            .with_expected("a triangle primitive of the default scene")
    })
}

/// Checks that every index of a coat primitive points somewhere and every number is finite.
pub(super) fn check(primitive: &CoatPrimitive, part: &Part, tiles: &[Tile]) -> Result<()> {
    let n = primitive.base_vertex.len();
    let fault = |field: &str, expected: &str| {
        Err(Error::input("the coat is not consistent")
            .with_field(format!("coat of meshes[{}].primitives[{}]: {field}", primitive.mesh, primitive.primitive))
            .with_found("something else")
            .with_expected(expected))
    };
    let lengths =
        [primitive.uv.len(), primitive.patch.len(), primitive.offset.len(), primitive.axis.len(), primitive.tint.len()];
    if lengths.iter().any(|&length| length != n) || n == 0 {
        return fault("attributes", "one entry per coat vertex, and at least one");
    }
    if primitive.tile >= tiles.len() {
        return fault("tile", "a tile of the coat");
    }
    let inside = |v: &u32| (*v as usize) < n;
    if !primitive.triangles.iter().flatten().all(inside) {
        return fault("indices", "coat vertices");
    }
    let based = |v: &u32| (primitive.base_vertex[*v as usize] as usize) < part.vertices();
    if !primitive.triangles.iter().flatten().all(based) {
        return fault("BASE_VERTEX", "vertices that the base primitive's triangles use");
    }
    let optional = [primitive.normal.len(), primitive.longest.len()];
    if optional.iter().any(|&length| length != 0 && length != n) {
        return fault("NORMAL and LONGEST", "one entry per coat vertex, or none");
    }
    if let Some(Blend { tile, weight }) = &primitive.blend {
        let alike = |a: &Tile, b: &Tile| {
            a.shells.layers == b.shells.layers && a.sampled == Sampled::Square && b.sampled == Sampled::Square
        };
        if !tiles.get(*tile).is_some_and(|second| alike(&tiles[primitive.tile], second)) {
            return fault("blend.tile", "a tile that repeats, as the first does, with as many layers");
        }
        if weight.len() != n || !weight.iter().all(|w| (0.0..=1.0).contains(w)) {
            return fault("blend.weights", "a number from 0 to 1 per coat vertex");
        }
    }
    if !primitive.fins.iter().all(|fin| fin.ends.iter().chain(&fin.opposite).all(inside)) {
        return fault("fins.edges", "coat vertices");
    }
    let finite = primitive.uv.iter().all(|uv| uv.is_finite())
        && primitive.offset.iter().all(|o| o.is_finite())
        && primitive.axis.iter().all(|x| x.is_finite())
        && primitive.normal.iter().all(|n| n.is_finite())
        && primitive.longest.iter().all(|l| *l > 0.0 && l.is_finite())
        && primitive.tint.iter().all(|t| t.is_finite())
        && primitive.fins.iter().all(|f| f.u.iter().chain([&f.thickness]).all(|u| u.is_finite()));
    if finite { Ok(()) } else { fault("attributes", "finite numbers") }
}

/// Sets our extension on a JSON object.
pub(super) fn set_extension(owner: &mut Value, value: Value) {
    if let Some(object) = owner.as_object_mut() {
        let extensions = object.entry("extensions").or_insert_with(|| Value::Object(Map::new()));
        if let Some(extensions) = extensions.as_object_mut() {
            extensions.insert(NAME.into(), value);
        }
    }
}
