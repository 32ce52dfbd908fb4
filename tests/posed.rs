//! Hair on a skin that moves: the same hairs in every pose, and no flicker.

use crate::common::furrier_path;
use crate::common::{framing, studio};
use crate::scenes::{self, Grown};
use assert_cmd::Command;
use furrier::bake::picture::{self, Only, PictureRequest};
use furrier::bake::units::Units;
use furrier::data::camera::Camera;
use furrier::data::film::Film;
use furrier::data::strands::Strands;
use furrier::hybrid::{Settings, draw};
use furrier::math::{Quat, Vec3};
use furrier::metrics::compare::{LinearImage, compare};
use furrier::preset::Preset;
use predicates::prelude::*;

fn length_m(strands: &Strands, hair: usize) -> f32 {
    strands.points_of_m(hair).windows(2).map(|pair| pair[0].distance(pair[1])).sum()
}

fn creature(pose: Option<f64>) -> picture::Grown {
    let preset = Preset::load("fox").unwrap();
    let thinner = ["guard.density_per_cm2=60".to_owned(), "undercoat.density_per_cm2=3000".to_owned()];
    picture::Grown::new(&PictureRequest {
        input: "sample:creature".into(),
        reading: Default::default(),
        preset: preset.with_settings(&thinner).unwrap(),
        materials: vec![],
        units: Units::Auto,
        seed: 5,
        only: Only::Hybrid,
        pose: pose.map(|seconds| ("walk".into(), seconds)),
    })
    .unwrap()
}

#[test]
fn a_skin_that_turns_takes_its_hair_along() {
    let (guard, undercoat) = scenes::mink();
    let guard = furrier::fur::groom::Guard {
        density_per_cm2: 20.0,
        shape: furrier::fur::groom::Shape {
            clump: furrier::fur::groom::Clump { spacing_mm: 4.0, strength: 0.7 },
            ..guard.shape
        },
        ..guard
    };
    let grown = Grown::new(scenes::bent_skin(1), &guard, &undercoat, Vec3::X, 35.0, 3);
    let (turn, shift) = (Quat::from_rotation_x(1.0) * Quat::from_rotation_y(2.0), Vec3::new(0.2, -0.1, 0.3));
    let mut mesh = grown.mesh.clone();
    mesh.rest_m = Some(mesh.positions_m.clone());
    mesh.positions_m.iter_mut().for_each(|p| *p = turn * *p + shift);
    mesh.normals.iter_mut().for_each(|n| *n = turn * *n);
    let mut fields = grown.fields.clone();
    fields.lean.iter_mut().chain(&mut fields.direction).for_each(|v| *v = turn * *v);
    let moved = furrier::fur::grow::skin::grow(&grown.guard_fibre, &mesh, &fields, 3);
    assert_eq!((moved.id.len(), &moved.roots), (grown.guard.len(), &grown.guard.roots));
    let off = |(a, b): (&Vec3, &Vec3)| (turn * *a + shift).distance(*b);
    let worst = grown.guard.points_m.iter().zip(&moved.points_m).map(off).fold(0.0, f32::max);
    assert!(worst < 2e-6, "{worst} m off");
}

#[test]
fn every_pose_wears_the_same_hair() {
    let (rest, walking) = (creature(None), creature(Some(0.25)));
    let strands = |grown: &picture::Grown| grown.scene().guard.unwrap().0.clone();
    let (a, b) = (strands(&rest), strands(&walking));
    assert!(a.len() > 10_000);
    assert_eq!((&a.id, &a.roots, &a.tint, &a.root_radius_m), (&b.id, &b.roots, &b.tint, &b.root_radius_m));
    let mut moved = 0.0_f32;
    let mut changes: Vec<f32> = (0..a.len())
        .map(|hair| {
            moved = moved.max(a.points_of_m(hair)[0].distance(b.points_of_m(hair)[0]));
            (length_m(&b, hair) / length_m(&a, hair) - 1.0).abs()
        })
        .collect();
    changes.sort_by(f32::total_cmp);
    let of = |share: f64| changes[((changes.len() - 1) as f64 * share) as usize];
    println!("lengths change by {:.5} (half of the hairs), {:.4} (99 %), {:.4} (all)", of(0.5), of(0.99), of(1.0));
    assert!(moved > 0.02 && of(0.5) < 1e-3 && of(0.99) < 0.04 && of(1.0) < 0.2);
}

/// How far two seeds of the reference may differ: what flickers less than that, flickers no more than the truth.
pub const NOISE: f64 = 0.007;

/// Mean FLIP between neighbouring frames.
pub fn change(frames: &[Film]) -> f64 {
    let flip = |pair: &[Film]| compare(&LinearImage::from(&pair[0]), &LinearImage::from(&pair[1])).unwrap().flip;
    frames.windows(2).map(flip).sum::<f64>() / (frames.len() - 1) as f64
}

const SIZE: [usize; 2] = [48, 48];

fn preview() -> Settings {
    Settings::preview(SIZE)
}

/// How much more final's frames change than supersampled ones.
fn flicker(films: impl Fn(&Settings) -> Vec<Film>, what: &str) -> f64 {
    let [truth, preview, best] =
        [Settings { halvings: 2, size: SIZE, ..Settings::default() }, preview(), Settings::best(SIZE)]
            .map(|settings| change(&films(&settings)));
    println!("{what}: FLIP between frames {truth:.4} by 16 samples, {best:.4} by final, {preview:.4} by preview");
    best - truth
}

#[test]
fn an_orbit_flickers_no_more_than_the_truth() {
    let (mut guard, undercoat) = scenes::mink();
    guard.density_per_cm2 = 50.0;
    let grown = Grown::new(scenes::bent_skin(1), &guard, &undercoat, Vec3::X, 35.0, 3);
    let eye = |k: usize| {
        let angle = 0.6 + 0.004 * k as f32;
        scenes::looking(Vec3::new(angle.sin(), 0.7, angle.cos()) * 0.35, Vec3::ZERO, Vec3::Y, 34.0)
    };
    let films = |settings: &Settings| -> Vec<Film> {
        (0..3).map(|k| draw(&grown.scene(), &scenes::studio(), &eye(k), settings).unwrap().film).collect()
    };
    assert!(flicker(films, "orbit") < NOISE);
}

#[test]
fn a_walk_flickers_no_more_than_the_truth() {
    let grown: Vec<picture::Grown> = (0..2).map(|k| creature(Some(0.25 + 0.01 * f64::from(k)))).collect();
    let camera: Camera = framing(&grown[0], 35.0, 20.0, 0.5, SIZE);
    assert_eq!(camera, framing(&grown[1], 35.0, 20.0, 0.5, SIZE), "the camera stands still");
    let films = |settings: &Settings| -> Vec<Film> {
        grown.iter().map(|grown| grown.draw(&studio(&camera), &camera, settings).unwrap().film).collect()
    };
    assert!(flicker(films, "walk") < NOISE);
}

#[test]
fn a_pose_is_named_by_animation_and_time() {
    let folder = tempfile::tempdir().unwrap();
    let render = |pose: &[&str], name: &str| {
        let mut command = Command::new(furrier_path());
        command.args(["render", "sample:creature", "--size", "24x24", "--set", "guard.density_per_cm2=10"]).args(pose);
        command.args(["--set", "undercoat.density_per_cm2=500", "-o"]).arg(folder.path().join(name));
        command.assert()
    };
    let picture = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
    render(&[], "rest.png").success();
    render(&["--pose", "walk@0.25"], "named.png").success();
    render(&["--pose", "0@0.25"], "numbered.png").success();
    assert_eq!(picture("named.png"), picture("numbered.png"));
    assert_ne!(picture("named.png"), picture("rest.png"));
    let names = predicate::str::contains("--pose").and(predicate::str::contains("walk"));
    render(&["--pose", "gallop@0.25"], "no.png").code(2).stderr(names);
    for pose in ["walk", "walk@", "walk@soon", "walk@inf", "@1", "1@0"] {
        render(&["--pose", pose], "no.png").code(2);
    }
    assert!(!folder.path().join("no.png").exists());
}
