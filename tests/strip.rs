//! A coat comes off again: the input's bytes where nothing was changed since, else all but the coat.

use crate::common::{furrier_path, shared};
use crate::made::coat_for;
use assert_cmd::Command;
use furrier::asset::coat::{Input, NAME, Stripped, Worn, strip, with_coat, write_stripped};
use furrier::asset::{self, Document, Fallback, read_document, write_coat};
use predicates::prelude::*;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// A GLB put together by hand: chunks in the order given, and the length that its header states.
fn glb(chunks: &[(&[u8; 4], &[u8])], more: u32) -> Vec<u8> {
    let body: Vec<u8> = (chunks.iter())
        .flat_map(|(kind, bytes)| [&(bytes.len() as u32).to_le_bytes()[..], &kind[..], bytes].concat())
        .collect();
    let length = body.len() as u32 + 12 + more;
    [b"glTF", &2_u32.to_le_bytes()[..], &length.to_le_bytes(), &body].concat()
}

/// `sample:plane` as files that no two exporters write alike.
fn oddities() -> Vec<(&'static str, Vec<u8>)> {
    let document = asset::load("sample:plane").unwrap().document;
    let mut json = document.json.clone();
    json["extras"] = json!({"note": "keeps its extras", "empty": {}});
    json["nodes"][0]["name"] = json!("ünï 木 \u{1F98A}");
    let compact = serde_json::to_vec(&json).unwrap();
    let mut pretty = serde_json::to_vec_pretty(&json).unwrap();
    pretty.resize(pretty.len().next_multiple_of(4), b' ');
    let padded = |length: usize| {
        let mut binary = document.binary.clone();
        binary.resize(document.binary.len().next_multiple_of(4) + length, 0xAB);
        binary
    };
    let kept = |text: &[u8]| text.to_vec();
    let mut unaligned = compact.clone();
    unaligned.resize(compact.len().next_multiple_of(4) + 1, b' ');
    let own = [kept(&pretty), padded(0), padded(60)];
    vec![
        ("pretty", glb(&[(b"JSON", &own[0]), (b"BIN\0", &own[1])], 0)),
        ("long padding", glb(&[(b"JSON", &own[0]), (b"BIN\0", &own[2])], 0)),
        ("unaligned JSON", glb(&[(b"JSON", &unaligned), (b"BIN\0", &own[1])], 0)),
        ("an unknown chunk between", glb(&[(b"JSON", &own[0]), (b"HUH?", &[7; 20]), (b"BIN\0", &own[1])], 0)),
        ("an unknown chunk behind", glb(&[(b"JSON", &own[0]), (b"BIN\0", &own[1]), (b"HUH?", &[7; 20])], 0)),
        ("bytes behind the end", [glb(&[(b"JSON", &own[0]), (b"BIN\0", &own[1])], 0), vec![1, 2, 3]].concat()),
    ]
}

/// What stripping a baked file gives.
fn stripped(path: &Path) -> Stripped {
    strip(&read_document(path).unwrap().0).unwrap()
}

/// Puts a made coat on `input`, takes it off, and says what is wrong with what comes back.
fn fault_of_way_back(input: &Path, folder: &Path) -> Option<String> {
    let asset = asset::load(&input.to_string_lossy()).ok()?;
    let bytes = std::fs::read(input).unwrap();
    for (fallback, name) in
        [(Fallback::None, "none.glb"), (Fallback::Shells(2), "shells.glb"), (Fallback::None, "t.gltf")]
    {
        let (coat, out) = (coat_for(&asset), folder.join(name));
        write_coat(&asset, &coat, fallback, &out).unwrap();
        if stripped(&out).input != Input::Whole(bytes.clone()) {
            return Some(format!("{name}: {:?}", matches!(stripped(&out).input, Input::Lost(_))));
        }
        // What it costs: the JSON of the input and 4 kB at most, as the output alone would be.
        let without = with_coat(&asset, &coat, fallback).unwrap().to_glb().unwrap().len();
        let json = asset.document.origin.as_ref().unwrap().json;
        let size = std::fs::metadata(&out).unwrap().len() as usize;
        if name == "shells.glb" && size > without + json + 4096 {
            return Some(format!("{size} bytes instead of {without}, with {json} of JSON"));
        }
    }
    None
}

#[test]
fn the_input_comes_back_to_the_byte() {
    let folder = tempfile::tempdir().unwrap();
    let mut faults = Vec::new();
    let mut inputs: Vec<PathBuf> = Vec::new();
    for (name, bytes) in oddities() {
        inputs.push(folder.path().join(format!("{name}.input.glb")));
        std::fs::write(inputs.last().unwrap(), bytes).unwrap();
    }
    for name in ["creature", "torus"] {
        inputs.push(folder.path().join(format!("{name}.input.glb")));
        let bytes = asset::load(&format!("sample:{name}")).unwrap().document.to_glb().unwrap();
        std::fs::write(inputs.last().unwrap(), bytes).unwrap();
    }
    let own = inputs.len();
    if let Some(shared) = shared() {
        for kind in ["real", "hard"] {
            let files = std::fs::read_dir(shared.join(kind)).unwrap().map(|entry| entry.unwrap().path());
            inputs.extend(files.filter(|path| path.extension().is_some_and(|e| e == "glb" || e == "gltf")));
        }
    }
    let mut loaded = 0;
    for input in &inputs {
        loaded += usize::from(asset::load(&input.to_string_lossy()).is_ok());
        faults.extend(fault_of_way_back(input, folder.path()).map(|fault| format!("{}: {fault}", input.display())));
    }
    println!("{loaded} of {} files went there and back", inputs.len());
    assert!(loaded >= own && faults.is_empty(), "{}", faults.join("\n"));
}

/// A coat on `sample:NAME`, through a file, and the document that it was put on.
fn worn(name: &str, folder: &Path) -> (Document, Document) {
    let input = folder.join(format!("{name}-in.glb"));
    std::fs::write(&input, asset::load(&format!("sample:{name}")).unwrap().document.to_glb().unwrap()).unwrap();
    let asset = asset::load(&input.to_string_lossy()).unwrap();
    let out = folder.join(format!("{name}-furry.glb"));
    write_coat(&asset, &coat_for(&asset), Fallback::Shells(3), &out).unwrap();
    (asset.document, read_document(&out).unwrap().0)
}

#[test]
fn after_an_edit_all_but_the_coat_is_left() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["creature", "plane"] {
        let (before, mut furry) = worn(name, folder.path());
        furry.json["materials"][0]["name"] = json!("changed");
        let mut expected = before.json.clone();
        expected["materials"][0]["name"] = json!("changed");
        let bare = strip(&furry).unwrap();
        assert_eq!(bare.input, Input::Lost("the file was changed after it was baked"));
        expected["buffers"][0]["byteLength"] = bare.document.json["buffers"][0]["byteLength"].clone();
        assert_eq!(bare.document.json, expected, "{name}");
        // At most the padding before what was added stays.
        let (left, right) = (&bare.document.binary, &before.binary);
        assert!(left.starts_with(right) && left.len() < right.len() + 8, "{} and {}", left.len(), right.len());
        assert!(Worn::of(&bare.document).is_none());
        assert!(strip(&bare.document).is_err(), "there is nothing more to take off");
    }
}

/// A triangle with a material of its own, behind all there is.
fn add_a_triangle(document: &mut Document) -> [f32; 9] {
    let corners = [0.0, 0.0, 9.0, 1.0, 0.0, 9.0, 0.0, 1.0, 9.0];
    let bytes: Vec<u8> = corners.iter().flat_map(|c: &f32| c.to_le_bytes()).collect();
    let view = document.push_view(&bytes, None);
    let bounds = json!({"bufferView": view, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 9], "max": [1, 1, 9]});
    let accessor = document.push("accessors", bounds);
    let material = document.push("materials", json!({"name": "of another program"}));
    let mesh = document.push(
        "meshes",
        json!({"name": "sign", "primitives": [{"attributes": {"POSITION": accessor}, "material": material}]}),
    );
    let node = document.push("nodes", json!({"name": "sign", "mesh": mesh}));
    document.json["scenes"][0]["nodes"].as_array_mut().unwrap().push(json!(node));
    corners
}

#[test]
fn what_another_program_put_behind_a_coat_keeps_its_references() {
    let folder = tempfile::tempdir().unwrap();
    let (_, mut furry) = worn("creature", folder.path());
    let corners = add_a_triangle(&mut furry);
    // Without the extension, too: by marks and names alone.
    let mut nameless = furry.clone();
    for key in ["extensions", "extensionsUsed", "extras"] {
        nameless.json.as_object_mut().unwrap().shift_remove(key);
    }
    for mesh in nameless.json["meshes"].as_array_mut().unwrap() {
        mesh.as_object_mut().unwrap().shift_remove("extensions");
        for primitive in mesh["primitives"].as_array_mut().unwrap() {
            primitive.as_object_mut().unwrap().shift_remove("extensions");
        }
        if let Some(name) = mesh["name"].as_str().map(|name| name.replace(' ', "_") + ".001") {
            mesh["name"] = json!(name);
        }
    }
    for document in [furry, nameless] {
        let bare = strip(&document).unwrap();
        let out = folder.path().join("bare.glb");
        let (whole, notes) = write_stripped(bare, &out).unwrap();
        assert!(!whole && notes[0].contains("not the bytes of the input"), "{notes:?}");
        let read = asset::load(&out.to_string_lossy()).unwrap();
        let sign = read.parts.iter().find(|part| part.material_name == "of another program").expect("the sign");
        let stored: Vec<f32> = sign.stored.positions.iter().flat_map(|p| p.to_array()).collect();
        assert_eq!(stored, corners);
        assert_eq!(read.document.json["nodes"][sign.nodes[0]]["name"], "sign");
        assert!(!read.document.json.to_string().contains("fur shell"), "{}", read.document.json);
        let fur: Vec<_> = read.parts.iter().map(|part| part.material_name.as_str()).collect();
        let before: Vec<String> =
            asset::load("sample:creature").unwrap().parts.iter().map(|part| part.material_name.clone()).collect();
        assert_eq!(fur[..fur.len() - 1], before[..], "what was there is there");
    }
}

#[test]
fn with_an_extension_of_unknown_references_nothing_moves() {
    let folder = tempfile::tempdir().unwrap();
    let (_, mut furry) = worn("plane", folder.path());
    furry.json["extensionsUsed"].as_array_mut().unwrap().push(json!("ACME_levers"));
    add_a_triangle(&mut furry);
    let material = furry.count("materials") - 1;
    furry.json["extensions"]["ACME_levers"] = json!({"on": material});
    let bare = strip(&furry).unwrap();
    assert!(bare.notes.iter().any(|note| note.contains("ACME_levers")), "{:?}", bare.notes);
    let on = bare.document.json["extensions"]["ACME_levers"]["on"].as_u64().unwrap() as usize;
    assert_eq!(bare.document.json["materials"][on]["name"], "of another program");
    let shown: Vec<&Value> =
        bare.document.json["nodes"].as_array().unwrap().iter().filter(|n| n.get("mesh").is_some()).collect();
    assert_eq!(shown.len(), 2, "no node shows shells");
    assert!(asset::Asset::new(bare.document, vec![]).is_ok());
}

#[test]
fn other_kinds_of_files_say_what_comes_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let mut document = asset::load("sample:plane").unwrap().document;
    document.json["buffers"][0]["uri"] = json!("plane.bin");
    std::fs::write(path("plane.bin"), &document.binary).unwrap();
    let text = serde_json::to_vec_pretty(&document.json).unwrap();
    std::fs::write(path("plane.gltf"), &text).unwrap();
    std::fs::write(path("tri.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    std::fs::create_dir(path("elsewhere")).unwrap();
    let coated = |input: &str, out: &str| {
        let asset = asset::load(&path(input).to_string_lossy()).unwrap();
        write_coat(&asset, &coat_for(&asset), Fallback::Shells(2), &path(out)).unwrap();
        stripped(&path(out))
    };
    // A .gltf comes back as it was, and names the data that is not in it.
    let bare = coated("plane.gltf", "furry.glb");
    let (whole, notes) = write_stripped(bare.clone(), &path("elsewhere/bare.gltf")).unwrap();
    assert!(whole && notes[0].contains("plane.bin"), "{notes:?}");
    assert_eq!(std::fs::read(path("elsewhere/bare.gltf")).unwrap(), text);
    let (whole, notes) = write_stripped(bare.clone(), &path("bare.gltf")).unwrap();
    assert!(whole && notes.is_empty(), "{notes:?}");
    let (whole, notes) = write_stripped(bare, &path("bare.glb")).unwrap();
    assert!(!whole && notes[0].contains("the input was a .gltf"), "{notes:?}");
    assert!(asset::load(&path("bare.glb").to_string_lossy()).is_ok());
    let (whole, notes) = write_stripped(coated("tri.obj", "obj.glb"), &path("obj-bare.glb")).unwrap();
    assert!(!whole && notes[0].contains("OBJ"), "{notes:?}");
    assert_eq!(asset::load(&path("obj-bare.glb").to_string_lossy()).unwrap().parts[0].stored.triangles.len(), 1);
    // A picture beside the input stays its reference in what comes back.
    let asset = asset::load(&path("plane.gltf").to_string_lossy()).unwrap();
    let old = with_coat(&asset, &coat_for(&asset), Fallback::Shells(2)).unwrap();
    assert!(matches!(strip(&old).unwrap().input, Input::Lost(why) if why.contains("older version")));
}

#[test]
fn a_stored_piece_that_lies_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let (_, furry) = worn("plane", folder.path());
    for (key, value) in [
        ("bufferView", json!(0)),
        ("before", json!(7)),
        ("kept", json!(1_u64 << 40)),
        ("hash", json!("0123456789abcdef")),
        ("seal", json!("no number")),
        ("seal", json!(7)),
    ] {
        let mut bad = furry.clone();
        bad.json["extensions"][NAME]["input"][key] = value.clone();
        match strip(&bad) {
            // Any change breaks the seal, and is a change.
            Ok(bare) => assert_eq!(bare.input, Input::Lost("the file was changed after it was baked"), "{key} {value}"),
            Err(error) => assert!(error.field.as_deref().is_some_and(|field| field.contains(".input.")), "{error}"),
        }
    }
}

/// The binary's `bake` with small tiles.
fn bake(input: &Path, output: &Path, options: &[&str]) -> assert_cmd::assert::Assert {
    let mut command = Command::new(furrier_path());
    command.arg("bake").arg(input).arg("-o").arg(output).args(crate::bake::SMALL).args(options).assert()
}

#[test]
fn a_second_coat_is_refused_with_how_to_take_the_first_off() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let (_, furry) = worn("plane", folder.path());
    let mut extras = furry.clone();
    let mut names = furry.clone();
    for document in [&mut extras, &mut names] {
        let bare = strip(document).unwrap().document.json;
        document.json["extensions"] = json!({});
        document.json["meshes"][0] = bare["meshes"][0].clone();
        document.json["meshes"][1].as_object_mut().unwrap().shift_remove("extensions");
    }
    names.json["extras"] = json!({});
    extras.json["meshes"][1]["name"] = json!("x");
    for (document, found) in [(&furry, "extensions."), (&extras, "extras."), (&names, "meshes[1]")] {
        std::fs::write(path("furry.glb"), document.to_glb().unwrap()).unwrap();
        let said = predicate::str::contains(format!("field: {found}"))
            .and(predicate::str::contains("furrier strip IN -o OUT"))
            .and(predicate::str::contains("`--rebake`"));
        bake(&path("furry.glb"), &path("again.glb"), &[]).code(3).stderr(said);
        assert!(!path("again.glb").exists());
        bake(&path("furry.glb"), &path("again.glb"), &["--rebake"]).code(0);
        std::fs::remove_file(path("again.glb")).unwrap();
    }
}

#[test]
fn baking_anew_is_baking_the_input() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("in.glb"), asset::load("sample:plane").unwrap().document.to_glb().unwrap()).unwrap();
    bake(&path("in.glb"), &path("first.glb"), &["--preset", "mink"]).code(0);
    bake(&path("in.glb"), &path("second.glb"), &[]).code(0);
    bake(&path("first.glb"), &path("anew.glb"), &["--rebake"]).code(0).stderr(predicate::str::contains("taken off"));
    assert!(std::fs::read(path("second.glb")).unwrap() == std::fs::read(path("anew.glb")).unwrap());
    let strip = |from: &str, to: &str| {
        Command::new(furrier_path()).arg("strip").arg(path(from)).arg("-o").arg(path(to)).assert()
    };
    strip("anew.glb", "bare.glb").code(0).stdout(predicate::str::contains("byte for byte"));
    assert!(std::fs::read(path("bare.glb")).unwrap() == std::fs::read(path("in.glb")).unwrap());
    strip("anew.glb", "anew.glb").code(2);
    strip("in.glb", "no.glb").code(3).stderr(predicate::str::contains("wears no coat"));
    strip("anew.glb", "no.obj").code(2);
    assert!(!path("no.glb").exists() && !path("no.obj").exists());
}

#[test]
fn what_a_modelling_program_left_of_a_coat_comes_off() {
    let Some(input) = shared().map(|shared| shared.join("wild/roundtrip_keeps_extras.glb")) else { return };
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out.glb");
    let said = predicate::str::contains("Beast fur shells").and(predicate::str::contains("furrier strip IN -o OUT"));
    bake(&input, &out, &[]).code(3).stderr(said);
    let bare = stripped(&input);
    let json = &bare.document.json;
    for list in ["nodes", "meshes", "materials"] {
        assert_eq!(json[list].as_array().map(Vec::len), Some(1), "{list}");
    }
    for list in ["images", "textures", "samplers", "extras"] {
        assert!(json.get(list).is_none(), "{list}");
    }
    // The skin's four accessors, of 7720 bytes, are all that is left.
    assert_eq!((json["accessors"].as_array().map(Vec::len), bare.document.binary.len()), (Some(4), 7720));
    bake(&input, &out, &["--rebake"]).code(0);
    assert_eq!(stripped(&out).input, Input::Whole(bare.document.to_glb().unwrap()));
}
