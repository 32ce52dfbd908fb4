//! A coat into a document, and the document into files.

use super::expressions;
use super::fallback::{self, Fallback};
use super::input::{self, Input};
use super::parts::{check, part_of, set_extension};
use super::pool::pools;
use super::strip::Stripped;
use super::textures::{self, Packed};
use super::worn::refuse_second;
use super::{NAME, VERSION};
use crate::asset::document::Document;
use crate::asset::encode::{Use, numbers};
use crate::asset::glb::is_glb;
use crate::asset::image::media_type;
use crate::asset::{Asset, uri, write};
use crate::data::coat::{Coat, CoatPrimitive};
use crate::data::texture::Texture;
use crate::error::{Error, Kind, Result};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Checks, before any work is done, that `out` can be written: a glTF file, in a folder that exists, and none of `inputs`. Gives
/// whether it is a text with a `.bin` beside it.
///
/// # Errors
/// Says what it is instead.
pub fn check_output(out: &Path, inputs: &[PathBuf]) -> Result<bool> {
    let text = is_text(out)?;
    write::check_target(out, inputs)?;
    if text {
        write::check_target(&out.with_extension("bin"), inputs)?;
    }
    Ok(text)
}

/// Writes the asset with its coat to `out`, a `.glb` or `.vrm`, or a `.gltf` with a `.bin` beside it. Gives what the user should
/// know: images that were taken along, or that were not there, and whether the input can be given back.
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
    let text = check_output(out, &asset.document.files)?;
    let (mut document, mut notes) = with_packed(asset, coat, textures, fallback)?;
    notes.extend(bring_images(&mut document, out, text)?);
    notes.extend(input::store(&mut document)?);
    write_document(document, out, text)?;
    Ok(notes)
}

/// Writes what is left of a document without its coat to `out`: the input's bytes where they are there and of the same kind
/// of file. Gives whether they were, and what the user should know.
///
/// # Errors
/// When the output cannot be written.
pub fn write_stripped(stripped: Stripped, out: &Path) -> Result<(bool, Vec<String>)> {
    let Stripped { mut document, input, mut notes, .. } = stripped;
    let text = check_output(out, &document.files)?;
    let why = match input {
        Input::Whole(bytes) if is_glb(&bytes) != text => {
            write::whole(out, &bytes, &document.files)?;
            notes.extend(input::files_beside(&bytes, out)?);
            return Ok((true, notes));
        }
        Input::Whole(_) if text => "the input was a .glb",
        Input::Whole(_) => "the input was a .gltf",
        Input::Lost(why) => why,
    };
    notes.push(format!("these are not the bytes of the input: {why}"));
    notes.extend(bring_images(&mut document, out, text)?);
    write_document(document, out, text)?;
    Ok((false, notes))
}

/// Whether `out` is a `.gltf`, a text with its data beside it, by its ending.
fn is_text(out: &Path) -> Result<bool> {
    let extension = out.extension().map(|e| e.to_string_lossy().to_lowercase());
    match extension.as_deref() {
        // An avatar is a GLB with members of its own.
        Some("glb" | "vrm") => Ok(false),
        Some("gltf") => Ok(true),
        _ => Err(Error::usage("the output must be glTF")
            .with_file(out)
            .with_found(extension.unwrap_or_else(|| "no extension".into()))
            .with_expected(".glb, .gltf or .vrm")),
    }
}

/// Copies images that lie in files into the buffer, unless the output lies beside them.
fn bring_images(document: &mut Document, out: &Path, text: bool) -> Result<Vec<String>> {
    let beside = text && same_folder(out, document.folder.as_deref());
    if beside { Ok(Vec::new()) } else { take_images_along(document) }
}

fn write_document(mut document: Document, out: &Path, text: bool) -> Result<()> {
    if !text {
        return write::whole(out, &document.to_glb()?, &document.files);
    }
    if document.binary.is_empty() {
        return write::whole(out, &to_text(&document.json)?, &document.files);
    }
    let binary = out.with_extension("bin");
    let name = binary.file_name().unwrap_or_default().to_string_lossy();
    document.json["buffers"][0]["uri"] = json!(uri::encode(&name));
    let json = to_text(&document.json)?;
    write::all(&[(binary, &document.binary), (out.to_owned(), &json)], &document.files)
}

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
        let bytes = match document.image_bytes(index) {
            Ok(Some(bytes)) => bytes,
            Ok(None) => {
                notes.push(format!("images[{index}] ({uri}) is not there; the output still names it"));
                continue;
            }
            Err(error) => {
                notes
                    .push(format!("images[{index}] ({uri}) cannot be read: {}; the output still names it", error.what));
                continue;
            }
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

/// The asset's document with the coat added: all that is new stands behind what was there.
///
/// # Errors
/// When the asset has a coat already, or the coat does not fit it.
pub fn with_coat(asset: &Asset, coat: &Coat, fallback: Fallback) -> Result<Document> {
    refuse_second(asset)?;
    with_packed(asset, coat, &packed(coat)?, fallback).map(|(document, _)| document)
}

fn packed(coat: &Coat) -> Result<Vec<Packed>> {
    coat.tiles.iter().map(Packed::new).collect()
}

/// The document with the coat, and what the user should know of it. `textures` are those of the coat's tiles.
fn with_packed(asset: &Asset, coat: &Coat, textures: &[Packed], fallback: Fallback) -> Result<(Document, Vec<String>)> {
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
    let shells = match fallback {
        Fallback::None => Vec::new(),
        Fallback::Shells(count) => fallback::add(&mut document, asset, coat, count)?,
    };
    let notes = expressions::follow(&mut document, asset, coat, &shells);
    Ok((document, notes))
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
