//! The built-in presets: each reads, names itself, and describes hair that can exist.

use furrier::asset::Fallback;
use furrier::bake::units::Units;
use furrier::bake::{Method, Request, bake};
use furrier::error::Kind;
use furrier::fur::groom::{Comb, Length, Place};
use furrier::preset::Preset;

#[test]
fn every_built_in_preset_reads_and_names_itself() {
    let names: Vec<_> = Preset::names().collect();
    assert!(names.is_sorted(), "listed out of order: {names:?}");
    for name in ["mink", "fox", "rabbit", "bear", "short-cat", "sheep", "otter-wet", "plush", "grass"] {
        assert!(names.contains(&name), "no preset {name}");
    }
    for name in names {
        let preset = Preset::from_toml(Preset::source(name).unwrap()).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(preset.name, name);
        assert!(!preset.description.is_empty(), "{name} has no description");
    }
}

#[test]
fn every_preset_file_is_built_in() {
    for entry in std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/presets")).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap();
        assert_eq!(Preset::source(name), Some(std::fs::read_to_string(&path).unwrap().as_str()), "{name}");
    }
}

#[test]
fn hair_fits_on_its_skin_and_in_its_tile() {
    for name in Preset::names() {
        let preset = Preset::from_toml(Preset::source(name).unwrap()).unwrap();
        let area_cm2 = |diameter_um: f32| std::f32::consts::PI * (diameter_um * 0.5e-4).powi(2);
        let share = preset.guard.density_per_cm2 * area_cm2(preset.guard.diameter_um)
            + preset.undercoat.density_per_cm2 * area_cm2(preset.undercoat.diameter_um);
        assert!((0.001..0.25).contains(&share), "{name}: roots cover {share} of the skin");
        for clump in [preset.guard.shape.clump, preset.undercoat.shape.clump] {
            assert!(preset.shells.tile_mm > 4.0 * clump.spacing_mm, "{name}: fewer than 4 clumps along a tile");
        }
        for length_m in [preset.guard.length, preset.undercoat.length].map(|l| l.metres(preset.size_m)) {
            let share = length_m / preset.size_m;
            assert!((0.002..0.5).contains(&share), "{name}: hair is {share} of the animal's size");
        }
    }
}

fn set(preset: &str, settings: &[&str]) -> furrier::Result<Preset> {
    Preset::load(preset)?.with_settings(&settings.iter().map(|s| (*s).to_owned()).collect::<Vec<_>>())
}

#[test]
fn settings_change_what_they_name_and_nothing_else() {
    let mut expected = Preset::load("fox").unwrap();
    assert_eq!(set("fox", &[]).unwrap(), expected);
    expected.guard.length = Length::Relative(0.02);
    expected.groom.comb = Comb::Gravity;
    expected.undercoat.density_per_cm2 = 12.0;
    expected.colour.tint = [0.1, 0.2, 0.3];
    let settings = [
        "guard.length.relative=0.02",
        "groom.comb=gravity",
        "undercoat.density_per_cm2 = 12",
        "colour.tint=[0.1, 0.2, 0.3]",
    ];
    assert_eq!(set("fox", &settings).unwrap(), expected);
}

#[test]
fn a_setting_that_cannot_be_is_refused_by_name() {
    for setting in [
        "guard.diameter=1",
        "guard",
        "guard.diameter_um=thick",
        "guard.diameter_um=-1",
        "guard.diameter_um=nan",
        "name.x=1",
        "=1",
        "groom.comb=sideways",
        "guard.length.mm=1\nsize_m = 2",
    ] {
        let error = set("fox", &[setting]).expect_err(setting);
        assert_eq!(error.kind, Kind::Usage, "{setting}");
        assert!(error.field.is_some() && error.found.is_some(), "{setting}: {error}");
    }
}

#[test]
fn a_preset_file_is_found_named_and_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.toml");
    std::fs::write(&path, "size_m = 1.0\nmaps = { length = \"length.png\" }").unwrap();
    let preset = Preset::load(path.to_str().unwrap()).unwrap();
    assert_eq!(preset.name, "mine");
    assert_eq!(preset.maps.length, Some(folder.path().join("length.png")));

    std::fs::write(&path, "size_m = 1.0\n[guard]\nlenght = { mm = 3 }").unwrap();
    let error = Preset::load(path.to_str().unwrap()).unwrap_err();
    assert_eq!(error.file.as_deref(), Some(path.as_path()));
    assert!(error.found.unwrap().contains("lenght"));

    let error = Preset::load("foxx").unwrap_err();
    assert!(error.expected.unwrap().contains("fox, grass"));
}

const COMBED: &str = r#"
size_m = 1.0
[groom]
comb = "smooth"
[[groom.whorls]]
at = { relative = [0.5, 1.0, 0.5] }
reach = { relative = 0.2 }
spin_deg = 90
[[groom.whorls]]
at = { units = [0.0, -1.0, 0.0] }
[[groom.strokes]]
points = { relative = [[0.5, 0.5, 1.0], [1.0, 0.5, 0.5], [0.5, 0.5, 0.0]] }
reach = { mm = 40 }
[[groom.partings]]
points = { relative = [[0.4, 1.0, 0.7], [0.4, 1.0, 0.2]] }
width = { mm = 3 }
angle_deg = 25
"#;

#[test]
fn whorls_strokes_and_partings_are_read() {
    let groom = Preset::from_toml(COMBED).unwrap().groom;
    assert_eq!(groom.comb, Comb::Smooth);
    assert_eq!(groom.whorls[0].at, Place::Relative([0.5, 1.0, 0.5]));
    assert_eq!((groom.whorls[0].spin_deg, groom.whorls[1].spin_deg), (90.0, 60.0));
    assert_eq!(groom.whorls[1].reach, Length::Relative(0.1));
    assert_eq!(groom.strokes[0].points.places().len(), 3);
    let parting = &groom.partings[0];
    assert_eq!((parting.reach, parting.width), (Length::Relative(0.1), Length::Mm(3.0)));
    assert_eq!(parting.angle_deg, 25.0);
    // Settings reach them as they reach all else.
    let cleared = Preset::from_toml(COMBED).unwrap().with_settings(&["groom.whorls=[]".to_owned()]).unwrap();
    assert!(cleared.groom.whorls.is_empty() && cleared.groom.strokes.len() == 1);
}

#[test]
fn whorls_strokes_and_partings_that_cannot_be_are_refused_by_name() {
    for (good, bad, field) in [
        ("[0.5, 1.0, 0.5]", "[0.5, 7.0, 0.5]", "groom.whorls[0].at.relative"),
        ("[0.0, -1.0, 0.0]", "[0.0, nan, 0.0]", "groom.whorls[1].at.units"),
        ("{ relative = 0.2 }", "{ relative = 0.0 }", "groom.whorls[0].reach.relative"),
        ("spin_deg = 90", "spin_deg = 360", "groom.whorls[0].spin_deg"),
        ("{ mm = 40 }", "{ mm = -1 }", "groom.strokes[0].reach.mm"),
        ("{ mm = 3 }", "{ mm = -1 }", "groom.partings[0].width.mm"),
        ("angle_deg = 25", "angle_deg = 91", "groom.partings[0].angle_deg"),
        ("[[0.4, 1.0, 0.7], [0.4, 1.0, 0.2]]", "[[0.4, 1.0, 0.7]]", "groom.partings[0].points"),
        ("[[0.5, 0.5, 1.0], [1.0, 0.5, 0.5], [0.5, 0.5, 0.0]]", "[[0.5, 0.5, 1.0]]", "groom.strokes[0].points"),
        ("[1.0, 0.5, 0.5]", "[0.5, 0.5, 1.0]", "groom.strokes[0].points"),
        ("[1.0, 0.5, 0.5]", "[1.0, 0.5, inf]", "groom.strokes[0].points[1].relative"),
    ] {
        let text = COMBED.replacen(good, bad, 1);
        assert_ne!(text, COMBED, "{good} is not in the preset");
        let error = Preset::from_toml(&text).expect_err(bad);
        assert_eq!((error.kind, error.field.as_deref()), (Kind::Usage, Some(field)), "{error}");
    }
    for text in ["at = 3", "at = { relative = [0.5, 1.0] }", "at = { metres = [0, 0, 0] }", "spin = 3"] {
        assert!(Preset::from_toml(&COMBED.replacen("spin_deg = 90", text, 1)).is_err(), "{text}");
    }
}

#[test]
fn a_whorl_turns_hair_where_it_says_and_one_that_misses_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let bake = |preset: Preset| {
        let request = Request {
            input: "sample:sphere".into(),
            reading: Default::default(),
            out: folder.path().join("sphere.glb"),
            preset: preset.with_settings(&["shells.texture_size=16".into(), "shells.layers=2".into()]).unwrap(),
            presets: vec![],
            materials: vec![],
            units: Units::Auto,
            method: Method::Lapped,
            seed: 0,
            fallback: Fallback::None,
            judge: false,
            cache: None,
            draft: false,
        };
        bake(&request, &mut |_| {}).unwrap()
    };
    let size = |baked: &furrier::bake::Baked| baked.diagonal_m as f32;
    let missing = COMBED.replacen("0.0, -1.0, 0.0", "0.0, -50.0, 0.0", 1).replacen("0.4, 1.0, 0.", "0.4, 1.5, 0.", 2);
    let preset = Preset::from_toml(&missing).unwrap();
    let baked = bake(preset);
    // The first whorl sits on the top of the ball: a crown there, and nowhere else so near.
    let top = furrier::math::Vec3::Y * 0.5 * size(&baked) / 3.0_f32.sqrt();
    let crowns: Vec<_> = baked.laid[0].singularities.iter().filter(|s| s.index == 1).collect();
    let near = crowns.iter().map(|s| s.position_m.distance(top)).fold(f32::INFINITY, f32::min);
    assert!(near < 0.05 * size(&baked), "{near} m from the top, {crowns:?}");
    let told: Vec<_> = baked.warnings.iter().filter(|w| w.contains("groom.")).collect();
    assert!(told.len() == 2 && told[0].contains("groom.whorls[1] combs nothing"), "{told:?}");
    assert!(told[1].contains("groom.partings[0] combs nothing"), "{told:?}");
}
