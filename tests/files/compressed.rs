//! Draco streams and Basis Universal textures.

use super::{bake, close, glb, hair_colour, load, plane, png, says};
use base64::Engine;
use draco_core::{DataType, EncoderBuffer, EncoderOptions, GeometryAttributeType, Mesh, MeshEncoder, PointAttribute};
use furrier::asset::{self, Document};
use furrier::data::image::linear_from_srgb8;
use serde_json::json;

/// Eight by eight pixels, red on the left and blue on the right, as ETC1S, UASTC, and UASTC in zstd.
const TWO_COLOURS: [&str; 3] = [
    "q0tUWCAyMLsNChoKAAAAAAEAAAAIAAAACAAAAAAAAAAAAAAAAQAAAAEAAAABAAAAaAAAACwAAACUAAAAJAAAALgAAAAAAAAAjAAAAAAAAABEAQAAAAAAAAIAAAAAAAAAAAAAAAAAAAAsAAAAAAAAAAIAKACjAQIAAwMAAAgAAAAAAAAAAAA/AAAAAAAAAAAA/////x8AAABLVFh3cml0ZXIAQmFzaXMgVW5pdmVyc2FsIDIuMTAAAAIAAgAvAAAACQAAACwAAAAAAAAAAAAAAAAAAAACAAAAAAAAAAAAAAAewJQAAAAAAACyQqQBTAkAAAAAAEHRAxYagIkAAAAAAABkgAEwBUAAAAAAgAxhFQQAAAAoqqqqAmDARAAAAAAAAJJKAJgAEAAAAABAHAEmBAgAAACAIHJKAcAEAAAAAAAAAggAkAE=",
    "q0tUWCAyMLsNChoKAAAAAAEAAAAIAAAACAAAAAAAAAAAAAAAAQAAAAEAAAAAAAAAaAAAACwAAACUAAAALAAAAAAAAAAAAAAAAAAAAAAAAADAAAAAAAAAAEAAAAAAAAAAQAAAAAAAAAAsAAAAAAAAAAIAKACmAQIAAwMAABAAAAAAAAAAAAB/AAAAAAAAAAAA/////x8AAABLVFh3cml0ZXIAQmFzaXMgVW5pdmVyc2FsIDIuMTAAAAQAAAB/fwAAFxmF4j+1AwAAAAAAAAAAAJeCh/Z/FKcCAAAAAAAAAAAXGYXiP7UDAAAAAAAAAAAAl4KH9n8UpwIAAAAAAAAAAA==",
    "q0tUWCAyMLsNChoKAAAAAAEAAAAIAAAACAAAAAAAAAAAAAAAAQAAAAEAAAACAAAAaAAAACwAAACUAAAAJAAAAAAAAAAAAAAAAAAAAAAAAAC4AAAAAAAAACQAAAAAAAAAQAAAAAAAAAAsAAAAAAAAAAIAKACmAQIAAwMAABAAAAAAAAAAAAB/AAAAAAAAAAAA/////x8AAABLVFh3cml0ZXIAQmFzaXMgVW5pdmVyc2FsIDIuMTAAACi1L/0gQN0AAIAXGYXiP7UDAJeCh/Z/FKcCAwBDYTDz8RdwAQ==",
];

fn texture(number: usize) -> Vec<u8> {
    base64::engine::general_purpose::STANDARD.decode(TWO_COLOURS[number]).unwrap()
}

#[test]
fn hair_has_the_colours_of_basis_textures() {
    let folder = tempfile::tempdir().unwrap();
    let material = json!({"name": "Fur", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}});
    let mean = |a: [u8; 3], b: [u8; 3]| [0, 1, 2].map(|i| 0.5 * (linear_from_srgb8(a[i]) + linear_from_srgb8(b[i])));
    let expected = mean([200, 40, 20], [20, 60, 180]);
    for number in 0..3 {
        let mut document = plane(material.clone(), &[&texture(number)]);
        document.push("textures", json!({"extensions": {"KHR_texture_basisu": {"source": 0}}}));
        document.json["extensionsUsed"] = json!(["KHR_texture_basisu"]);
        document.json["extensionsRequired"] = json!(["KHR_texture_basisu"]);
        let path = glb(&document, folder.path(), "basis.glb");
        assert_eq!(load(&path).warnings, Vec::<String>::new());
        let found = hair_colour(&path);
        assert!(
            (found - furrier::math::Vec3::from(expected)).abs().max_element() < 0.03,
            "{number}: {found} {expected:?}"
        );
        // The texture stays as it is, and the coat names it.
        let out = folder.path().join("out.glb");
        bake(&path, &out).unwrap();
        let written = load(&out);
        assert_eq!(written.document.image_bytes(0).unwrap().unwrap(), texture(number));
        let carried = &written.document.json["meshes"][0]["primitives"][0]["extensions"]["FURRIER_mesh_fur"];
        assert_eq!(carried["colourTexture"]["index"], 0);
    }
    // An image for those who cannot decode it comes first.
    let mut document = plane(material, &[&texture(0), &png([0, 255, 0])]);
    document.push("textures", json!({"source": 1, "extensions": {"KHR_texture_basisu": {"source": 0}}}));
    assert!(close(hair_colour(&glb(&document, folder.path(), "both.glb")), [0.0, 1.0, 0.0]));
}

#[test]
fn a_texture_that_claims_much_is_left_out() {
    let material = json!({"name": "Fur", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}});
    let mut bytes = texture(2);
    // What its level decompresses to: 280 TB.
    bytes[80 + 16 + 5] = 0xFF;
    let mut document = plane(material, &[&bytes]);
    document.push("textures", json!({"extensions": {"KHR_texture_basisu": {"source": 0}}}));
    let asset = asset::Asset::new(document, Vec::new()).unwrap();
    assert!(says(&asset.warnings, &["images[0]", "claims 280375465082"]), "{:?}", asset.warnings);
    assert_eq!(asset.parts[0].base_colour.texture, None);
}

/// The sample with its only primitive as a Draco stream, and nothing beside it.
fn compressed(name: &str, speed: i32) -> Document {
    let mut document = asset::load(name).unwrap().document;
    let primitive = document.json["meshes"][0]["primitives"][0].clone();
    let accessor = |key: &str| primitive["attributes"][key].as_u64().unwrap() as usize;
    let indices = document.integers(primitive["indices"].as_u64().unwrap() as usize, 1).unwrap();
    let mut mesh = Mesh::new();
    let points = document.floats(accessor("POSITION"), 3).unwrap().len() / 3;
    mesh.set_num_points(points);
    let mut ids = serde_json::Map::new();
    for (key, kind, width) in [
        ("POSITION", GeometryAttributeType::Position, 3),
        ("NORMAL", GeometryAttributeType::Normal, 3),
        ("TEXCOORD_0", GeometryAttributeType::TexCoord, 2),
    ] {
        let mut attribute = PointAttribute::new();
        attribute.init(kind, width, DataType::Float32, false, points);
        let bytes: Vec<u8> =
            document.floats(accessor(key), usize::from(width)).unwrap().iter().flat_map(|f| f.to_le_bytes()).collect();
        attribute.buffer_mut().data_mut()[..bytes.len()].copy_from_slice(&bytes);
        ids.insert(key.into(), json!(mesh.add_attribute(attribute)));
    }
    mesh.set_num_faces(indices.len() / 3);
    mesh.set_faces_from_flat_indices(&indices);
    let mut encoder = MeshEncoder::new();
    encoder.set_mesh(mesh);
    let mut options = EncoderOptions::new();
    options.set_compression_level(10 - speed);
    let mut out = EncoderBuffer::new();
    encoder.encode(&options, &mut out).unwrap();
    for index in [
        accessor("POSITION"),
        accessor("NORMAL"),
        accessor("TEXCOORD_0"),
        primitive["indices"].as_u64().unwrap() as usize,
    ] {
        document.json["accessors"][index].as_object_mut().unwrap().remove("bufferView");
    }
    let view = document.push_view(out.data(), None);
    document.json["meshes"][0]["primitives"][0]["extensions"] =
        json!({"KHR_draco_mesh_compression": {"bufferView": view, "attributes": ids}});
    document.json["extensionsUsed"] = json!(["KHR_draco_mesh_compression"]);
    document.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    document
}

#[test]
fn draco_streams_are_decoded() {
    let folder = tempfile::tempdir().unwrap();
    let plain = asset::load("sample:sphere").unwrap();
    let area = |asset: &asset::Asset| {
        let mesh = asset.parts[0].mesh(1.0).unwrap();
        (0..mesh.triangles.len()).map(|t| mesh.area_m2(t)).sum::<f32>()
    };
    for speed in [0, 5, 10] {
        let document = compressed("sample:sphere", speed);
        let path = glb(&document, folder.path(), "draco.glb");
        let asset = load(&path);
        assert!(says(&asset.warnings, &["1 primitives were decoded from KHR_draco_mesh_compression"]));
        assert_eq!(asset.parts[0].stored.triangles.len(), plain.parts[0].stored.triangles.len());
        assert!((area(&asset) / area(&plain) - 1.0).abs() < 1e-3, "{} {}", area(&asset), area(&plain));
        let normals = asset.parts[0].stored.positions.iter().zip(&asset.parts[0].stored.normals);
        assert!(normals.clone().all(|(p, n)| p.normalize().dot(*n) > 0.99));
        assert_eq!(asset.parts[0].stored.uv_sets.len(), 1);
        for key in ["extensionsUsed", "extensionsRequired"] {
            assert!(asset.document.json.get(key).is_none(), "{key}");
        }
        assert!(asset.document.json["meshes"][0]["primitives"][0].get("extensions").is_none());
    }
    // Where the stream is broken, that is said with what to try.
    let mut document = compressed("sample:sphere", 5);
    let view =
        document.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]["bufferView"].clone();
    document.json["bufferViews"][view.as_u64().unwrap() as usize]["byteLength"] = json!(60);
    let path = glb(&document, folder.path(), "cut.glb");
    let error = asset::load(&path.to_string_lossy()).unwrap_err();
    assert!(error.hint.as_deref().is_some_and(|hint| hint.contains("gltf-transform")), "{error}");
    assert_eq!(error.field.as_deref(), Some("meshes[0].primitives[0].extensions.KHR_draco_mesh_compression"));
}

#[test]
fn draco_files_of_other_programs_are_decoded() {
    let Some(shared) = crate::common::shared() else { return };
    for name in ["draco.glb", "skinned_draco.glb"] {
        let path = shared.join("hard").join(name);
        let asset = load(&path);
        let stated = raw_json(&std::fs::read(&path).unwrap());
        let primitive = &stated["meshes"][0]["primitives"][0];
        let count = |accessor: &serde_json::Value| {
            stated["accessors"][accessor.as_u64().unwrap() as usize]["count"].as_u64().unwrap()
        };
        let part = &asset.parts[0];
        assert_eq!(part.stored.triangles.len() as u64, count(&primitive["indices"]) / 3, "{name}");
        assert_eq!(part.stored.influences.is_some(), name.starts_with("skinned"), "{name}");
        // Bounds were written before compression, which moves positions by little.
        let stated = &stated["accessors"][primitive["attributes"]["POSITION"].as_u64().unwrap() as usize];
        let low = part.stored.positions.iter().copied().reduce(furrier::math::Vec3::min).unwrap();
        for (i, found) in low.to_array().into_iter().enumerate() {
            assert!((f64::from(found) - stated["min"][i].as_f64().unwrap()).abs() < 1e-2, "{name}: {found}");
        }
    }
}

/// The JSON chunk of a GLB.
fn raw_json(bytes: &[u8]) -> serde_json::Value {
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    serde_json::from_slice(&bytes[20..20 + length]).unwrap()
}

#[test]
fn mutated_streams_never_panic() {
    let draco = compressed("sample:cylinder", 5);
    let mut basis =
        plane(json!({"name": "Fur", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}), &[&texture(0)]);
    basis.push("textures", json!({"extensions": {"KHR_texture_basisu": {"source": 0}}}));
    for (document, count) in [(draco, 150), (basis, 400)] {
        let view = document.json["bufferViews"].as_array().unwrap().last().unwrap().clone();
        let [start, length] = ["byteOffset", "byteLength"].map(|key| view[key].as_u64().unwrap_or(0));
        let mut accepted = 0;
        for seed in 0..count {
            let mut stream = furrier::math::hash::Stream::new(seed);
            let mut other = document.clone();
            for _ in 0..1 + stream.bits() % 6 {
                other.binary[(start + stream.bits() % length) as usize] = stream.bits() as u8;
            }
            let bytes = other.to_glb().unwrap();
            let parsed = || {
                let mut warnings = Vec::new();
                let document = Document::parse(&bytes, std::path::Path::new("mutated.glb"), &mut warnings)?;
                let asset = asset::Asset::new(document, warnings)?;
                let image = asset.parts[0].base_colour.texture.as_ref().map(|texture| texture.image);
                image.map(|image| asset.document.decode_image(image)).transpose()
            };
            let result = std::panic::catch_unwind(std::panic::AssertUnwindSafe(parsed));
            accepted += usize::from(result.unwrap_or_else(|_| panic!("seed {seed} panics")).is_ok());
        }
        assert!(accepted > 5, "{accepted} are accepted, so little was tested");
    }
}
