//! Real bakes: valid where their inputs are, and taken off again to the byte.

use super::{bake, says};
use crate::common::{furrier_path, shared};
use crate::validator::{issues, new_issues};
use furrier::asset::coat::{Input, strip};
use furrier::asset::{self, read_document};
use serde_json::json;

/// Files of every kind that a bake treats in its own way, and that are quick.
const SOME: [&str; 14] = [
    "real/RiggedSimple.glb",
    "real/Fox.glb",
    "hard/cameras_lights.glb",
    "hard/degenerate_triangles.glb",
    "hard/instanced_nodes.glb",
    "hard/mode_triangle_strip.glb",
    "hard/morph_targets.glb",
    "hard/multi_material.glb",
    "hard/nan_normal_uv.glb",
    "hard/positions_only.glb",
    "hard/quantized.glb",
    "hard/skinned_animated.glb",
    "hard/sparse_accessor.glb",
    "hard/two_uv_sets.glb",
];

#[test]
fn what_was_mended_comes_back_as_it_was_through_the_real_binary() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let mut document = asset::load("sample:plane").unwrap().document;
    document.json["nodes"][0]["name"] = json!("tab@");
    let glb = document.to_glb().unwrap();
    let at = glb.windows(4).position(|four| four == b"tab@").unwrap() + 3;
    // A tab, half a character in Latin-1.
    for odd in [b'\t', 0xC9] {
        let mut bytes = glb.clone();
        bytes[at] = odd;
        std::fs::write(path("in.glb"), &bytes).unwrap();
        bake(&path("in.glb"), &path("out.glb")).unwrap();
        let mut strip = assert_cmd::Command::new(furrier_path());
        strip.arg("strip").arg(path("out.glb")).arg("-o").arg(path("back.glb")).assert().success();
        assert_eq!(std::fs::read(path("back.glb")).unwrap(), bytes);
    }
}

#[test]
fn baked_files_are_valid_and_come_back_to_the_byte() {
    let Some(shared) = shared() else { return };
    let folder = tempfile::tempdir().unwrap();
    let mut files = Vec::new();
    for (number, name) in SOME.iter().enumerate() {
        let (input, out) = (shared.join(name), folder.path().join(format!("{number}.glb")));
        let baked = bake(&input, &out).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(!says(&baked.notes, &["not give back"]), "{name}: {:?}", baked.notes);
        let bytes = std::fs::read(&input).unwrap();
        assert!(strip(&read_document(&out).unwrap().0).unwrap().input == Input::Whole(bytes), "{name}");
        files.extend([input, out]);
    }
    let Some(found) = issues(&files) else { return };
    let mut faults = Vec::new();
    for (name, pair) in SOME.iter().zip(found.chunks(2)) {
        // Shells repeat the flaws of the skin's vertices.
        let new = new_issues(&pair[0], &pair[1]).into_iter().filter(|fault| fault.contains(": 0 became"));
        faults.extend(new.map(|fault| format!("{name}: {fault}")));
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
