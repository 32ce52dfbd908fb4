//! KHR_materials_variants: what else a primitive may look like.

use super::document::Document;
use super::json::At;
use super::material::{BaseColour, Material};
use super::repair::Notes;
use crate::error::Result;

const NAME: &str = "KHR_materials_variants";

/// A material variant in which a primitive has another colour than its own material's.
#[derive(Clone, Debug, PartialEq)]
pub struct Variant {
    /// The variant's name.
    pub name: String,
    /// The name of the material that the primitive has then.
    pub material: String,
    /// The colour of that material.
    pub colour: BaseColour,
}

/// The variants in which a primitive, whose own material has the number `own` and a `colour`, has another colour.
///
/// # Errors
/// As [`Material::of`].
pub fn variants(
    document: &Document,
    primitive: &At<'_>,
    own: Option<usize>,
    colour: &BaseColour,
) -> Result<Vec<Variant>> {
    let member = |owner: &At<'_>| {
        owner
            .get("extensions")
            .and_then(|extensions| extensions.get(NAME).map(|at| at.value.clone()))
            .unwrap_or_default()
    };
    let (here, all) = (member(primitive), member(&document.root()));
    let mut found = Vec::new();
    for mapping in here["mappings"].as_array().into_iter().flatten() {
        let index = mapping["material"].as_u64().map(|index| index as usize);
        let Some(index) = index.filter(|&index| index < document.count("materials") && Some(index) != own) else {
            continue;
        };
        // What of it cannot be read is no matter of this coat.
        let other = Material::of(document, Some(index), &mut Notes::default())?;
        if other.base_colour == *colour {
            continue;
        }
        for variant in mapping["variants"].as_array().into_iter().flatten().filter_map(serde_json::Value::as_u64) {
            let name = all["variants"][variant as usize]["name"].as_str();
            found.push(Variant {
                name: name.map_or_else(|| format!("variant {variant}"), str::to_owned),
                material: other.name.clone(),
                colour: other.base_colour.clone(),
            });
        }
    }
    Ok(found)
}
