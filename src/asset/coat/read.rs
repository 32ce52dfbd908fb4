//! A coat out of a file.

use super::parts::{check, part_of};
use super::{NAME, VERSION, textures};
use crate::asset::json::At;
use crate::asset::material::texture_of;
use crate::asset::{self, Asset, Part, Reading};
use crate::data::coat::{Blend, Coat, CoatPrimitive, FinEdge, Tile};
use crate::data::shell::{above_of_transmittance, code_above};
use crate::error::{Error, Result};
use crate::math::{Vec2, Vec3, Vec4};
use std::collections::HashMap;
use std::path::Path;

/// Newest version whose tiles hold what light at 45° comes through to a texel, where later ones hold the hair area above it.
const LAST_OF_TRANSMITTANCE: usize = 2;

/// Reads a file that has a coat.
///
/// # Errors
/// When the file cannot be read, has no coat, or one that contradicts itself.
pub fn read_coat(path: &Path) -> Result<(Asset, Coat)> {
    read_coat_as(path, &Reading::default())
}

/// As [`read_coat`], in a way of one's own.
///
/// # Errors
/// As [`read_coat`].
pub fn read_coat_as(path: &Path, reading: &Reading) -> Result<(Asset, Coat)> {
    let asset = asset::load_as(&path.to_string_lossy(), reading)?;
    let coat = coat_of(&asset).map_err(|error| error.with_file(path))?;
    Ok((asset, coat))
}

/// What a tile of an old version says of the light that reaches its texels, as hair area above them.
fn recode_above(tile: &mut Tile) {
    let codes: [u8; 256] = std::array::from_fn(|byte| code_above(above_of_transmittance(byte as u8)));
    let fin = tile.fin.tangent.iter_mut();
    for image in tile.shells.albedo.iter_mut().flatten().chain(fin) {
        image.pixels.iter_mut().skip(3).step_by(4).for_each(|byte| *byte = codes[usize::from(*byte)]);
    }
}

/// The coat that an asset carries.
///
/// # Errors
/// When it has none, or one that contradicts itself.
pub fn coat_of(asset: &Asset) -> Result<Coat> {
    let document = &asset.document;
    let root = document.root();
    let Some(extension) = root.get("extensions").and_then(|e| e.get(NAME)) else {
        return Err(Error::input("the file has no coat")
            .with_field(format!("extensions.{NAME}"))
            .with_found("nothing")
            .with_expected("a coat")
            .with_hint("make one with `furrier bake`; tools that rewrite glTF may have dropped it"));
    };
    let version = extension.need("version")?;
    if !(1..=VERSION).contains(&(version.size()? as u64)) {
        let expected = format!("1 to {VERSION}");
        return Err(version.fault(&expected).with_hint("bake the asset again with this version"));
    }
    let metres = extension.need("metresPerUnit")?;
    let metres_per_unit = metres.number()?;
    if !(metres_per_unit.is_finite() && metres_per_unit > 0.0) {
        return Err(metres.fault("a positive number of metres"));
    }
    let mut coat = Coat { metres_per_unit, ..Coat::default() };
    for tile in extension.list("tiles")? {
        let mut tile = textures::read(document, &tile)?;
        if version.size()? <= LAST_OF_TRANSMITTANCE {
            recode_above(&mut tile);
        }
        coat.tiles.push(tile);
    }
    // Coat vertices that several coats share, by their accessors.
    let mut pools: Vec<String> = Vec::new();
    for (mesh, mesh_at) in root.list("meshes")?.iter().enumerate() {
        for (primitive, at) in mesh_at.list("primitives")?.iter().enumerate() {
            let Some(carried) = at.get("extensions").and_then(|e| e.get(NAME)) else { continue };
            let empty = CoatPrimitive { mesh, primitive, ..CoatPrimitive::default() };
            // A coat on a mesh that the default scene does not show is nobody's.
            let Ok(part) = part_of(asset, &empty) else { continue };
            let more = carried.list("more")?;
            for carried in std::iter::once(&carried).chain(&more) {
                let mut coat_primitive = empty.clone();
                read_primitive(asset, carried, &mut coat_primitive, part)?;
                check(&coat_primitive, part, &coat.tiles)?;
                pools.push(carried.need("attributes")?.value.to_string());
                coat.primitives.push(coat_primitive);
            }
        }
    }
    let mut users: HashMap<&str, usize> = HashMap::new();
    pools.iter().for_each(|pool| *users.entry(pool).or_default() += 1);
    for (coat_primitive, pool) in coat.primitives.iter_mut().zip(&pools) {
        // A vertex that only others of its pool use has no base here.
        if users[pool.as_str()] > 1 || coat_primitive.base_vertex.contains(&u32::MAX) {
            *coat_primitive = coat_primitive.part(|_| true);
        }
    }
    Ok(coat)
}

fn read_primitive(asset: &Asset, at: &At<'_>, coat_primitive: &mut CoatPrimitive, part: &Part) -> Result<()> {
    let document = &asset.document;
    let attributes = at.need("attributes")?;
    let integers = |owner: &At<'_>, key: &str, width| document.integers(owner.need(key)?.size()?, width);
    let floats = |owner: &At<'_>, key: &str, width| document.floats(owner.need(key)?.size()?, width);
    coat_primitive.tile = at.need("tile")?.size()?;
    let mirrored = part.mirrored();
    let source = &part.stored.source;
    // A vertex that the primitive itself does not use may belong to another one of its pool.
    let base = |stored: u32| source.binary_search(&stored).map_or(u32::MAX, |v| v as u32);
    coat_primitive.base_vertex = integers(&attributes, "BASE_VERTEX", 1)?.into_iter().map(base).collect();
    coat_primitive.patch = integers(&attributes, "PATCH", 1)?;
    coat_primitive.uv = floats(&attributes, "TEXCOORD_0", 2)?.chunks_exact(2).map(Vec2::from_slice).collect();
    coat_primitive.offset = floats(&attributes, "OFFSET", 3)?.chunks_exact(3).map(Vec3::from_slice).collect();
    coat_primitive.axis = floats(&attributes, "AXIS", 3)?.chunks_exact(3).map(Vec3::from_slice).collect();
    coat_primitive.tint = floats(&attributes, "TINT", 4)?.chunks_exact(4).map(Vec4::from_slice).collect();
    if attributes.get("NORMAL").is_some() {
        let normals = floats(&attributes, "NORMAL", 3)?;
        coat_primitive.normal = normals.chunks_exact(3).map(Vec3::from_slice).collect();
    }
    if attributes.get("LONGEST").is_some() {
        coat_primitive.longest = floats(&attributes, "LONGEST", 1)?;
    }
    let texture = |key: &str| at.get(key).map(|slot| texture_of(document, &slot)).transpose().map(Option::flatten);
    coat_primitive.colour = texture("colourTexture")?;
    coat_primitive.painted = texture("paintedTexture")?;
    let indices = integers(at, "indices", 1)?;
    coat_primitive.triangles = indices.as_chunks::<3>().0.to_vec();
    if mirrored {
        coat_primitive.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    if let Some(blend) = at.get("blend") {
        let tile = blend.need("tile")?.size()?;
        coat_primitive.blend = Some(Blend { tile, weight: floats(&blend, "weights", 1)? });
    }
    let Some(fins) = at.get("fins") else { return Ok(()) };
    let (edges, strips) = (integers(&fins, "edges", 4)?, floats(&fins, "strips", 3)?);
    if edges.len() / 4 != strips.len() / 3 {
        return Err(fins.fault("as many strips as edges"));
    }
    for (e, s) in edges.chunks_exact(4).zip(strips.chunks_exact(3)) {
        let opposite = if mirrored { [e[3], e[2]] } else { [e[2], e[3]] };
        coat_primitive.fins.push(FinEdge { ends: [e[0], e[1]], opposite, u: [s[0], s[1]], thickness: s[2] });
    }
    Ok(())
}
