//! Keys of presets as the types define them, and settings of single ones.

use furrier::error::{Error, Kind};
use furrier::fur::groom::{Length, Place};
use furrier::preset::Preset;
use furrier::preset::keys::{Key, tables};
use serde_json::json;

fn keys() -> Vec<Key> {
    tables().into_iter().flat_map(|table| table.keys).collect()
}

fn set(settings: &[&str]) -> Result<Preset, Error> {
    let settings: Vec<String> = settings.iter().map(|&s| s.to_owned()).collect();
    Preset::load("fox").unwrap().with_settings(&settings)
}

#[test]
fn a_key_says_what_it_takes() {
    let keys = keys();
    let key = |name: &str| keys.iter().find(|key| key.key == name).unwrap_or_else(|| panic!("no key {name}"));
    for (name, expected) in [
        ("size_m", "a number from 0.001 to 1000 m"),
        ("guard.length.mm", "a number from 0.001 to 10000 mm"),
        ("guard.length.relative", "a number from 0.00001 to 2"),
        ("guard.density_per_cm2", "a number from 0 to 1000000 per cm²"),
        ("guard.shape.bend_deg", "a number from 0 to 120 degrees"),
        ("undercoat.diameter_um", "a number from 0.1 to 100000 µm"),
        ("groom.comb", "one of upright, gravity, tailward, smooth"),
        ("groom.whorls[0].reach.relative", "a number from 0.0001 to 2"),
        ("groom.partings[0].width.mm", "a number from 0 to 1000000 mm"),
        ("groom.strokes[0].points.units", "a list, each 3 numbers"),
        ("colour.tint", "3 numbers from 0 to 1"),
        ("colour.guard", "3 times 3 numbers from 0 to 1"),
        ("fibre.model", "one of medulla, sadeghi, kajiya-kay"),
        ("fibre.guard.medulla", "a number from 0 to 0.95"),
        ("maps.length", "a text"),
        ("shells.layers", "a whole number from 2 to 256"),
        ("shells.texture_size", "a power of two from 16 to 2048"),
        ("fins.thickness_mm", "a number from 0.001 to 10000 mm"),
        ("regions", "a list of tables"),
        ("regions[0].preset", "a text"),
    ] {
        assert_eq!(key(name).expected(), expected, "{name}");
    }
    assert_eq!(key("guard.length.mm").default, Some(json!(10.0)));
    assert!(key("guard.length.mm").what.contains("Mean length") && key("guard.length.mm").what.contains("Millimetres"));
    assert!(key("groom.comb").what.contains("upright: Hair stands along the normal"));
    for key in &keys {
        assert!(!key.what.is_empty(), "{} is not explained", key.key);
        // What has a place has no bounds of its own.
        let free = [".at.", ".points.", "regions[0].reach."].iter().any(|part| key.key.contains(part));
        let number = key.value.contains("number") || key.value.contains("power");
        assert_eq!(number && !free, key.range.is_some(), "{}: {}", key.key, key.expected());
    }
}

#[test]
fn every_bound_is_kept() {
    let mut tried = 0;
    for key in keys().iter().filter(|key| !key.key.contains('[')) {
        let Some([low, high]) = key.range else { continue };
        let of = |value: f64| match key.value.as_str() {
            "3 numbers" => format!("[{value}, {value}, {value}]"),
            "3 times 3 numbers" => format!("[[{value}, 0, 0], [0, 0, 0], [0, 0, 0]]"),
            "a number" => format!("{value:?}"),
            _ => format!("{value}"),
        };
        for within in [low, high] {
            set(&[&format!("{}={}", key.key, of(within))]).unwrap_or_else(|error| panic!("{}: {error}", key.key));
        }
        let beyond = if key.value.contains("whole") || key.value.contains("power") { 1.0 } else { 1e-3 * high };
        for outside in [low - beyond, high + beyond] {
            let error = set(&[&format!("{}={}", key.key, of(outside))]).expect_err(&key.key);
            let parent = key.key.trim_end_matches(".mm").trim_end_matches(".relative");
            assert!(error.field.as_deref().is_some_and(|field| field.contains(parent)), "{}: {error}", key.key);
            assert_eq!((error.kind, error.parameter), (Kind::Usage, Some("set")), "{error}");
            assert_eq!(error.expected, Some(key.expected()), "{error}");
        }
        tried += 1;
    }
    assert!(tried > 40, "{tried} bounds");
    let error = set(&["shells.texture_size=100"]).unwrap_err();
    assert_eq!(error.expected.as_deref(), Some("a power of two from 16 to 2048"));
}

#[test]
fn settings_reach_into_lists_and_tables() {
    let preset = set(&[
        "groom.whorls[0]={at={relative=[0.5, 1, 0.5]}}",
        "groom.whorls[0].spin_deg=90",
        "groom.whorls[0].reach.mm=40",
        "groom.whorls[1].at.units=[0, 1, 0]",
        "groom.whorls[1].at.relative[2]=0.25",
    ]);
    // A place in the file's units has no shares to change one of.
    let error = preset.unwrap_err();
    assert!(error.expected.as_deref().is_some_and(|text| text.contains("[0]")), "{error}");
    let preset = set(&[
        "groom.whorls[0]={at={relative=[0.5, 1, 0.5]}}",
        "groom.whorls[0].spin_deg=90",
        "groom.whorls[0].reach.mm=40",
        "groom.whorls[0].at.relative[2]=0.25",
        "regions[0].preset=mink",
        "regions[0].material=Hat",
        "regions[1]={preset=\"plush\", material=\"Scarf\"}",
        "colour.tint[1]=0.5",
        "colour.guard[2][0]=0.25",
        "guard.shape={noise=0.3, clump={strength=0.7}}",
        "guard.length={relative=0.05}",
    ])
    .unwrap();
    let (before, whorl) = (Preset::load("fox").unwrap(), &preset.groom.whorls[0]);
    assert_eq!((whorl.spin_deg, whorl.reach), (90.0, Length::Mm(40.0)));
    assert_eq!(whorl.at, Place::Relative([0.5, 1.0, 0.25]));
    assert_eq!(preset.regions.iter().map(|r| r.preset.as_str()).collect::<Vec<_>>(), ["mink", "plush"]);
    assert_eq!(preset.regions[0].material.as_deref(), Some("Hat"));
    assert_eq!((preset.colour.tint[0], preset.colour.tint[1]), (before.colour.tint[0], 0.5));
    assert_eq!((preset.colour.guard[2][0], preset.colour.guard[2][1]), (0.25, before.colour.guard[2][1]));
    // What a table does not name stays.
    assert_eq!((preset.guard.shape.noise, preset.guard.shape.clump.strength), (0.3, 0.7));
    assert_eq!(preset.guard.shape.bend_deg, before.guard.shape.bend_deg);
    assert_eq!(preset.guard.shape.clump.spacing_mm, before.guard.shape.clump.spacing_mm);
    assert_eq!(preset.guard.length, Length::Relative(0.05));
}

#[test]
fn a_setting_that_fails_says_what_its_key_expects() {
    for (setting, expected) in [
        ("guard.lenght.mm=3", "perhaps guard.length.mm, a number from 0.001 to 10000 mm"),
        ("guard.diameter=3", "perhaps guard.diameter_um, a number from 0.1 to 100000 µm"),
        ("undercoat.shape.clump.strenght=3", "perhaps undercoat.shape.clump.strength, a number from 0 to 1"),
        ("lean_deg=3", "perhaps groom.lean_deg, a number from 0 to 75 degrees"),
        ("guard.qqqqqqqq=3", "one of density_per_cm2, length, diameter_um, taper, tip_transparency, shape in guard"),
        ("qqqqqqqqqqqqqq=3", "one of name, description, size_m, guard"),
        ("guard.diameter_um=thick", "a number from 0.1 to 100000 µm"),
        ("guard.length=12", "{ mm = … } or { relative = … }"),
        ("groom.comb=sideways", "one of upright, gravity, tailward, smooth"),
        ("shells.layers=2.5", "a whole number from 2 to 256"),
        ("colour.tint=[1, 0]", "3 numbers from 0 to 1"),
        ("colour.tint[3]=1", "an entry from [0] to [2]"),
        ("groom.whorls[2].spin_deg=1", "[0], which adds the first entry"),
        ("guard..length=1", "names with dots between"),
        ("groom.whorls[x].spin_deg=1", "names with dots between"),
    ] {
        let error = set(&[setting]).expect_err(setting);
        let said = error.expected.clone().unwrap_or_default();
        assert!(said.starts_with(expected), "{setting}: {said}, not {expected}");
        assert_eq!((error.kind, error.parameter), (Kind::Usage, Some("set")));
        assert!(error.hint.is_some_and(|hint| hint.contains("furrier presets keys")), "{setting}");
    }
    // An entry of a list must have what it must.
    let error = set(&["groom.whorls[0].spin_deg=1"]).unwrap_err();
    assert!(error.found.is_some_and(|found| found.contains("at")));
}

#[test]
fn a_target_gives_way_to_what_is_chosen_beside_it() {
    use furrier::asset::coat::Fallback;
    use furrier::bake::recipe::{Choices, Target};
    let phone = Choices { target: Target::Phone, ..Choices::default() };
    let recipe = phone.recipe().unwrap();
    assert_eq!((recipe.preset.shells.layers, recipe.preset.shells.texture_size), (4, 64));
    assert_eq!(recipe.fallback, Fallback::Shells(2));
    let own = Choices {
        settings: vec!["shells.layers=6".to_owned()],
        texture_size: Some(32),
        fallback: Some(Fallback::None),
        ..phone
    };
    let recipe = own.recipe().unwrap();
    assert_eq!((recipe.preset.shells.layers, recipe.preset.shells.texture_size), (6, 32));
    assert_eq!(recipe.fallback, Fallback::None);
    // Without one, all is as it is.
    let plain = Choices::default().recipe().unwrap();
    assert_eq!((plain.preset, plain.fallback), (furrier::preset::Preset::load("fox").unwrap(), Fallback::Shells(8)));
}
