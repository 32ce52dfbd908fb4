//! Outputs against the extension's JSON schema and the Khronos validator.

use crate::common::{shared, skipped};
use crate::made::coat_for;
use furrier::asset::coat::{NAME, refuse_second, strip, with_coat};
use furrier::asset::{self, Asset, Document, Fallback, read_document, write_coat};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

fn schema(name: &str) -> jsonschema::Validator {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/extension/schema").join(name);
    let text = std::fs::read_to_string(path).expect("a schema");
    jsonschema::validator_for(&serde_json::from_str(&text).expect("JSON")).expect("a valid schema")
}

/// Every place in `json` where the extension stands, against its schema.
fn schema_faults(json: &Value) -> Vec<String> {
    let mut faults = Vec::new();
    let mut check = |schema: &jsonschema::Validator, owner: &Value, place: &str| {
        if let Some(extension) = owner.get("extensions").and_then(|e| e.get(NAME)) {
            faults.extend(schema.iter_errors(extension).map(|error| format!("{place}: {error}")));
        }
    };
    let names = ["glTF", "mesh", "mesh.primitive"].map(|name| schema(&format!("{name}.{NAME}.schema.json")));
    check(&names[0], json, "root");
    for mesh in json["meshes"].as_array().expect("meshes") {
        check(&names[1], mesh, "mesh");
        for primitive in mesh["primitives"].as_array().expect("primitives") {
            check(&names[2], primitive, "primitive");
        }
    }
    faults
}

/// A sample as a file, then with a coat: all that is ever written, what gives the input back included.
fn baked(name: &str) -> Document {
    let folder = tempfile::tempdir().expect("a folder");
    let [input, out] = ["in.glb", "out.glb"].map(|name| folder.path().join(name));
    let sample = asset::load(&format!("sample:{name}")).expect("a sample");
    std::fs::write(&input, sample.document.to_glb().expect("a GLB")).expect("written");
    let asset = asset::load(&input.to_string_lossy()).expect("it loads");
    write_coat(&asset, &coat_for(&asset), Fallback::Shells(4), &out).expect("it takes a coat");
    read_document(&out).expect("it loads").0
}

#[test]
fn outputs_follow_the_schema() {
    for name in ["creature", "sphere"] {
        let coated = baked(name);
        assert!(coated.json["extensions"][NAME]["input"].is_object(), "{name} keeps its input");
        assert_eq!(schema_faults(&coated.json), Vec::<String>::new());
    }
}

#[test]
fn the_schema_sees_planted_faults() {
    let good = baked("plane").json;
    let root = format!("/extensions/{NAME}");
    let primitive = format!("/meshes/0/primitives/0/extensions/{NAME}");
    for (pointer, planted) in [
        (format!("{root}/version"), json!(4)),
        (format!("{root}/tiles/0/edge"), json!(0)),
        (format!("{root}/input/seal"), json!("")),
        (format!("{root}/input/kept"), json!(-1)),
        (format!("{root}/tiles/0/shells/gains/0"), json!([1.0])),
        (format!("{primitive}/attributes/OFFSET"), json!(-1)),
        (format!("{primitive}/fins"), json!({"edges": 1})),
        (format!("/meshes/1/extensions/{NAME}/fallback"), json!(false)),
    ] {
        let mut bad = good.clone();
        *bad.pointer_mut(&pointer).expect("a field") = planted;
        assert!(!schema_faults(&bad).is_empty(), "{pointer}");
    }
}

/// Severity and code of each issue, counted; none, with the reason said, where the validator is not installed.
pub fn issues(files: &[PathBuf]) -> Option<Vec<BTreeMap<(u64, String), usize>>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/node");
    if !folder.join("node_modules/gltf-validator").is_dir() {
        skipped("the Khronos validator is not installed; run `npm ci` in tests/node");
        return None;
    }
    let output = Command::new("node").arg(folder.join("validate.mjs")).args(files).output().expect("node runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let results: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let counted = |file: &PathBuf| {
        let mut counts = BTreeMap::new();
        for issue in results[file.to_string_lossy().as_ref()].as_array().expect("a list") {
            let code = issue["code"].as_str().unwrap_or_default().to_owned();
            *counts.entry((issue["severity"].as_u64().unwrap_or(0), code)).or_insert(0) += 1;
        }
        counts
    };
    Some(files.iter().map(counted).collect())
}

/// Kinds of errors and warnings of which the output has more than the input.
pub fn new_issues(input: &BTreeMap<(u64, String), usize>, output: &BTreeMap<(u64, String), usize>) -> Vec<String> {
    let more = |(kind, count): (&(u64, String), &usize)| {
        let before = input.get(kind).copied().unwrap_or(0);
        (*count > before).then(|| format!("severity {} {}: {before} became {count}", kind.0, kind.1))
    };
    output.iter().filter_map(more).collect()
}

#[test]
fn the_khronos_validator_finds_nothing_new() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut inputs = Vec::new();
    let mut assets: Vec<Asset> = Vec::new();
    for name in asset::sample::NAMES {
        let asset = asset::load(&format!("sample:{name}")).expect("a sample");
        let bare = folder.path().join(format!("bare-{name}.glb"));
        std::fs::write(&bare, asset.document.to_glb().expect("a GLB")).expect("written");
        inputs.push(bare);
        assets.push(asset);
    }
    if let Some(shared) = shared() {
        for kind in ["real", "hard", "wild"] {
            for entry in std::fs::read_dir(shared.join(kind)).expect("a folder") {
                let path = entry.expect("an entry").path();
                let glb = path.extension().is_some_and(|e| e == "glb");
                // What wears a coat already takes no other.
                let bare = |asset: &Asset| refuse_second(asset).is_ok();
                if let Some(asset) = asset::load(&path.to_string_lossy()).ok().filter(|asset| glb && bare(asset)) {
                    assets.push(asset);
                    inputs.push(path);
                }
            }
        }
    }
    let n = inputs.len();
    let mut files = inputs;
    for (i, asset) in assets.iter().enumerate() {
        for (fallback, extension) in
            [(Fallback::None, "glb"), (Fallback::Shells(3), "glb"), (Fallback::Shells(2), "gltf")]
        {
            let name = format!("{i}-{}.{extension}", if fallback == Fallback::None { "none" } else { "shells" });
            write_coat(asset, &coat_for(asset), fallback, &folder.path().join(&name)).expect("written");
            files.push(folder.path().join(name));
        }
        // One that was changed after it was baked, without its coat.
        let (mut furry, _) = read_document(&folder.path().join(format!("{i}-shells.glb"))).expect("it loads");
        furry.json["asset"]["copyright"] = json!("changed");
        let bare = strip(&furry).expect("it has a coat");
        let name = folder.path().join(format!("{i}-stripped.glb"));
        std::fs::write(&name, bare.document.to_glb().expect("a GLB")).expect("written");
        files.push(name);
    }
    let Some(found) = issues(&files) else { return };
    let mut faults = Vec::new();
    for (i, asset) in assets.iter().enumerate() {
        for (k, output) in found[n + 4 * i..n + 4 * i + 4].iter().enumerate() {
            // Shells repeat the flaws of the skin's vertices as often as there are shells.
            let mut new = new_issues(&found[i], output);
            new.retain(|fault| k == 0 || k == 3 || fault.contains(": 0 became"));
            if !new.is_empty() {
                faults.push(format!("{}: {}", asset.document.name.display(), new.join(", ")));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn the_validator_sees_planted_faults() {
    let folder = tempfile::tempdir().expect("a folder");
    let asset = asset::load("sample:plane").expect("a sample");
    let mut bad = with_coat(&asset, &coat_for(&asset), Fallback::Shells(2)).expect("it takes a coat");
    bad.json["extensionsUsed"] = json!(["KHR_materials_unlit"]);
    bad.json["meshes"][1]["primitives"][0]["material"] = json!(99);
    let files = ["good.glb", "bad.glb"].map(|name| folder.path().join(name));
    std::fs::write(&files[0], asset.document.to_glb().expect("a GLB")).expect("written");
    std::fs::write(&files[1], bad.to_glb().expect("a GLB")).expect("written");
    let Some(found) = issues(&files) else { return };
    assert!(new_issues(&found[0], &found[1]).len() >= 2, "{:?}", found[1]);
}
