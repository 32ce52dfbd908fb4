//! A coat beside its fur: views and lights by name, what is kept, and a small report through the real binary.

use crate::common::{furrier_path, skipped};
use furrier::data::camera::Camera;
use furrier::data::light::Light;
use furrier::math::{DVec3, Vec3};
use furrier::metrics::compare::LinearImage;
use furrier::report::coat::keep::{Cost, Drawing, Keep, Of};
use furrier::report::coat::key::Key;
use furrier::report::coat::views::{Distance, numbers, orbit, parse};
use furrier::stage::camera::Orbit;
use furrier::stage::rig::Rig;
use serde_json::Value;
use std::path::Path;
use std::process::Command;

#[test]
fn distances_may_have_views_of_their_own() {
    let all = parse("1:8, 0.35:2,4", 3).unwrap();
    let expected = [(1.0, 8), (0.35, 2), (4.0, 3)].map(|(times, views)| Distance { times, views });
    assert_eq!(all, expected);
    for text in ["", "x", "1:", "1:0", "1:65", "0", "-1", "1000", "1,1", "nan", "1:2:3"] {
        assert!(parse(text, 8).is_err(), "{text}");
    }
    assert!(parse("1", 65).is_err());
}

#[test]
fn views_are_spread_evenly_and_shared_between_distances() {
    let of = |views: usize| numbers(&Distance { times: 1.0, views }, 8).collect::<Vec<_>>();
    assert_eq!((of(8), of(4), of(2), of(1)), ((0..8).collect(), vec![0, 2, 4, 6], vec![0, 4], vec![0]));
    let first = orbit(0, 8, 1.0);
    assert_eq!(first, Orbit::default());
    let azimuths: Vec<f64> = (0..8).map(|n| orbit(n, 8, 1.0).azimuth_deg).collect();
    assert!(azimuths.windows(2).all(|pair| ((pair[1] - pair[0]).rem_euclid(360.0) - 45.0).abs() < 1e-9));
    let mut elevations: Vec<f64> = (0..8).map(|n| orbit(n, 8, 1.0).elevation_deg).collect();
    elevations.sort_by(f64::total_cmp);
    elevations.dedup();
    assert_eq!(elevations.len(), 8);
}

#[test]
fn lights_by_name_stand_where_they_are_said_to() {
    let camera = Camera { eye: [3.0, 1.0, -2.0], target: [0.0, 0.0, 1.0], up: [0.0, 1.0, 0.0], vfov_deg: 28.0 };
    let to_eye = (DVec3::from(camera.eye) - DVec3::from(camera.target)).normalize().as_vec3();
    let angle_deg = |rig: Rig| match rig.lit(&camera).lights[0] {
        Light::Directional(light) => light.to_light.dot(to_eye).clamp(-1.0, 1.0).acos().to_degrees(),
        _ => f32::NAN,
    };
    for (rig, expected) in [(Rig::Front, 0.0), (Rig::Side, 90.0), (Rig::Rim, 155.0)] {
        assert!((angle_deg(rig) - expected).abs() < 0.1, "{rig}: {}", angle_deg(rig));
        assert_eq!(rig.lit(&camera).ambient, Vec3::ZERO);
    }
    assert!(Rig::Sky.lit(&camera).lights.is_empty() && Rig::Studio.lit(&camera).lights.len() == 3);
    assert!(Rig::ALL.iter().all(|rig| rig.name().parse() == Ok(*rig)));
    assert!("moon".parse::<Rig>().is_err());
}

#[test]
fn a_picture_is_kept_whole_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let parts = folder.path().join("parts");
    let drawing = Drawing {
        picture: LinearImage {
            width: 3,
            height: 2,
            colour: (0..6).map(|i| Vec3::splat(0.1 * i as f32)).collect(),
            alpha: vec![0.3; 6],
        },
        cost: Cost { ms: 1.25, triangles: Some(7) },
    };
    let [key, other] = ["a", "b"].map(|name| Key::default().with(name));
    assert_ne!(key.to_string(), other.to_string());
    let mut keep = Keep::open(&parts).unwrap();
    assert!(keep.get(Of::Coat, key, [3, 2]).is_none());
    keep.put(Of::Coat, key, &drawing).unwrap();
    keep.put(Of::Render, key, &drawing).unwrap();
    assert_eq!(keep.get(Of::Coat, key, [3, 2]), Some(drawing.clone()));
    assert!(keep.get(Of::Coat, other, [3, 2]).is_none() && keep.get(Of::Coat, key, [2, 3]).is_none());
    // A run that was stopped: a file without its name yet, a picture without its cost, a picture cut short.
    std::fs::write(parts.join(".furrier-x.part"), "half").unwrap();
    std::fs::write(parts.join(format!("render-{other}.exr")), "half").unwrap();
    std::fs::write(parts.join(format!("coat-{other}.exr")), "half").unwrap();
    std::fs::write(parts.join(format!("coat-{other}.json")), "{\"ms\": 1.0, \"triangles\": null}").unwrap();
    let mut keep = Keep::open(&parts).unwrap();
    assert!(!parts.join(".furrier-x.part").exists());
    assert!(keep.get(Of::Render, other, [3, 2]).is_none() && keep.get(Of::Coat, other, [3, 2]).is_none());
    assert_eq!(keep.get(Of::Render, key, [3, 2]), Some(drawing));
    // What another build's coat looked like goes; renders stay.
    Keep::open(&parts).unwrap().tidy();
    let left = names(&parts);
    assert!(left.iter().all(|name| name.starts_with("render-")) && left.len() == 3, "{left:?}");
}

fn names(folder: &Path) -> Vec<String> {
    let name = |entry: std::io::Result<std::fs::DirEntry>| entry.unwrap().file_name().into_string().unwrap();
    let mut names: Vec<String> = std::fs::read_dir(folder).into_iter().flatten().map(name).collect();
    names.sort();
    names
}

/// A report of little hair, quick to draw: three views, two lights.
fn report(output: &Path, more: &[&str]) -> Command {
    let mut command = Command::new(furrier_path());
    command.args(["-q", "report", "coat", "sample:sphere", "--size", "40x40", "--distances", "1:2,3:1"]);
    command.args(["--lights", "studio,rim", "--texture-size", "64", "--layers", "6", "--device", "cpu"]);
    command.args(["--preset", "mink"]).args(crate::sweeps::SPARSE);
    command.args(more).arg("-o").arg(output);
    command
}

fn code(mut command: Command) -> Option<i32> {
    command.status().unwrap().code()
}

fn read(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

fn drawn(report: &Value) -> [u64; 2] {
    ["renders", "coats"].map(|of| report["drawn"][of].as_u64().unwrap())
}

/// All pictures but for what they took: a run of its own takes its own time.
fn without_times(report: &Value) -> Vec<Value> {
    let mut pictures = report["pictures"].as_array().unwrap().clone();
    pictures.iter_mut().for_each(|picture| {
        picture["cost"].as_object_mut().unwrap().retain(|name, _| !name.ends_with("_ms"));
    });
    pictures
}

fn assert_finite(value: &Value, path: &str) {
    match value {
        Value::Null => panic!("{path} is null"),
        Value::Object(members) => members.iter().for_each(|(name, v)| assert_finite(v, &format!("{path}.{name}"))),
        Value::Array(all) => all.iter().for_each(|v| assert_finite(v, path)),
        Value::Number(number) => assert!(number.as_f64().is_some_and(f64::is_finite), "{path}: {number}"),
        _ => {}
    }
}

#[test]
fn a_report_is_whole_goes_on_where_it_was_and_is_a_gate() {
    if furrier::gpu::adapters().is_empty() {
        return skipped("no graphics adapter");
    }
    let folder = tempfile::tempdir().unwrap();
    let (out, parts) = (folder.path().join("out.json"), folder.path().join("out.parts"));
    // Stopped after its first render: nothing is there but what is finished.
    let mut child = report(&out, &[]).spawn().unwrap();
    while !names(&parts).iter().any(|name| name.starts_with("render-") && name.ends_with(".json")) {
        assert!(child.try_wait().unwrap().is_none(), "it ended before it drew anything");
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(names(folder.path()), ["out.parts"]);
    // It goes on: six pictures and two floors, of which one render at least is there.
    assert_eq!(code(report(&out, &[])), Some(0));
    assert_eq!(names(folder.path()), ["out.csv", "out.json", "out.parts", "out.png", "out.svg"]);
    let first = read(&out);
    let [renders, coats] = drawn(&first);
    assert!((1..8).contains(&renders) && coats <= 6, "{renders} renders, {coats} coats");
    assert_finite(&first["pictures"], "pictures");
    assert_finite(&first["summary"], "summary");
    let pictures = first["pictures"].as_array().unwrap();
    assert_eq!(pictures.len(), 6);
    for picture in pictures {
        let fields: Vec<&String> = picture.as_object().unwrap().keys().collect();
        let expected = "azimuth_deg elevation_deg distance light flip flip_p95 relmse relmse_8x8 bias bias_rgb coverage \
                        fringe bands floor cost";
        assert_eq!(fields, expected.split_whitespace().collect::<Vec<_>>());
        let has = |part: &str, names: &[&str]| {
            names.iter().for_each(|name| assert!(picture[part][name].is_number(), "{part}.{name}"))
        };
        has("fringe", &["flip", "coverage"]);
        has("bands", &["1-2", "2-4", "4-8"]);
        has("floor", &["flip", "fringe_flip"]);
        has("cost", &["view_ms", "render_ms", "bytes", "triangles"]);
    }
    let lights: Vec<&str> = pictures.iter().map(|picture| picture["light"].as_str().unwrap()).collect();
    assert_eq!(lights, ["studio", "studio", "studio", "rim", "rim", "rim"]);
    assert_eq!(first["summary"]["by_light_and_distance"].as_array().unwrap().len(), 4);
    assert_eq!(std::fs::read_to_string(out.with_extension("csv")).unwrap().lines().count(), 7);
    let sheet = image::open(out.with_extension("png")).unwrap();
    assert_eq!([sheet.width(), sheet.height()], [2 * 40, 4 * 3 * 40]);
    // Nothing is drawn again, and the gate counts what is over the floor.
    let excess = first["summary"]["excess"]["flip"].as_f64().unwrap();
    assert!(excess > 0.0, "{excess}");
    assert_eq!(code(report(&out, &["--max-flip", &format!("{:.6}", excess + 0.001)])), Some(0));
    let again = read(&out);
    assert_eq!((drawn(&again), &again["pictures"]), ([0, 0], &first["pictures"]));
    assert_eq!(code(report(&out, &["--max-flip", &format!("{:.6}", (excess - 0.001).max(0.0))])), Some(1));
    assert_eq!(code(report(&out, &["--max-flip", "2"])), Some(2));
    // Another coat of the same fur: its pictures are new, the renders are not.
    assert_eq!(code(report(&out, &["--set", "shells.layers=4"])), Some(0));
    assert_eq!(drawn(&read(&out)), [0, 0], "the flag decides the layers");
    let lost = names(&parts).into_iter().find(|name| name.starts_with("render-") && name.ends_with(".json")).unwrap();
    std::fs::remove_file(parts.join(lost)).unwrap();
    assert_eq!(code(report(&out, &["--set", "fins.thickness_mm=1"])), Some(0));
    let other = read(&out);
    assert_eq!(drawn(&other), [1, 6]);
    // Without anything kept it comes to the same.
    std::fs::remove_dir_all(&parts).unwrap();
    assert_eq!(code(report(&out, &[])), Some(0));
    let fresh = read(&out);
    assert_eq!((drawn(&fresh), without_times(&fresh)), ([8, 6], without_times(&first)));
}
