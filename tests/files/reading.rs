//! What is wrong with a file and stops nothing, and what stops before the work.

use super::{bake, glb, load, plane, png, put, request, says};
use crate::one_skin::thin;
use furrier::asset::{self, Document};
use furrier::bake::{Method, Request};
use furrier::error::Kind;
use furrier::preset::Preset;
use serde_json::{Value, json};
use std::path::Path;

fn fur() -> Document {
    plane(json!({"name": "Fur", "pbrMetallicRoughness": {"baseColorFactor": [0.4, 0.2, 0.1, 1]}}), &[])
}

/// A GLB with this text and padding for a JSON chunk.
fn with_text(document: &Document, text: &[u8], padding: u8) -> Vec<u8> {
    let mut json = text.to_vec();
    // One word of padding at least.
    json.resize((json.len() + 4).next_multiple_of(4), padding);
    let mut binary = document.binary.clone();
    binary.resize(binary.len().next_multiple_of(4), 0);
    let mut glb = b"glTF\x02\0\0\0".to_vec();
    glb.extend(((12 + 8 + json.len() + 8 + binary.len()) as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", &json), (b"BIN\0", &binary)] {
        glb.extend((chunk.len() as u32).to_le_bytes());
        glb.extend(kind);
        glb.extend(chunk);
    }
    glb
}

#[test]
fn text_that_can_be_mended_is_mended_and_said() {
    let folder = tempfile::tempdir().unwrap();
    let mut document = fur();
    document.json["nodes"][0]["name"] = json!("PELUCHE? 🐻");
    let text = document.json.to_string();
    let named = |name: &[u8]| {
        let at = text.find("PELUCHE? 🐻").unwrap();
        [&text.as_bytes()[..at], name, &text.as_bytes()[at + "PELUCHE? 🐻".len()..]].concat()
    };
    let cases: [(&[u8], u8, &str, &[&str]); 7] = [
        ("PELUCHE? 🐻".as_bytes(), 0, "PELUCHE? 🐻", &["padded with", "zeros"]),
        (b"PELUCHE\xC9", b' ', "PELUCHEÉ", &["1 bytes", "not UTF-8", "Latin-1", "PELUCHEÉ"]),
        ("ours 🐻 \u{e9}".as_bytes(), b' ', "ours 🐻 é", &[]),
        (b"fur \\ud83d!", b' ', "fur \u{fffd}!", &["half a surrogate pair", "fur"]),
        (b"\\udc3b\\ud83d\\udc3b", b' ', "\u{fffd}🐻", &["1 characters", "half a surrogate pair"]),
        (b"tab\there \\\\", b' ', "tab\there \\", &["1 characters", "escaped", "tab"]),
        (b"C:\\\\ud83d \\ud83d\\udc3b \xC9", b' ', "C:\\ud83d 🐻 É", &["Latin-1"]),
    ];
    for (name, padding, expected, words) in cases {
        let path = put(folder.path(), "odd.glb", with_text(&document, &named(name), padding));
        let asset = load(&path);
        assert_eq!(asset.document.json["nodes"][0]["name"], expected);
        assert_eq!(asset.warnings.len(), usize::from(!words.is_empty()), "{:?}", asset.warnings);
        assert!(words.is_empty() || says(&asset.warnings, words), "{words:?}: {:?}", asset.warnings);
    }
    // Zeros before spaces, and what memory held before.
    for (behind, word) in [(&b"\0\0\0\0  "[..], "4 zeros"), (b"\xCD\xCD\xCD", "3 bytes of anything")] {
        let text = [document.json.to_string().as_bytes(), behind].concat();
        let asset = load(&put(folder.path(), "odd.glb", with_text(&document, &text, b' ')));
        assert!(says(&asset.warnings, &["the JSON is padded with", word]), "{word}: {:?}", asset.warnings);
    }
    // What is no JSON even so is refused as before.
    let path = put(folder.path(), "odd.glb", with_text(&document, b"{\"asset\": \xC9}", b' '));
    let error = asset::load(&path.to_string_lossy()).unwrap_err();
    assert_eq!((error.field.as_deref(), error.kind), (Some("JSON"), Kind::Input));
}

/// A second mesh beside the first, on a node with this transform.
fn with_prop(transform: &Value) -> Document {
    let mut document = fur();
    let material = document.push("materials", json!({"name": "Collar"}));
    let mut mesh = document.json["meshes"][0].clone();
    mesh["primitives"][0]["material"] = json!(material);
    let mesh = document.push("meshes", mesh);
    let mut node = transform.clone();
    node["mesh"] = json!(mesh);
    let node = document.push("nodes", node);
    document.json["scenes"][0]["nodes"].as_array_mut().unwrap().push(json!(node));
    document
}

#[test]
fn what_is_hidden_by_a_scale_of_zero_gets_no_fur() {
    let folder = tempfile::tempdir().unwrap();
    for transform in [
        json!({"scale": [0, 0, 0]}),
        json!({"scale": [1, 0, 1]}),
        json!({"scale": [1e-30, 1e-30, 1e-30]}),
        json!({"matrix": [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 2, 3, 1]}),
    ] {
        let path = glb(&with_prop(&transform), folder.path(), "prop.glb");
        let baked = bake(&path, &folder.path().join("out.glb")).unwrap();
        assert_eq!(baked.materials, ["Fur"], "{transform}");
        assert!(says(&baked.warnings, &["meshes[1].primitives[0]", "nodes[1]", "without fur"]), "{:?}", baked.warnings);
    }
    // Shown by two nodes, it is furred as the other one shows it, and both wear it.
    let mut document = fur();
    document.json["nodes"][0]["scale"] = json!([0, 0, 0]);
    let node = document.push("nodes", json!({"mesh": 0, "translation": [5, 0, 0]}));
    document.json["scenes"][0]["nodes"].as_array_mut().unwrap().push(json!(node));
    let asset = load(&glb(&document, folder.path(), "two.glb"));
    assert_eq!(asset.parts[0].nodes, [1, 0]);
    assert!((asset.diagonal_units - 0.2 * 2.0_f64.sqrt()).abs() < 1e-6, "{}", asset.diagonal_units);
    // Alone, it is an error that says what to do.
    let mut document = fur();
    document.json["nodes"][0]["scale"] = json!([0, 0, 0]);
    let error = asset::load(&glb(&document, folder.path(), "alone.glb").to_string_lossy()).unwrap_err();
    assert_eq!(error.field.as_deref(), Some("nodes[0]"));
}

#[test]
fn separators_of_windows_lead_into_folders() {
    let folder = tempfile::tempdir().unwrap();
    put(folder.path(), "textures/red.png", png([255, 0, 0]));
    let mut document = plane(json!({"name": "Fur", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}), &[]);
    document.push("images", json!({"uri": "textures\\red.png"}));
    document.push("textures", json!({"source": 0}));
    document.json["buffers"][0]["uri"] = json!("data\\mesh.bin");
    put(folder.path(), "data/mesh.bin", &document.binary);
    let path = put(folder.path(), "red.gltf", document.json.to_string());
    let found = super::hair_colour(&path);
    assert!(super::close(found, [1.0, 0.0, 0.0]), "{found}");
    // In another folder the output brings the image along.
    let out = folder.path().join("data/out.glb");
    bake(&path, &out).unwrap();
    assert_eq!(load(&out).document.image_bytes(0).unwrap().unwrap(), png([255, 0, 0]));
}

#[test]
fn the_first_version_is_named_with_what_converts_it() {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in [
        ("text.gltf", r#"{"asset": {"version": "1.0"}, "scenes": {"s": {}}, "nodes": {}}"#),
        ("number.gltf", r#"{"asset": {"version": 1.0}, "scenes": {}}"#),
        ("one.gltf", r#"{"asset": {"version": 1}}"#),
        ("container.glb", "glTF\u{1}\0\0\0\u{14}\0\0\0\0\0\0\0\0\0\0\0"),
    ] {
        let error = asset::load(&put(folder.path(), name, text).to_string_lossy()).unwrap_err();
        assert!(error.hint.as_deref().is_some_and(|hint| hint.contains("gltf-pipeline")), "{name}: {error}");
    }
    // A number where a text belongs is no reason to refuse the second.
    let mut document = fur();
    document.json["asset"]["version"] = json!(2.0);
    load(&glb(&document, folder.path(), "two.glb"));
}

#[test]
fn outputs_are_checked_before_the_work() {
    let folder = tempfile::tempdir().unwrap();
    let missing = Path::new("there is no such file.glb");
    for (out, kind) in [("out.txt", Kind::Usage), ("out", Kind::Usage), ("no/such/folder/out.glb", Kind::Output)] {
        let error = bake(missing, &folder.path().join(out)).unwrap_err();
        assert_eq!(error.kind, kind, "{out}: {error}");
    }
    // A text's buffer lies beside it, and is no input's.
    let document = fur();
    let mut json = document.json.clone();
    json["buffers"][0]["uri"] = json!("out.bin");
    put(folder.path(), "out.bin", &document.binary);
    let path = put(folder.path(), "in.gltf", json.to_string());
    let error = bake(&path, &folder.path().join("out.gltf")).unwrap_err();
    assert_eq!(error.kind, Kind::Output, "{error}");
    assert_eq!(std::fs::read(folder.path().join("out.bin")).unwrap(), document.binary);
}

#[test]
fn options_that_cannot_be_met_are_told_before_the_hair_grows() {
    let folder = tempfile::tempdir().unwrap();
    let path = glb(&fur(), folder.path(), "in.glb");
    put(folder.path(), "region.toml", "size_m = 0.3\n[guard]\nlength = { mm = 5 }\n");
    let region = |place: &str| {
        let text = format!("size_m = 0.3\n[[regions]]\npreset = \"region.toml\"\n{place}\n");
        Preset::load(&put(folder.path(), "own.toml", text).to_string_lossy()).unwrap()
    };
    let map = thin(&[&format!("maps.length={:?}", folder.path().join("none.png").to_string_lossy())]);
    for (what, preset, method) in [
        ("a UV set", thin(&[]), Method::Uv(3)),
        ("a map", map, Method::Lapped),
        ("a region's material", region("material = \"Nobody\""), Method::Lapped),
        ("a region's map", region("map = \"none.png\""), Method::Lapped),
        ("a region's place", region(""), Method::Lapped),
    ] {
        let request = Request { preset, method, ..request(&path, &folder.path().join("out.glb")) };
        let mut steps = Vec::new();
        let error = furrier::bake::bake(&request, &mut |step| steps.push(step)).unwrap_err();
        assert!(!steps.contains(&"grow"), "{what}: {steps:?}: {error}");
    }
}
