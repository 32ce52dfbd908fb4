//! Decodes KHR_draco_mesh_compression, so that everything downstream sees plain accessors.

use super::document::{Document, drop_extension};
use super::encode::{Use, numbers};
use crate::error::{Error, Result};
use crate::math::Vec3;
use draco_core::{DataType, DecodeLimits, DecoderBuffer, Mesh, MeshDecoder, PointAttribute, PointIndex};
use serde_json::json;
use std::collections::BTreeSet;

const NAME: &str = "KHR_draco_mesh_compression";

/// What a stream of `length` bytes may decode to: no mesh is as regular as to take less than a byte for a thousand triangles.
fn limits(length: usize) -> DecodeLimits {
    let mut limits = DecodeLimits::default();
    let most = (1024 * length as u64).min(1 << 24);
    (limits.max_points, limits.max_faces, limits.max_decoded_bytes) = (most, most, 1 << 29);
    limits
}

/// What to try with a stream that cannot be read.
const CONVERT: &str = "decode it first, for example with `npx gltf-transform copy in.glb out.glb`";

/// A compressed primitive.
struct Stream {
    mesh: usize,
    primitive: usize,
    path: String,
    view: usize,
    /// Attribute, its number in the stream, its accessor.
    attributes: Vec<(String, u32, usize)>,
    indices: Option<usize>,
}

/// A mesh and one of its primitives.
type Place = (usize, usize);

/// Replaces every compressed primitive by what it decodes to and drops the extension.
///
/// # Errors
/// Names the primitive whose stream or description is broken.
pub fn decode(document: &mut Document, warnings: &mut Vec<String>) -> Result<()> {
    let (streams, plain) = streams(document)?;
    let count = streams.len() + plain.len();
    if count == 0 {
        return Ok(());
    }
    let mut filled = BTreeSet::new();
    for stream in &streams {
        let bytes = document.view(stream.view)?.to_vec();
        let mut decoded = Mesh::new();
        MeshDecoder::new()
            .decode(&mut DecoderBuffer::new(&bytes).with_limits(limits(bytes.len())), &mut decoded)
            .map_err(|error| fault(stream, &error.to_string()))?;
        fill(document, stream, &decoded, &mut filled)?;
    }
    for (mesh, primitive) in streams.iter().map(|s| (s.mesh, s.primitive)).chain(plain) {
        drop_extension(&mut document.json["meshes"][mesh]["primitives"][primitive], NAME);
    }
    document.forget_extension(NAME);
    warnings.push(format!("{count} primitives were decoded from {NAME}; the output holds them uncompressed"));
    Ok(())
}

/// The compressed primitives, and those whose accessors have data beside the stream.
fn streams(document: &Document) -> Result<(Vec<Stream>, Vec<Place>)> {
    let (mut streams, mut plain) = (Vec::new(), Vec::new());
    let accessors = document.count("accessors");
    for (mesh, at) in document.root().list("meshes")?.iter().enumerate() {
        for (primitive, at) in at.list("primitives")?.iter().enumerate() {
            let Some(extension) = at.get("extensions").and_then(|e| e.get(NAME)) else { continue };
            let named = at.need("attributes")?;
            let mut attributes = Vec::new();
            for (name, id) in extension.need("attributes")?.members()? {
                let id = u32::try_from(id.size()?).map_err(|_| id.fault("a number of 32 bits"))?;
                attributes.push((name.to_owned(), id, named.need(name)?.index_into("accessors", accessors)?));
            }
            let has_data = |(_, _, accessor): &(String, u32, usize)| -> Result<bool> {
                Ok(document.root().entry("accessors", *accessor)?.get("bufferView").is_some())
            };
            if !attributes.is_empty()
                && attributes.iter().map(has_data).collect::<Result<Vec<_>>>()?.iter().all(|has| *has)
            {
                plain.push((mesh, primitive));
                continue;
            }
            streams.push(Stream {
                mesh,
                primitive,
                path: extension.path.clone(),
                view: extension.need("bufferView")?.index_into("bufferViews", document.count("bufferViews"))?,
                attributes,
                indices: at.reference("indices", "accessors", accessors)?,
            });
        }
    }
    Ok((streams, plain))
}

/// Puts decoded data behind the accessors of a primitive. An accessor that another stream has filled is left to it.
fn fill(document: &mut Document, stream: &Stream, decoded: &Mesh, filled: &mut BTreeSet<usize>) -> Result<()> {
    let points = decoded.num_points();
    let place = format!("/meshes/{}/primitives/{}", stream.mesh, stream.primitive);
    for (name, id, accessor) in &stream.attributes {
        let attribute =
            decoded.attribute_by_unique_id(*id).ok_or_else(|| fault(stream, &format!("it has no {name}")))?;
        let (component, mut bytes) = elements(attribute, points)
            .ok_or_else(|| fault(stream, &format!("its {name} is cut or of another type")))?;
        // Weights that were rounded for the stream no longer sum to 1, as they must.
        let sets = stream.attributes.iter().filter(|(name, ..)| name.starts_with("WEIGHTS_")).count();
        if name.starts_with("WEIGHTS_") && sets == 1 && component == 5126 {
            normalise(&mut bytes);
        }
        let stated = document.root().entry("accessors", *accessor)?;
        let kind = stated.need("type")?;
        let components = usize::from(attribute.num_components());
        if kind.text()? != ["", "SCALAR", "VEC2", "VEC3", "VEC4"].get(components).copied().unwrap_or_default() {
            return Err(kind.fault(&format!("a type of {components} components, as the Draco stream has")));
        }
        let bounded = name == "POSITION" && component == 5126;
        let (bounds, mut changed) = (bounded.then(|| bounds(&bytes)), stated.value.clone());
        // Vertices lie on multiples of four bytes.
        let element = bytes.len() / points.max(1);
        let stride = element.next_multiple_of(4);
        let padded: Vec<u8> = if stride == element {
            bytes
        } else {
            bytes
                .chunks_exact(element)
                .flat_map(|e| e.iter().copied().chain(std::iter::repeat_n(0, stride - element)))
                .collect()
        };
        let view = document.push_view(&padded, Some(34962));
        if stride != element {
            document.json["bufferViews"][view]["byteStride"] = json!(stride);
        }
        changed["bufferView"] = json!(view);
        changed["componentType"] = json!(component);
        changed["count"] = json!(points);
        if let (Some([low, high]), true) = (bounds, points > 0) {
            (changed["min"], changed["max"]) = (numbers(&low.to_array()), numbers(&high.to_array()));
        }
        if let Some(object) = changed.as_object_mut() {
            object.shift_remove("byteOffset");
            object.shift_remove("sparse");
        }
        if filled.insert(*accessor) {
            document.json["accessors"][*accessor] = changed;
        } else {
            let own = document.push("accessors", changed);
            if let Some(primitive) = document.json.pointer_mut(&place) {
                primitive["attributes"][name.as_str()] = json!(own);
            }
        }
    }
    let corners: Vec<u32> = decoded.faces().iter().flatten().map(|corner| corner.0).collect();
    let indices = document.push_integers(&corners, 1, Use::Indices);
    match stream.indices {
        Some(accessor) if filled.insert(accessor) => {
            let own = document.json["accessors"].as_array_mut().and_then(Vec::pop).unwrap_or_default();
            document.json["accessors"][accessor] = own;
        }
        _ => {
            if let Some(primitive) = document.json.pointer_mut(&place) {
                primitive["indices"] = json!(indices);
            }
        }
    }
    // Strips come out as single triangles.
    if let Some(primitive) = document.json.pointer_mut(&place).and_then(|p| p.as_object_mut()) {
        primitive.shift_remove("mode");
    }
    Ok(())
}

/// Every point's value, tightly packed, and the type of its components as glTF numbers it.
fn elements(attribute: &PointAttribute, points: usize) -> Option<(u32, Vec<u8>)> {
    let components = usize::from(attribute.num_components());
    let component = match attribute.data_type() {
        DataType::Int8 => 5120,
        DataType::Uint8 => 5121,
        DataType::Int16 => 5122,
        DataType::Uint16 => 5123,
        DataType::Uint32 => 5125,
        DataType::Float32 => 5126,
        _ => return None,
    };
    let element = components * attribute.data_type().byte_length();
    let stride = usize::try_from(attribute.byte_stride()).ok()?;
    let data = attribute.buffer().data();
    let mut bytes = Vec::with_capacity(points * element);
    for point in 0..points {
        let value = attribute.mapped_index(PointIndex(u32::try_from(point).ok()?)).0 as usize;
        let at = value.checked_mul(stride)?;
        bytes.extend_from_slice(data.get(at..at.checked_add(element)?)?);
    }
    Some((component, bytes))
}

/// Scales quadruples of floats so that each sums to 1.
fn normalise(bytes: &mut [u8]) {
    for four in bytes.as_chunks_mut::<16>().0 {
        let weights: [f32; 4] = std::array::from_fn(|i| f32::from_le_bytes(std::array::from_fn(|b| four[4 * i + b])));
        let sum: f32 = weights.iter().sum();
        if sum > 0.0 && sum.is_finite() {
            for (bytes, weight) in four.as_chunks_mut::<4>().0.iter_mut().zip(weights) {
                *bytes = (weight / sum).to_le_bytes();
            }
        }
    }
}

fn bounds(bytes: &[u8]) -> [Vec3; 2] {
    let floats = bytes.as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b)).collect::<Vec<f32>>();
    let points = || floats.chunks_exact(3).map(Vec3::from_slice);
    [points().fold(Vec3::INFINITY, Vec3::min), points().fold(Vec3::NEG_INFINITY, Vec3::max)]
}

fn fault(stream: &Stream, found: &str) -> Error {
    Error::input("a Draco stream cannot be decoded")
        .with_field(stream.path.clone())
        .with_found(found)
        .with_expected("a whole stream with the attributes that the primitive names")
        .with_hint(CONVERT)
}
