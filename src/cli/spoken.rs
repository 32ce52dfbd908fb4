//! A bake as the command line that asks for it.

use crate::asset::coat::Fallback;
use crate::bake::recipe::{Choices, Layout, Target};
use crate::bake::units::Units;
use serde::Serialize;

/// `furrier bake` of an input with these choices, for a POSIX shell.
pub fn bake(input: &str, choices: &Choices) -> String {
    let mut words = vec!["furrier bake".to_owned(), quoted(input), "-o furry.glb".to_owned()];
    words.extend(choices.presets.iter().map(|preset| format!("--preset {}", quoted(preset))));
    words.extend(choices.settings.iter().map(|setting| format!("--set {}", quoted(setting))));
    words.extend(choices.materials.iter().map(|material| format!("--material {}", quoted(material))));
    words.extend((choices.units != Units::Auto).then(|| format!("--units {}", name(choices.units))));
    let layout = choices.layout;
    words.extend((layout != Layout::Lapped).then(|| format!("--parameterisation {}", name(layout))));
    words.extend(choices.uv_set.map(|set| format!("--uv-set {set}")));
    words.extend(choices.layers.map(|layers| format!("--layers {layers}")));
    words.extend(choices.texture_size.map(|texels| format!("--texture-size {texels}")));
    words.extend((choices.seed != 0).then(|| format!("--seed {}", choices.seed)));
    words.extend(choices.fallback.map(|fallback| match fallback {
        Fallback::None => "--fallback none".to_owned(),
        Fallback::Shells(count) => format!("--fallback shells:{count}"),
    }));
    words.extend((choices.target != Target::Desktop).then(|| format!("--target {}", name(choices.target))));
    words.extend(choices.up.map(|axis| format!("--up={}", name(axis))));
    words.extend(choices.forward.map(|axis| format!("--forward={}", name(axis))));
    words.extend(choices.lods.then(|| "--lods".to_owned()));
    words.join(" ")
}

/// A word that a shell takes as one.
fn quoted(text: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=:@,+".contains(c);
    if !text.is_empty() && text.chars().all(plain) {
        return text.to_owned();
    }
    format!("'{}'", text.replace('\'', "'\\''"))
}

/// As it is written in files and on the command line.
fn name(value: impl Serialize) -> String {
    serde_json::to_value(value).ok().and_then(|value| value.as_str().map(str::to_owned)).unwrap_or_default()
}
