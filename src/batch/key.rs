//! What decides a coat beside its input, in a form that can be compared: presets with the hashes of what they name in place of paths.

use super::content::Digest;
use crate::bake::recipe::Recipe;
use crate::error::{Error, Result};
use crate::preset::Preset;
use serde_json::{Map, Value, json};
use std::path::Path;

/// Of a recipe.
#[derive(Clone, Debug, PartialEq)]
pub struct Key {
    /// Its hash.
    pub digest: Digest,
    /// What was hashed.
    pub value: Value,
}

impl Key {
    /// Reads what the presets name and hashes it all.
    ///
    /// # Errors
    /// Where a region's preset cannot be read. A map that is not there is a value like any other: the bake says what it thinks of it.
    pub fn of(recipe: &Recipe) -> Result<Self> {
        let own: Result<Map<String, Value>> =
            recipe.presets.iter().map(|(material, preset)| Ok((material.clone(), resolved(preset)?))).collect();
        let mut value = json!({
            "preset": resolved(&recipe.preset)?,
            "presets": own?,
            "materials": recipe.materials,
            "units": recipe.units,
            "method": recipe.method,
            "seed": recipe.seed,
            "fallback": recipe.fallback,
        });
        // What is as it always was is not named, so that what was baked before is up to date.
        if let Some(upright) = recipe.upright {
            value["upright"] = json!(upright);
        }
        if recipe.lods {
            value["lods"] = json!(true);
        }
        Ok(Self { digest: Digest::of(value.to_string().as_bytes()), value })
    }
}

/// A preset as JSON, without what no coat shows.
fn resolved(preset: &Preset) -> Result<Value> {
    let mut value = serde_json::to_value(preset)
        .map_err(|error| Error::usage("a preset cannot be written as JSON").with_found(error))?;
    if let Some(table) = value.as_object_mut() {
        table.shift_remove("description");
    }
    if let Some(maps) = value["maps"].as_object_mut() {
        maps.values_mut().for_each(by_content);
    }
    for (region, own) in value["regions"].as_array_mut().into_iter().flatten().zip(&preset.regions) {
        by_content(&mut region["map"]);
        // Regions have none of their own: their presets with regions are refused by the bake.
        let preset = Preset { regions: Vec::new(), ..Preset::load(&own.preset)? };
        region["preset"] = resolved(&preset)?;
    }
    Ok(value)
}

/// Puts the hash of a file in place of its path.
fn by_content(path: &mut Value) {
    if let Some(file) = path.as_str() {
        let digest = Digest::of_file(Path::new(file));
        *path = digest.map_or_else(|_| json!("not there"), |digest| json!(digest));
    }
}

/// What differs between two values, by dotted key: old and new, each none where the key is missing.
pub fn differences<'a>(old: &'a Value, new: &'a Value) -> Vec<(String, Option<&'a Value>, Option<&'a Value>)> {
    let mut found = Vec::new();
    walk("", Some(old), Some(new), &mut found);
    found
}

fn walk<'a>(
    key: &str,
    old: Option<&'a Value>,
    new: Option<&'a Value>,
    found: &mut Vec<(String, Option<&'a Value>, Option<&'a Value>)>,
) {
    let below = |name: &str| if key.is_empty() { name.to_owned() } else { format!("{key}.{name}") };
    match (old, new) {
        (old, new) if old == new => {}
        (Some(Value::Object(a)), Some(Value::Object(b))) => {
            let names = a.keys().chain(b.keys().filter(|name| !a.contains_key(*name)));
            names.for_each(|name| walk(&below(name), a.get(name), b.get(name), found));
        }
        (Some(Value::Array(a)), Some(Value::Array(b))) if a.len() == b.len() => {
            (0..a.len()).for_each(|i| walk(&below(&i.to_string()), a.get(i), b.get(i), found));
        }
        _ => found.push((key.to_owned(), old, new)),
    }
}
