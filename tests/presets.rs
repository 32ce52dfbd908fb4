//! The built-in presets: each reads, names itself, and describes hair that can exist.

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
