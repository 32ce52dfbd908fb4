//! Which parts are furred: those asked for by material name, or all that are not by name something bare.

use super::part::Part;
use crate::error::{Error, Result};

/// Words in a material's name that mean it has no fur.
const BARE: [&str; 21] = [
    "eye",
    "eyes",
    "nose",
    "teeth",
    "tooth",
    "tongue",
    "claw",
    "claws",
    "hoof",
    "hooves",
    "horn",
    "horns",
    "pad",
    "pads",
    "lash",
    "lashes",
    "eyelash",
    "eyelashes",
    "ground",
    "floor",
    "terrain",
];

/// Indices of the parts to fur.
///
/// # Errors
/// Lists the materials there are when a name is unknown, or when all of them are bare.
pub fn select(parts: &[Part], names: &[String]) -> Result<Vec<usize>> {
    let known = || {
        let mut known: Vec<&str> = parts.iter().map(|part| part.material_name.as_str()).collect();
        known.dedup();
        format!("one of: {}", known.join(", "))
    };
    if let Some(unknown) = names.iter().find(|name| !parts.iter().any(|part| part.material_name == **name)) {
        return Err(Error::usage("no part has this material")
            .with_parameter("material")
            .with_found(unknown)
            .with_expected(known()));
    }
    let wanted = |part: &Part| {
        if names.is_empty() { !is_bare(&part.material_name) } else { names.contains(&part.material_name) }
    };
    let chosen: Vec<usize> = (0..parts.len()).filter(|&i| wanted(&parts[i])).collect();
    if chosen.is_empty() {
        return Err(Error::usage("by their names, all materials are bare")
            .with_parameter("material")
            .with_expected(known())
            .with_hint("name the material to fur with `material`"));
    }
    Ok(chosen)
}

/// Whether a word of `name` is one of [`BARE`]; words end at anything but letters and before a capital.
pub fn is_bare(name: &str) -> bool {
    let mut words = vec![String::new()];
    let mut lower_before = false;
    for c in name.chars() {
        if !c.is_alphabetic() || (c.is_uppercase() && lower_before) {
            words.push(String::new());
        }
        if c.is_alphabetic() {
            words.last_mut().expect("never empty").extend(c.to_lowercase());
        }
        lower_before = c.is_lowercase();
    }
    words.iter().any(|word| BARE.contains(&word.as_str()))
}
