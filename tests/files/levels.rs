//! Levels of detail side by side: one is furred, or each by itself.

use super::scenes::shells;
use super::{bake, glb, load, plane, request, says};
use crate::common::shared;
use crate::validator::{issues, new_issues};
use furrier::asset::coat::{Input, NAME, strip};
use furrier::asset::{self, Document, Reading, read_document};
use furrier::bake::{Baked, Method, Request};
use furrier::math::Vec3;
use serde_json::{Value, json};
use std::path::Path;

/// Meshes side by side under these names, or MSFT_lod between the first and those that the scene does not show.
fn levels(names: &[&str], shown: usize) -> Document {
    let mut document = plane(json!({"name": "Fur"}), &[]);
    document.json["nodes"][0]["name"] = json!(names[0]);
    for (i, name) in names.iter().enumerate().skip(1) {
        let mesh = document.json["meshes"][0].clone();
        let mesh = document.push("meshes", mesh);
        let node = document.push("nodes", json!({"mesh": mesh, "name": name}));
        if i < shown {
            document.json["scenes"][0]["nodes"].as_array_mut().unwrap().push(json!(node));
        }
    }
    document
}

#[test]
fn the_finest_level_of_detail_is_furred_and_the_others_named() {
    let folder = tempfile::tempdir().unwrap();
    for (names, finest) in [
        (["Beast_LOD0", "Beast_LOD1", "Beast_LOD2"], 0),
        (["Beast_LOD2", "Beast_LOD1", "Beast_LOD0"], 2),
        (["Beast.lod1", "Beast.lod2.001", "Beast.lod3"], 0),
        (["BeastLOD 1", "BeastLOD 2", "BeastLOD 10"], 0),
        (["LOD0", "LOD1", "LOD2"], 0),
    ] {
        let path = glb(&levels(&names, 3), folder.path(), "levels.glb");
        let asset = load(&path);
        let furred: Vec<usize> = asset.parts.iter().map(|part| part.nodes[0]).collect();
        assert_eq!(furred, [finest], "{names:?}");
        let others: Vec<&str> = names.iter().copied().filter(|name| *name != names[finest]).collect();
        assert!(says(&asset.warnings, &[&["without fur"], &others[..]].concat()), "{names:?}: {:?}", asset.warnings);
    }
    // Alone, or of different things, they are all there is.
    for names in [["Fox_LOD0", "Deer_LOD1", "Cat"], ["melod0", "melod1", "Explode2"]] {
        let asset = load(&glb(&levels(&names, 3), folder.path(), "levels.glb"));
        assert_eq!((asset.parts.len(), asset.warnings.len()), (3, 0), "{names:?}");
    }
    // The output keeps all levels, one of them with a coat.
    let path = glb(&levels(&["Beast_LOD0", "Beast_LOD1", "x"], 2), folder.path(), "levels.glb");
    let out = folder.path().join("out.glb");
    bake(&path, &out).unwrap();
    let written = load(&out).document.json;
    let wears = |mesh: usize| written["meshes"][mesh]["primitives"][0]["extensions"].is_object();
    assert_eq!([wears(0), wears(1)], [true, false]);
    // By the extension.
    let mut document = levels(&["Beast", "Beast far", "Beast farther"], 1);
    document.json["nodes"][0]["extensions"] = json!({"MSFT_lod": {"ids": [1, 2]}});
    let asset = load(&glb(&document, folder.path(), "levels.glb"));
    assert_eq!(asset.parts.len(), 1);
    assert!(says(&asset.warnings, &["of Beast,", "Beast far, Beast farther", "without fur"]), "{:?}", asset.warnings);
}

/// What baking all levels gives.
fn bake_all(input: &Path, out: &Path, method: Method) -> Baked {
    let reading = Reading { lods: true, ..Reading::default() };
    let request = Request { reading, method, ..request(input, out) };
    furrier::bake::bake(&request, &mut |_| ()).unwrap_or_else(|error| panic!("{error}"))
}

/// Meshes that wear the extension, without shells.
fn wearing(document: &Document) -> Vec<usize> {
    let meshes = document.json["meshes"].as_array().unwrap().iter();
    let wears = |mesh: &Value| mesh["primitives"][0]["extensions"][NAME].is_object();
    meshes.enumerate().filter(|(_, mesh)| wears(mesh)).map(|(index, _)| index).collect()
}

#[test]
fn all_levels_are_furred_where_that_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out.glb");
    let path = glb(&levels(&["Beast_LOD0", "Beast_LOD1", "Beast_LOD2"], 3), folder.path(), "levels.glb");
    let alone = bake(&path, &out).unwrap();
    let all = bake_all(&path, &out, Method::Lapped);
    assert!(says(&all.notes, &["each by itself", "Beast_LOD0, Beast_LOD1, Beast_LOD2"]), "{:?}", all.notes);
    assert!(!says(&all.warnings, &["without fur"]), "{:?}", all.warnings);
    // One tile serves all; what lies in one place is no more one skin than it was.
    assert_eq!((all.coat.primitives.len(), all.coat.tiles.len(), alone.coat.tiles.len()), (3, 1, 1));
    assert_eq!(all.diagonal_m, alone.diagonal_m);
    for carried in &all.coat.primitives {
        assert_eq!(carried.triangles.len(), alone.coat.primitives[0].triangles.len());
        let worst = carried
            .offset
            .iter()
            .zip(&alone.coat.primitives[0].offset)
            .map(|(a, b): (&Vec3, &Vec3)| (*a - *b).length());
        assert!(worst.fold(0.0, f32::max) < 1e-4, "hair of a level lies as on that level alone");
    }
    let written = load(&out);
    assert_eq!(wearing(&written.document), [0, 1, 2]);
    // One of them is drawn, and read: not more than without.
    assert_eq!(written.parts.len(), 1);
    assert!(!says(&written.warnings, &["shells"]), "{:?}", written.warnings);
    // An atlas holds one level.
    assert_eq!(bake_all(&path, &out, Method::Atlas { texels: Some(64) }).coat.tiles.len(), 3);
    assert_eq!(bake_all(&path, &out, Method::Uv(0)).coat.primitives.len(), 3);
}

#[test]
fn what_the_extension_alone_shows_takes_its_shells_along() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out.glb");
    let mut document = levels(&["Beast", "Beast far", "Beast farther"], 1);
    document.json["nodes"][0]["extensions"] = json!({"MSFT_lod": {"ids": [1, 2]}});
    let all = bake_all(&glb(&document, folder.path(), "levels.glb"), &out, Method::Lapped);
    assert_eq!(all.coat.primitives.len(), 3);
    let written = load(&out).document;
    for node in [1, 2] {
        let child = written.json["nodes"][node]["children"][0].as_u64().expect("shells below") as usize;
        let name = written.json["nodes"][child]["name"].as_str().unwrap();
        assert!(name.ends_with("fur shells"), "{name}");
    }
    // Under a skin, too: beside it there is no scene.
    let mut document = asset::load("sample:creature").unwrap().document;
    let node = super::scenes::skinned_node(&document);
    let far = document.push("nodes", document.json["nodes"][node].clone());
    document.json["nodes"][node]["extensions"] = json!({"MSFT_lod": {"ids": [far]}});
    bake_all(&glb(&document, folder.path(), "skinned.glb"), &out, Method::Lapped);
    let written = load(&out).document;
    for node in [node, far] {
        let child = written.json["nodes"][node]["children"][0].as_u64().expect("shells below") as usize;
        assert_eq!(written.json["nodes"][child]["skin"], written.json["nodes"][node]["skin"]);
    }
    assert!(shells(&written).1["mesh"].is_number());
}

#[test]
fn levels_are_told_however_they_are_named() {
    // The mesh's name counts where the node's says nothing.
    let mut document = levels(&["Cube", "Cube.001", "Cube.002"], 3);
    for (mesh, name) in ["Beast_LOD0", "Beast_LOD1", "beast_lod2"].iter().enumerate() {
        document.json["meshes"][mesh]["name"] = json!(name);
    }
    let asset = asset::Asset::new(document, Vec::new()).unwrap();
    assert_eq!(asset.parts.len(), 1);
    assert!(says(&asset.warnings, &["Beast_LOD0", "Beast_LOD1, beast_lod2", "`lods`"]), "{:?}", asset.warnings);
    // A finest level that the scene does not show, or that is empty, leaves the next one.
    let mut document = levels(&["Beast_LOD0", "Beast_LOD1", "Beast_LOD2"], 3);
    document.json["scenes"][0]["nodes"] = json!([1, 2]);
    let asset = asset::Asset::new(document.clone(), Vec::new()).unwrap();
    assert_eq!((asset.parts.len(), asset.parts[0].nodes[0]), (1, 1));
    document.json["scenes"][0]["nodes"] = json!([0, 1, 2]);
    document.json["nodes"][0].as_object_mut().unwrap().remove("mesh");
    let asset = asset::Asset::new(document, Vec::new()).unwrap();
    assert_eq!((asset.parts.len(), asset.parts[0].nodes[0]), (1, 1));
}

#[test]
fn files_with_levels_are_valid_with_fur_on_all_and_come_back_to_the_byte() {
    let Some(wild) = shared().map(|shared| shared.join("wild")) else { return };
    let folder = tempfile::tempdir().unwrap();
    let mut files = Vec::new();
    for (name, count) in [("msft_lod", 2), ("lods_by_name", 3)] {
        let (input, out) = (wild.join(format!("{name}.glb")), folder.path().join(format!("{name}.glb")));
        let baked = bake_all(&input, &out, Method::Lapped);
        assert_eq!((baked.coat.primitives.len(), baked.coat.tiles.len()), (count, 1), "{name}");
        let document = read_document(&out).unwrap().0;
        assert_eq!(strip(&document).unwrap().input, Input::Whole(std::fs::read(&input).unwrap()), "{name}");
        files.extend([input, out]);
    }
    let Some(found) = issues(&files) else { return };
    for pair in found.chunks(2) {
        assert_eq!(new_issues(&pair[0], &pair[1]), Vec::<String>::new());
    }
}
