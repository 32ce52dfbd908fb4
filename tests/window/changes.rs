//! Changes of a preset: undone, done again, saved, told as settings. What the window shows is what `bake` writes.

use furrier::bake::bake;
use furrier::bake::recipe::{Choices, Recipe};
use furrier::bake::seen::seen;
use furrier::math::hash::Stream;
use furrier::preset::keys::{Key, tables};
use furrier::window::edits::Edits;
use std::path::Path;

fn quick() -> Recipe {
    let settings = ["shells.texture_size=16", "shells.layers=4"].map(String::from).to_vec();
    Choices { settings, ..Choices::default() }.recipe().unwrap()
}

/// The file that a bake of a ball by this recipe writes.
fn file(recipe: &Recipe) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out.glb");
    bake(&recipe.request("sample:sphere", &out, false), &mut |_| ()).unwrap();
    std::fs::read(out).unwrap()
}

/// Keys with numbers that may be anywhere in their range without making a bake slow.
fn numbers() -> Vec<Key> {
    let slow = ["shells.", "fins.", "density", "size_m", "undercoat."];
    let keys = tables().into_iter().flat_map(|table| table.keys);
    keys.filter(|key| key.value == "a number" && key.range.is_some() && !key.key.contains('['))
        .filter(|key| key.default.is_some() && !slow.iter().any(|part| key.key.contains(part)))
        .collect()
}

#[test]
fn two_hundred_changes_undone_leave_the_bytes_that_there_were() {
    let recipe = quick();
    let (before, mut edits) = (file(&recipe), Edits::new(Box::new(recipe.clone())));
    let (keys, mut rng) = (numbers(), Stream::new(19));
    assert!(keys.len() > 10, "{}", keys.len());
    let (mut undone, mut done) = (0, 0);
    while done < 200 {
        if rng.unit() < 0.3 && edits.undo() {
            undone += 1;
            continue;
        }
        let key = &keys[(rng.unit() * keys.len() as f32) as usize % keys.len()];
        let [low, high] = key.range.unwrap();
        let value = low + (high - low).min(100.0) * f64::from(rng.unit());
        // What two keys together forbid is refused, and changes nothing.
        let now = edits.recipe().clone();
        match edits.set(&key.key, &format!("{value:?}")) {
            Ok(()) => done += 1,
            Err(_) => assert_eq!(*edits.recipe(), now),
        }
        edits.let_go();
    }
    assert!(undone > 20 && *edits.recipe() != recipe);
    while edits.undo() {}
    assert_eq!(*edits.recipe(), recipe);
    assert!(file(edits.recipe()) == before);
    while edits.redo() {}
    assert!(*edits.recipe() != recipe);
}

#[test]
fn a_saved_preset_bakes_to_what_the_window_shows() {
    let mut edits = Edits::new(Box::new(quick()));
    for (key, value) in [("guard.length.mm", "23.7"), ("colour.tint", "[0.3, 0.1, 0.02]"), ("groom.lean_deg", "31.3")] {
        edits.set(key, value).unwrap();
    }
    let folder = tempfile::tempdir().unwrap();
    let saved = folder.path().join("mine.toml");
    edits.save(&saved).unwrap();
    let again = Choices { presets: vec![saved.to_str().unwrap().to_owned()], ..Choices::default() }.recipe().unwrap();
    assert_eq!(again, *edits.recipe());
    let shown = file(edits.recipe());
    assert!(shown == file(&again));
    // The coat that is drawn is the one in the file.
    let (_, coat, _) = seen(edits.recipe(), ("sample:sphere", None), &Default::default(), None, &mut |_| ()).unwrap();
    let written = folder.path().join("written.glb");
    std::fs::write(&written, shown).unwrap();
    let (_, read) = furrier::asset::coat::read_coat(Path::new(&written)).unwrap();
    assert!(coat.tiles == read.tiles);
    assert_eq!(coat.primitives.len(), read.primitives.len());
}

#[test]
fn settings_tell_what_was_changed() {
    let recipe = quick();
    let mut edits = Edits::new(Box::new(recipe.clone()));
    assert!(edits.settings().is_empty());
    edits.set("guard.length.mm", "23.7").unwrap();
    edits.set("groom.lean_deg", "31").unwrap();
    let settings = edits.settings();
    assert_eq!(settings.len(), 2, "{settings:?}");
    assert_eq!(recipe.preset.with_settings(&settings).unwrap(), edits.recipe().preset);
}

#[test]
fn one_pull_of_a_slider_is_one_change() {
    let mut edits = Edits::new(Box::new(quick()));
    for value in ["20.0", "21.0", "22.0"] {
        edits.set("guard.length.mm", value).unwrap();
    }
    edits.let_go();
    edits.set("guard.length.mm", "30.0").unwrap();
    assert_eq!(edits.depth(), [2, 0]);
    edits.undo();
    assert_eq!(edits.settings(), ["guard.length.mm=22.0"]);
    edits.undo();
    assert!(edits.settings().is_empty());
    assert_eq!(edits.depth(), [0, 2]);
    assert!(edits.set("guard.length.mm", "-3.0").is_err());
    assert_eq!(edits.depth(), [0, 2]);
}
