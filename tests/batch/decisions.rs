//! What is up to date, and why something is not.

use super::{batch, json, outputs, single, succeeds, triangles};
use serde_json::{Value, json};
use std::path::Path;

/// Reasons of a dry run, by input.
fn why(folder: &Path, more: &[&str]) -> Vec<(String, String)> {
    let (code, value) = json(batch(folder, more).arg("--dry-run"));
    assert_eq!(code, 0);
    let text = |entry: &Value, key: &str| entry[key].as_str().unwrap().to_owned();
    let reasons = |entry: &Value| {
        entry["why"].as_array().unwrap().iter().map(|w| w.as_str().unwrap().to_owned()).collect::<Vec<_>>().join("; ")
    };
    value["would_bake"].as_array().unwrap().iter().map(|entry| (text(entry, "input"), reasons(entry))).collect()
}

#[test]
fn outputs_are_those_of_single_bakes_and_stay_up_to_date() {
    let folder = triangles(3);
    let inputs = ["sub/t2.obj", "t0.obj", "t1.obj"];
    assert_eq!(why(folder.path(), &[]), inputs.map(|input| (input.to_owned(), "never baked".to_owned())));
    assert!(!folder.path().join("furry").exists(), "a dry run writes nothing");
    let (code, value) = json(&mut batch(folder.path(), &[]));
    assert_eq!((code, &value["baked"], &value["up_to_date"]), (0, &json!(3), &json!(0)), "{value}");
    assert_eq!(outputs(&folder.path().join("furry")), single(folder.path(), &inputs));
    let (code, value) = json(&mut batch(folder.path(), &[]));
    assert_eq!((code, &value["baked"], &value["up_to_date"]), (0, &json!(0), &json!(3)), "{value}");
    assert_eq!(why(folder.path(), &[]), []);
    // Not by name and place: a library may be moved.
    let moved = folder.path().with_extension("moved");
    std::fs::rename(folder.path(), &moved).unwrap();
    assert_eq!(why(&moved, &[]), []);
    std::fs::rename(&moved, folder.path()).unwrap();
}

#[test]
fn a_dry_run_says_why() {
    let folder = triangles(1);
    let at = |name: &str| folder.path().join(name);
    let map = image::GrayImage::from_pixel(4, 4, image::Luma([200]));
    map.save(at("length.png")).unwrap();
    let preset = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/presets/fox.toml")).unwrap();
    std::fs::write(at("own.toml"), format!("{preset}\n[maps]\nlength = \"length.png\"\n")).unwrap();
    // The preset's file comes last but one of what it is changed by.
    let options = |set: &'static str| {
        vec!["--preset".to_owned(), at("own.toml").display().to_string(), "--set".to_owned(), set.to_owned()]
    };
    let run = |set: &'static str| {
        let options = options(set);
        why(folder.path(), &options.iter().map(String::as_str).collect::<Vec<_>>())
    };
    let bake = || succeeds(batch(folder.path(), &[]).args(options("guard.taper=0.2")));
    std::fs::write(at("t0.obj"), format!("mtllib t.mtl\nusemtl fur\n{}", super::triangle(0))).unwrap();
    std::fs::write(at("t.mtl"), "newmtl fur\nmap_Kd skin.png\n").unwrap();
    map.save(at("skin.png")).unwrap();
    bake();
    let same = |expected: &[&str], set: &'static str| {
        let found = run(set);
        let expected: Vec<_> = expected.iter().map(|reason| ("t0.obj".to_owned(), (*reason).to_owned())).collect();
        assert_eq!(found, expected);
    };
    same(&[], "guard.taper=0.2");
    same(&["preset's guard.taper: 0.2 → 0.3"], "guard.taper=0.3");
    std::fs::write(at("t0.obj"), format!("mtllib t.mtl\nusemtl fur\n{}", super::triangle(7))).unwrap();
    same(&["input changed"], "guard.taper=0.2");
    bake();
    image::GrayImage::from_pixel(4, 4, image::Luma([100])).save(at("skin.png")).unwrap();
    same(&["skin.png changed"], "guard.taper=0.2");
    std::fs::remove_file(at("skin.png")).unwrap();
    same(&["skin.png came or went"], "guard.taper=0.2");
    bake();
    image::GrayImage::from_pixel(4, 4, image::Luma([150])).save(at("length.png")).unwrap();
    same(&["map changed: preset.maps.length"], "guard.taper=0.2");
    bake();
    let output = at("furry/t0.glb");
    let mut bytes = std::fs::read(&output).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    std::fs::write(&output, bytes).unwrap();
    same(&["output altered"], "guard.taper=0.2");
    std::fs::remove_file(&output).unwrap();
    same(&["output missing"], "guard.taper=0.2");
    bake();
    let record = std::fs::read_dir(at("furry/.furrier/records")).unwrap().next().unwrap().unwrap().path();
    let text = std::fs::read_to_string(&record).unwrap();
    std::fs::write(&record, text.replace("\"epoch\":", "\"epoch\":100")).unwrap();
    assert!(run("guard.taper=0.2")[0].1.starts_with("version: format "), "{:?}", run("guard.taper=0.2"));
    std::fs::write(&record, &text[..text.len() / 2]).unwrap();
    assert!(run("guard.taper=0.2")[0].1.starts_with("what is known of the output cannot be read"));
    std::fs::remove_file(&record).unwrap();
    same(&["nothing is known of the output that is there"], "guard.taper=0.2");
}

#[test]
fn a_gltf_output_is_both_of_its_files() {
    let folder = triangles(1);
    let toml = "[defaults]\noutput = \"out/{name}.gltf\"\nset = [\"shells.tile_mm=8\", \"guard.density_per_cm2=40\", \"undercoat.density_per_cm2=200\", \"guard.length.mm=4\", \"undercoat.length.mm=3\"]\nlayers = 4\ntexture_size = 16\n";
    std::fs::write(folder.path().join("furrier.toml"), toml).unwrap();
    let run = || json(super::furrier(&["batch"]).arg(folder.path())).1;
    assert_eq!(run()["baked"], 1);
    assert_eq!(run()["up_to_date"], 1);
    std::fs::remove_file(folder.path().join("out/t0.bin")).unwrap();
    assert_eq!(run()["baked"], 1);
}
