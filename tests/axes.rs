//! Files that are not y up: stood upright to be combed and seen, written as they were.

use crate::common::shared;
use crate::one_skin::thin;
use furrier::asset::axes::{Axis, Upright};
use furrier::asset::{self, Fallback, Reading};
use furrier::bake::picture::{Grown, Only, PictureRequest};
use furrier::bake::units::Units;
use furrier::bake::{Baked, Method, Request, bake};
use furrier::math::{DMat3, DVec3, Vec3};
use serde_json::json;
use std::path::Path;

fn axis(text: &str) -> Axis {
    text.parse().unwrap_or_else(|error| panic!("{text}: {error}"))
}

#[test]
fn a_file_is_stood_upright_without_being_mirrored() {
    for (up, stands, forward, looks) in [
        ("y", DVec3::Y, None, DVec3::Z),
        ("z", DVec3::Z, None, DVec3::NEG_Y),
        ("-z", DVec3::NEG_Z, None, DVec3::Y),
        ("z", DVec3::Z, Some("-x"), DVec3::NEG_X),
        ("x", DVec3::X, None, DVec3::Z),
        ("-y", DVec3::NEG_Y, Some("+X"), DVec3::X),
    ] {
        let turn = Upright::of(Some(axis(up)), forward.map(axis)).unwrap().unwrap().turn();
        assert_eq!((turn * stands, turn * looks, turn.determinant()), (DVec3::Y, DVec3::Z, 1.0), "{up} {forward:?}");
    }
    assert!(Upright::of(Some(axis("z")), Some(axis("-z"))).is_err());
    assert!("w".parse::<Axis>().is_err());
}

/// The creature as it is, and lying: its vertices in a file with z up, its front towards −y.
fn creature(folder: &Path) -> [std::path::PathBuf; 2] {
    let document = asset::load("sample:creature").unwrap().document;
    let mut lying = document.clone();
    // A root above all others turns the file's y to its z.
    let roots = lying.json["scenes"][0]["nodes"].clone();
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let root = lying.push("nodes", json!({"name": "turned", "rotation": [half, 0.0, 0.0, half], "children": roots}));
    lying.json["scenes"][0]["nodes"] = json!([root]);
    let paths = ["standing.glb", "lying.glb"].map(|name| folder.join(name));
    std::fs::write(&paths[0], document.to_glb().unwrap()).unwrap();
    std::fs::write(&paths[1], lying.to_glb().unwrap()).unwrap();
    paths
}

fn z_up() -> Reading {
    Reading { upright: Upright::of(Some(axis("z")), None).unwrap().map(Upright::turn), ..Reading::default() }
}

fn request(input: &Path, reading: Reading, out: &Path) -> Request {
    Request {
        input: input.to_string_lossy().into_owned(),
        reading,
        out: out.to_owned(),
        preset: thin(&["groom.comb=tailward", "groom.gravity=0.5"]),
        presets: vec![],
        materials: vec!["fur".into()],
        units: Units::Metres,
        method: Method::Uv(0),
        seed: 0,
        fallback: Fallback::None,
        judge: false,
        cache: None,
        draft: false,
    }
}

fn baked(input: &Path, reading: Reading, out: &Path) -> Baked {
    bake(&request(input, reading, out), &mut |_| {}).unwrap()
}

#[test]
fn fur_of_a_file_that_lies_is_combed_as_if_it_stood() {
    let folder = tempfile::tempdir().unwrap();
    let [standing, lying] = creature(folder.path());
    let out = folder.path().join("out.glb");
    let offsets =
        |baked: &Baked| -> Vec<Vec3> { baked.coat.primitives.iter().flat_map(|p| p.offset.clone()).collect() };
    let expected = offsets(&baked(&standing, Reading::default(), &out));
    let found = offsets(&baked(&lying, z_up(), &out));
    let across = offsets(&baked(&lying, Reading::default(), &out));
    // Offsets are in the primitive's own space, which is the same in both files.
    let off = |other: &[Vec3]| -> f32 {
        let sum: f32 = expected.iter().zip(other).map(|(a, b)| a.angle_between(*b)).sum();
        sum / expected.len() as f32
    };
    assert_eq!(expected.len(), found.len());
    assert!(off(&found) < 1e-3, "{} rad off", off(&found));
    assert!(off(&across) > 0.2, "without a word it is combed across: {} rad", off(&across));
    // The file's own geometry is as it was.
    let (before, after) =
        (asset::load(&lying.to_string_lossy()).unwrap(), asset::load(&out.to_string_lossy()).unwrap());
    assert_eq!(before.document.json["nodes"], after.document.json["nodes"]);
    assert_eq!(before.parts[0].stored.positions, after.parts[0].stored.positions);
}

#[test]
fn hairs_and_pictures_of_it_stand_and_exports_lie_on_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let [standing, lying] = creature(folder.path());
    let grown = |input: &Path, reading| {
        Grown::new(&PictureRequest {
            input: input.to_string_lossy().into_owned(),
            reading,
            preset: thin(&[]),
            materials: vec!["fur".into()],
            units: Units::Metres,
            seed: 0,
            only: Only::Guard,
            pose: None,
        })
        .unwrap()
    };
    let (a, b) = (grown(&standing, Reading::default()), grown(&lying, z_up()));
    let spread = |grown: &Grown| {
        let points = &grown.subject.points_m;
        points.iter().copied().fold(Vec3::MIN, Vec3::max) - points.iter().copied().fold(Vec3::MAX, Vec3::min)
    };
    assert!((spread(&a) - spread(&b)).length() < 1e-4, "{} and {}", spread(&a), spread(&b));
    // In the file's axes its height is along z.
    let turn: DMat3 = b.export("x").file_from_world;
    assert!((turn * DVec3::Y - DVec3::Z).length() < 1e-12);
    let text = |grown: &Grown| {
        let format = asset::strands::Format::Usda;
        String::from_utf8(asset::strands::encode(&grown.export("x"), format).unwrap()).unwrap()
    };
    assert!(text(&a).contains("upAxis = \"Y\"") && text(&b).contains("upAxis = \"Z\""));
}

#[test]
fn a_scan_with_z_up_is_combed_from_head_to_tail() {
    let Some(input) = shared().map(|shared| shared.join("wild/zup.obj")) else { return };
    let folder = tempfile::tempdir().unwrap();
    let mean = |reading| -> Vec3 {
        let request = Request { materials: vec![], ..request(&input, reading, &folder.path().join("out.glb")) };
        let offsets: Vec<Vec3> =
            bake(&request, &mut |_| {}).unwrap().coat.primitives.iter().flat_map(|p| p.offset.clone()).collect();
        offsets.iter().map(|offset| offset.normalize_or_zero()).sum::<Vec3>() / offsets.len() as f32
    };
    // Its front looks to -y, as that of Blender's files: hair lies towards +y. As if y were up, it lies towards its feet.
    let (standing, lying) = (mean(z_up()), mean(Reading::default()));
    assert!(standing.y > 0.3, "{standing}");
    assert!(lying.y < 0.1 && lying.z < -0.3, "{lying}");
}
