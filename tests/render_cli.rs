//! `furrier render` as a program: every option changes what it should, and layers come back from the file.

use crate::common::furrier_path;
use assert_cmd::Command;
use assert_cmd::assert::Assert;
use exr::prelude::*;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

const SIZE: usize = 48;

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Draws a thinly furred plane, from 20° above it where the options say nothing else.
    fn render(&self, name: &str, options: &[&str]) -> Assert {
        let mut command = Command::new(furrier_path());
        command.args(["render", "sample:plane", "--preset", "mink", "--size", "48x48", "-o"]).arg(self.path(name));
        command.args(["--set", "guard.density_per_cm2=20", "--set", "undercoat.density_per_cm2=600"]).args(options);
        if !options.contains(&"--camera") {
            command.args(["--orbit", "35,20,1"]);
        }
        command.assert()
    }

    fn layers(&self, name: &str, options: &[&str]) -> BTreeMap<String, Vec<f32>> {
        self.render(name, options).success();
        layers(&self.path(name))
    }
}

/// Every channel of an EXR.
fn layers(path: &Path) -> BTreeMap<String, Vec<f32>> {
    let image = read_first_flat_layer_from_file(path).unwrap();
    assert_eq!(image.layer_data.size, Vec2(SIZE, SIZE));
    let channels = image.layer_data.channel_data.list;
    channels.into_iter().map(|c| (c.name.to_string(), c.sample_data.values_as_f32().collect())).collect()
}

fn mean(values: &[f32]) -> f64 {
    values.iter().map(|&v| f64::from(v)).sum::<f64>() / values.len() as f64
}

fn luminance(layers: &BTreeMap<String, Vec<f32>>) -> f64 {
    0.2126 * mean(&layers["R"]) + 0.7152 * mean(&layers["G"]) + 0.0722 * mean(&layers["B"])
}

#[test]
fn an_exr_holds_every_layer() {
    let all = Folder::new().layers("out.exr", &[]);
    let names: Vec<&str> = all.keys().map(String::as_str).collect();
    let expected =
        "A B G R Z albedo.B albedo.G albedo.R guard normal.X normal.Y normal.Z tangent.X tangent.Y tangent.Z undercoat";
    assert_eq!(names.join(" "), expected);
    let at = |name: &str, i: usize| all[name][i];
    let mut covered = 0;
    for i in 0..SIZE * SIZE {
        let parts = at("guard", i) + at("undercoat", i);
        assert!((-1e-5..=1.00001).contains(&at("A", i)) && parts <= at("A", i) + 1e-3);
        assert!(at("A", i) > 0.0 || (at("R", i), at("Z", i)) == (0.0, 0.0));
        // Premultiplied unit vectors and albedos are at most alpha.
        for name in ["normal", "tangent"] {
            let length =
                ["X", "Y", "Z"].map(|axis| at(&format!("{name}.{axis}"), i)).map(|v| v * v).iter().sum::<f32>();
            assert!(length.sqrt() <= at("A", i) + 1e-3, "{name}");
        }
        assert!(at("albedo.R", i) <= at("A", i) + 1e-3);
        if at("A", i) > 0.99 {
            covered += 1;
            assert!((0.1..2.0).contains(&at("Z", i)), "distance {}", at("Z", i));
        }
    }
    assert!(covered > 200 && mean(&all["guard"]) > 0.01 && mean(&all["undercoat"]) > 0.05);
    // Hair on a plane leans upwards.
    assert!(mean(&all["tangent.Y"]) > 0.02 && mean(&all["normal.Y"]) > 0.0);
}

#[test]
fn only_one_kind_of_hair() {
    let folder = Folder::new();
    let (guard, undercoat) =
        (folder.layers("guard.exr", &["--only", "guard"]), folder.layers("undercoat.exr", &["--only", "undercoat"]));
    assert!(mean(&guard["guard"]) > 0.01 && mean(&guard["undercoat"]) == 0.0);
    assert!(mean(&undercoat["undercoat"]) > 0.05 && mean(&undercoat["guard"]) == 0.0);
}

#[test]
fn lights_and_ambient_add_up() {
    let folder = Folder::new();
    let with = |options: &[&str]| luminance(&folder.layers("out.exr", options));
    let (dark, sky) = (["--light", "dir:0,-1,0:0,0,0", "--ambient", "0,0,0"], "1,1,1");
    assert_eq!(with(&dark), 0.0);
    let ambient = with(&["--light", "dir:0,-1,0:0,0,0", "--ambient", sky]);
    let key = with(&["--light", "dir:0,-1,-0.5:3,3,3", "--ambient", "0,0,0"]);
    let both = with(&["--light", "dir:0,-1,-0.5:3,3,3", "--ambient", sky]);
    assert!(ambient > 0.01 && key > 0.01 && (both - ambient - key).abs() < 1e-3 * both, "{ambient} {key} {both}");
    let twice = with(&["--light", "dir:0,-1,-0.5:6,6,6", "--ambient", "0,0,0"]);
    assert!((twice - 2.0 * key).abs() < 1e-4 * twice);
    let coloured = folder.layers("out.exr", &["--light", "dir:0,-1,-0.5:3,0,0", "--ambient", "0,0,0"]);
    assert!(mean(&coloured["R"]) > 0.01 && mean(&coloured["G"]) == 0.0);
}

/// A Radiance map of 8 × 4 pixels, dark but for one row.
fn environment(path: &Path, bright_row: usize) {
    let mut bytes = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 8\n".to_vec();
    for row in 0..4 {
        for _ in 0..8 {
            // 128 · 2^(e − 136): e = 131 is a radiance of 4.
            bytes.extend(if row == bright_row { [128, 128, 128, 131] } else { [0; 4] });
        }
    }
    std::fs::write(path, bytes).unwrap();
}

#[test]
fn an_environment_lights_from_where_it_is_bright() {
    let folder = Folder::new();
    environment(&folder.path("above.hdr"), 0);
    environment(&folder.path("below.hdr"), 3);
    let with = |map: &str, more: &[&str]| {
        let map = folder.path(map);
        let mut options = vec!["--env", map.to_str().unwrap()];
        options.extend(more);
        luminance(&folder.layers("out.exr", &options))
    };
    let (above, below) = (with("above.hdr", &[]), with("below.hdr", &[]));
    assert!(above > 0.005 && below < 0.02 * above, "{above} from above, {below} from below");
    assert!(with("above.hdr", &["--env-on-undercoat"]) > 1.02 * above);
    folder.render("out.png", &["--env-on-undercoat"]).code(2);
    folder.render("out.png", &["--env", "missing.hdr"]).code(3);
}

#[test]
fn a_camera_file_says_where_from() {
    let folder = Folder::new();
    let camera = |name: &str, text: &str| {
        std::fs::write(folder.path(name), text).unwrap();
        folder.path(name).to_str().unwrap().to_owned()
    };
    let down = camera("down.json", r#"{"eye": [0, 0.5, 0.001], "target": [0, 0, 0], "vfov_deg": 30}"#);
    let away = camera("away.json", r#"{"eye": [0, 0.5, 0.001], "target": [0, 1, 0]}"#);
    let seen = folder.layers("down.exr", &["--camera", &down]);
    let middle = SIZE / 2 * SIZE + SIZE / 2;
    assert!(seen["A"][middle] > 0.99 && (0.4..0.51).contains(&seen["Z"][middle]), "{}", seen["Z"][middle]);
    assert_eq!(mean(&folder.layers("away.exr", &["--camera", &away])["A"]), 0.0);
    for text in ["{}", "{", r#"{"eye": [0,0,0], "target": [0,0,0]}"#, r#"{"eye": [0,0], "target": [0,0,1]}"#] {
        folder.render("out.png", &["--camera", &camera("bad.json", text)]).code(2);
    }
    folder.render("out.png", &["--camera", "missing.json"]).code(3);
}

#[test]
fn final_draws_more_than_a_preview_and_shows_the_same() {
    let folder = Folder::new();
    let counts = |quality: &str| {
        let (picture, report) = (format!("{quality}.exr"), folder.path("report.json"));
        let layers = folder.layers(&picture, &["--quality", quality, "--report", report.to_str().unwrap()]);
        let report: serde_json::Value = serde_json::from_slice(&std::fs::read(report).unwrap()).unwrap();
        assert_eq!(report["schema_version"], 1);
        (layers, report["counts"]["fragments"].as_f64().unwrap())
    };
    let ((preview, once), (best, finer)) = (counts("preview"), counts("final"));
    // A preview draws fewer hairs, and each touches fewer samples.
    assert!(finer > 2.0 * once, "{once} and {finer} fragments");
    assert!((luminance(&best) / luminance(&preview) - 1.0).abs() < 0.05);
    assert!((mean(&best["A"]) - mean(&preview["A"])).abs() < 0.02);
}

#[test]
fn a_lens_blurs_what_is_not_in_its_focus() {
    let folder = Folder::new();
    let sharpness = |options: &[&str]| {
        let layers = folder.layers("out.exr", options);
        let rows = layers["G"].chunks_exact(SIZE);
        rows.flat_map(|row| row.windows(2).map(|pair| f64::from(pair[1] - pair[0]).powi(2))).sum::<f64>()
    };
    let (pinhole, lens) = (sharpness(&[]), sharpness(&["--f-number", "1.4", "--focus", "0.2"]));
    assert!(lens < 0.5 * pinhole, "{lens} for {pinhole}");
    assert!(sharpness(&["--f-number", "64"]) > 0.9 * pinhole);
    for options in [&["--f-number", "0"][..], &["--f-number", "2", "--focus", "-1"], &["--focus", "1"]] {
        folder.render("no.png", options).code(2);
    }
}

#[test]
fn a_reference_with_bounces_tells_its_noise() {
    let folder = Folder::new();
    let paths = ["--quality", "reference", "--bounces", "2", "--lines", "2", "--report"];
    let report = folder.path("report.json");
    folder.render("walk.exr", &[&paths[..], &[report.to_str().unwrap()]].concat()).success();
    let report: serde_json::Value = serde_json::from_slice(&std::fs::read(report).unwrap()).unwrap();
    let noise = |name: &str| report["noise"][name].as_f64().unwrap();
    assert!(noise("mean") > 0.0 && noise("mean") < 0.1 && noise("median_pixel") > noise("mean"), "{report}");
    let walked = layers(&folder.path("walk.exr"));
    let usual = folder.layers("usual.exr", &["--quality", "reference", "--lines", "2"]);
    for part in ["A", "guard", "undercoat"] {
        if let (Some(walked), Some(usual)) = (walked.get(part), usual.get(part)) {
            assert!((mean(walked) - mean(usual)).abs() < 0.01, "{part}: {} and {}", mean(walked), mean(usual));
        }
    }
    for options in [&["--bounces", "2"][..], &["--quality", "reference", "--bounces", "0"]] {
        folder.render("none.exr", options).failure();
    }
}
