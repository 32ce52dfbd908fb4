//! A coat into a document, and the document into files.

use super::fallback::{self, Fallback};
use super::parts::{check, part_of, set_extension};
use super::pool::pools;
use super::textures::{self, Packed};
use super::{NAME, VERSION};
use crate::asset::document::Document;
use crate::asset::encode::{Use, numbers};
use crate::asset::image::media_type;
use crate::asset::{Asset, write};
use crate::data::coat::{Coat, CoatPrimitive};
use crate::data::texture::Texture;
use crate::error::{Error, Kind, Result};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Writes the asset with its coat to `out`, a `.glb`, or a `.gltf` with a `.bin` beside it. Gives what the user should
/// know: images that were taken along, or that were not there.
///
/// # Errors
/// When the coat does not fit the asset, or the output cannot be written; then no output is left behind.
pub fn write_coat(asset: &Asset, coat: &Coat, fallback: Fallback, out: &Path) -> Result<Vec<String>> {
    write_packed(asset, coat, &packed(coat)?, fallback, out)
}

/// The same with the textures of the coat's tiles, which are packed already.
///
/// # Errors
/// As [`write_coat`].
pub fn write_packed(
    asset: &Asset,
    coat: &Coat,
    textures: &[Packed],
    fallback: Fallback,
    out: &Path,
) -> Result<Vec<String>> {
    let extension = out.extension().map(|e| e.to_string_lossy().to_lowercase());
    let text = match extension.as_deref() {
        Some("glb") => false,
        Some("gltf") => true,
        _ => {
            return Err(Error::usage("the output must be glTF")
                .with_file(out)
                .with_found(extension.unwrap_or_else(|| "no extension".into()))
                .with_expected(".glb or .gltf"));
        }
    };
    write::check_target(out, &asset.document.files)?;
    let mut document = with_packed(asset, coat, textures, fallback)?;
    let beside = text && same_folder(out, asset.document.folder.as_deref());
    let notes = if beside { Vec::new() } else { take_images_along(&mut document)? };
    if !text {
        write::whole(out, &document.to_glb()?, &asset.document.files)?;
        return Ok(notes);
    }
    let binary = out.with_extension("bin");
    let name = binary.file_name().unwrap_or_default().to_string_lossy();
    document.json["buffers"][0]["uri"] = json!(percent_encoding::utf8_percent_encode(&name, UNSAFE).to_string());
    let json = to_text(&document.json)?;
    write::all(&[(binary, &document.binary), (out.to_owned(), &json)], &asset.document.files)?;
    Ok(notes)
}

/// What a URI may not hold as it is.
const UNSAFE: &percent_encoding::AsciiSet = &percent_encoding::CONTROLS
    .add(b' ')
    .add(b'"')
    .add(b'#')
    .add(b'%')
    .add(b'<')
    .add(b'>')
    .add(b'?')
    .add(b'\\')
    .add(b':');

fn to_text(json: &Value) -> Result<Vec<u8>> {
    serde_json::to_vec(json).map_err(|error| Error::new(Kind::Output, format!("the JSON cannot be written: {error}")))
}

fn same_folder(out: &Path, folder: Option<&Path>) -> bool {
    let parent = out.parent().map(|p| if p.as_os_str().is_empty() { PathBuf::from(".") } else { p.to_owned() });
    let (Some(parent), Some(folder)) = (parent, folder) else { return false };
    parent.canonicalize().ok().is_some_and(|parent| folder.canonicalize().ok() == Some(parent))
}

/// Copies images that lie in files into the buffer, because the output may stand elsewhere.
fn take_images_along(document: &mut Document) -> Result<Vec<String>> {
    let mut notes = Vec::new();
    for index in 0..document.count("images") {
        let uri = document.json["images"][index]["uri"].as_str().map(str::to_owned);
        let Some(uri) = uri.filter(|uri| !uri.starts_with("data:")) else { continue };
        let Some(bytes) = document.image_bytes(index)? else {
            notes.push(format!("images[{index}] ({uri}) is not there; the output still names it"));
            continue;
        };
        let Some(media) = media_type(&bytes) else {
            notes.push(format!("images[{index}] ({uri}) is of an unknown kind; the output still names it"));
            continue;
        };
        let view = document.push_view(&bytes, None);
        if let Some(image) = document.json["images"][index].as_object_mut() {
            image.shift_remove("uri");
            image.insert("mimeType".into(), json!(media));
            image.insert("bufferView".into(), json!(view));
            // Lets tools that unpack the file give the image its name back.
            image.entry("name").or_insert(json!(uri));
        }
        notes.push(format!("image {uri} was copied into the output"));
    }
    Ok(notes)
}

/// Fails where the asset has a coat already: worth asking before a long bake.
///
/// # Errors
/// Names the extension.
pub fn refuse_second(asset: &Asset) -> Result<()> {
    if asset.document.root().get("extensions").is_none_or(|e| e.get(NAME).is_none()) {
        return Ok(());
    }
    Err(Error::input("the input has a coat already")
        .with_file(&asset.document.name)
        .with_field(format!("extensions.{NAME}"))
        .with_found("a coat")
        .with_expected("an asset without one")
        .with_hint("bake from the file that this one was made from"))
}

/// The asset's document with the coat added: all that is new stands behind what was there.
///
/// # Errors
/// When the asset has a coat already, or the coat does not fit it.
pub fn with_coat(asset: &Asset, coat: &Coat, fallback: Fallback) -> Result<Document> {
    refuse_second(asset)?;
    with_packed(asset, coat, &packed(coat)?, fallback)
}

fn packed(coat: &Coat) -> Result<Vec<Packed>> {
    coat.tiles.iter().map(Packed::new).collect()
}

/// `textures` are those of the coat's tiles.
fn with_packed(asset: &Asset, coat: &Coat, textures: &[Packed], fallback: Fallback) -> Result<Document> {
    refuse_second(asset)?;
    let mut document = asset.document.clone();
    let tiles: Vec<Value> =
        (coat.tiles.iter().zip(textures)).map(|(tile, packed)| textures::write(&mut document, tile, packed)).collect();
    for primitive in &coat.primitives {
        check(primitive, part_of(asset, primitive)?, &coat.tiles)?;
    }
    let mut vertices = vec![(Value::Null, Vec::new()); coat.primitives.len()];
    for pool in pools(asset, &coat.primitives)? {
        let attributes = write_vertices(&mut document, &pool.vertices);
        for (index, numbers) in pool.members {
            vertices[index] = (attributes.clone(), numbers);
        }
    }
    let mut mirror = Vec::new();
    for (primitive, vertices) in coat.primitives.iter().zip(vertices) {
        let value = write_primitive(&mut document, primitive, vertices, part_of(asset, primitive)?.mirrored());
        let owner = &mut document.json["meshes"][primitive.mesh]["primitives"][primitive.primitive];
        match owner.get_mut("extensions").and_then(|e| e.get_mut(NAME)).and_then(Value::as_object_mut) {
            None => set_extension(owner, value),
            // A second coat of one primitive stands beside the first.
            Some(first) => {
                if let Some(more) = first.entry("more").or_insert_with(|| json!([])).as_array_mut() {
                    more.push(value);
                }
            }
        }
        mirror.push(json!({"mesh": primitive.mesh, "primitive": primitive.primitive, "tile": primitive.tile}));
    }
    // Tools that drop unknown extensions keep extras: enough to find out what was baked.
    let essentials: Vec<Value> = coat
        .tiles
        .iter()
        .map(|tile| {
            let edges = numbers(&[tile.edge_m, tile.height_m]);
            json!({"preset": tile.preset, "edge": edges[0], "height": edges[1], "layers": tile.shells.layers})
        })
        .collect();
    set_extension(
        &mut document.json,
        json!({"version": VERSION, "metresPerUnit": coat.metres_per_unit, "tiles": tiles}),
    );
    let extras =
        json!({"version": VERSION, "metresPerUnit": coat.metres_per_unit, "tiles": essentials, "primitives": mirror});
    if let Some(root) = document.json.as_object_mut() {
        let used = root.entry("extensionsUsed").or_insert_with(|| json!([]));
        if let Some(used) = used.as_array_mut() {
            used.push(json!(NAME));
        }
        // Extras may be anything; what is not an object is left alone.
        if let Some(object) = root.entry("extras").or_insert_with(|| json!({})).as_object_mut() {
            object.insert(NAME.into(), extras);
        }
    }
    if let Fallback::Shells(count) = fallback {
        fallback::add(&mut document, asset, coat, count)?;
    }
    Ok(document)
}

/// Accessors of coat vertices, by attribute.
fn write_vertices(document: &mut Document, vertices: &CoatPrimitive) -> Value {
    let mut attributes = json!({
        "BASE_VERTEX": document.push_integers(&vertices.base_vertex, 1, Use::Other),
        "TEXCOORD_0": document.push_vec2(&vertices.uv, Use::Other),
        "PATCH": document.push_integers(&vertices.patch, 1, Use::Other),
        "OFFSET": document.push_vec3(&vertices.offset, Use::Other),
        "AXIS": document.push_vec3(&vertices.axis, Use::Other),
        "TINT": document.push_vec4(&vertices.tint, Use::Other),
    });
    if !vertices.normal.is_empty() {
        attributes["NORMAL"] = json!(document.push_vec3(&vertices.normal, Use::Other));
    }
    if !vertices.longest.is_empty() {
        attributes["LONGEST"] = json!(document.push_floats(&vertices.longest, 1, Use::Other));
    }
    attributes
}

/// A texture of the file as glTF names it.
fn texture_info(texture: &Texture) -> Value {
    let mut info = json!({"index": texture.index, "texCoord": texture.uv_set});
    let plain = Texture::plain(texture.index, texture.image, texture.uv_set);
    if (texture.offset, texture.rotation_rad, texture.scale) != (plain.offset, plain.rotation_rad, plain.scale) {
        info["extensions"] = json!({"KHR_texture_transform": {
            "offset": numbers(&texture.offset.to_array()),
            "rotation": f64::from(texture.rotation_rad),
            "scale": numbers(&texture.scale.to_array()),
        }});
    }
    info
}

/// Windings are written as the primitive's own space has them, which a mirroring node turns round again. `vertices` are its
/// accessors and its vertices' numbers in them.
fn write_primitive(
    document: &mut Document,
    primitive: &CoatPrimitive,
    (attributes, numbers): (Value, Vec<u32>),
    mirrored: bool,
) -> Value {
    let of = |v: u32| numbers[v as usize];
    let turned = |t: [u32; 3]| if mirrored { [t[0], t[2], t[1]] } else { t };
    let indices: Vec<u32> = primitive.triangles.iter().flat_map(|&t| turned(t)).map(of).collect();
    let mut value = json!({
        "tile": primitive.tile,
        "indices": document.push_integers(&indices, 1, Use::Other),
        "attributes": attributes,
    });
    if let Some(colour) = &primitive.colour {
        value["colourTexture"] = texture_info(colour);
    }
    if let Some(painted) = &primitive.painted {
        value["paintedTexture"] = texture_info(painted);
    }
    if let Some(blend) = &primitive.blend {
        value["blend"] = json!({"tile": blend.tile, "weights": document.push_floats(&blend.weight, 1, Use::Other)});
    }
    if !primitive.fins.is_empty() {
        let edge = |fin: &crate::data::coat::FinEdge| {
            let [left, right] = fin.opposite;
            let opposite = if mirrored { [right, left] } else { [left, right] };
            [fin.ends[0], fin.ends[1], opposite[0], opposite[1]].map(of)
        };
        let edges: Vec<u32> = primitive.fins.iter().flat_map(edge).collect();
        let strips: Vec<f32> = primitive.fins.iter().flat_map(|fin| [fin.u[0], fin.u[1], fin.thickness]).collect();
        value["fins"] = json!({
            "edges": document.push_integers(&edges, 4, Use::Other),
            "strips": document.push_floats(&strips, 3, Use::Other),
        });
    }
    value
}
