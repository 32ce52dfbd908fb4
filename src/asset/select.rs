//! Which parts are furred: those asked for by material name, or all that neither their names nor their materials say are bare.

use super::material::Alpha;
use super::part::Part;
use super::words::bare_word;
use crate::error::{Error, Result};
use std::collections::{BTreeMap, HashMap};

/// A part is cards where at least this share of its edges are on a border: sheets of a few quads, as hair and whiskers are made of.
const CARDS: f64 = 0.25;

/// What is furred, and why the rest is not.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Selection {
    /// Indices of the parts to fur.
    pub parts: Vec<usize>,
    /// What was left out and by what it was told, where the choice was left to us.
    pub note: Option<String>,
    /// What is broken and gets no fur, one sentence each.
    pub warnings: Vec<String>,
}

/// Why a part has no fur.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Bare {
    /// By this word in a name.
    Word(String),
    /// Light shines through it.
    Transparent,
    /// It is made of cards that are cut out by alpha.
    Cards,
}

/// Chooses the parts to fur.
///
/// # Errors
/// Lists the materials there are when a name is unknown, or when all of them are bare; names a broken image whose colour
/// the fur should have.
pub fn select(parts: &[Part], names: &[String]) -> Result<Selection> {
    let mut selection = choose(parts, names)?;
    for (index, part) in parts.iter().enumerate() {
        let Some(fault) = &part.base_colour.fault else { continue };
        if selection.parts.contains(&index) {
            return Err(Error::clone(fault));
        }
        let place = fault.field.as_deref().unwrap_or_default();
        let warning = format!(
            "{}: {place}, of material {:?}; its base colour factor is used alone, as it gets no fur",
            fault.what, part.material_name
        );
        if !selection.warnings.contains(&warning) {
            selection.warnings.push(warning);
        }
    }
    Ok(selection)
}

fn choose(parts: &[Part], names: &[String]) -> Result<Selection> {
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
    if !names.is_empty() {
        let named = (0..parts.len()).filter(|&i| names.contains(&parts[i].material_name)).collect();
        return Ok(Selection { parts: named, ..Selection::default() });
    }
    let by_material: Vec<Option<Bare>> =
        parts.iter().map(|part| bare_word(&part.material_name).map(Bare::Word)).collect();
    // Each further reason counts only where it leaves something.
    let mut reasons = by_material;
    for also in [by_mesh as fn(&Part) -> Option<Bare>, by_alpha] {
        let more: Vec<Option<Bare>> =
            parts.iter().zip(&reasons).map(|(part, reason)| reason.clone().or_else(|| also(part))).collect();
        if more.iter().any(Option::is_none) {
            reasons = more;
        }
    }
    let chosen: Vec<usize> = (0..parts.len()).filter(|&i| reasons[i].is_none()).collect();
    if chosen.is_empty() {
        return Err(Error::usage("by their names, all materials are bare")
            .with_parameter("material")
            .with_expected(known())
            .with_hint("name the material to fur with `material`"));
    }
    Ok(Selection { note: note(parts, &chosen, &reasons), parts: chosen, warnings: Vec::new() })
}

/// By the name of its mesh or of a node that shows it, where all of the mesh has that name.
fn by_mesh(part: &Part) -> Option<Bare> {
    part.labels.iter().find_map(|label| bare_word(label)).map(Bare::Word)
}

fn by_alpha(part: &Part) -> Option<Bare> {
    match part.alpha {
        Alpha::Opaque => None,
        Alpha::Blend => Some(Bare::Transparent),
        Alpha::Mask => (share_of_border(part) >= CARDS).then_some(Bare::Cards),
    }
}

/// Share of its edges that only one triangle has.
fn share_of_border(part: &Part) -> f64 {
    let mut uses: HashMap<(u32, u32), u32> = HashMap::new();
    for triangle in &part.stored.triangles {
        let [a, b, c] = triangle.map(|v| part.stored.position_class[v as usize]);
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *uses.entry((from.min(to), from.max(to))).or_default() += 1;
        }
    }
    uses.values().filter(|&&count| count == 1).count() as f64 / uses.len().max(1) as f64
}

/// What was chosen and why.
fn note(parts: &[Part], chosen: &[usize], reasons: &[Option<Bare>]) -> Option<String> {
    let mut left: BTreeMap<&Bare, Vec<&str>> = BTreeMap::new();
    for (part, reason) in parts.iter().zip(reasons) {
        if let Some(reason) = reason {
            let names = left.entry(reason).or_default();
            let name = part.material_name.as_str();
            if !names.contains(&name) {
                names.push(name);
            }
        }
    }
    if left.is_empty() {
        return None;
    }
    let mut furred: Vec<&str> = chosen.iter().map(|&i| parts[i].material_name.as_str()).collect();
    furred.dedup();
    let told = |(reason, names): (&&Bare, &Vec<&str>)| {
        let why = match reason {
            Bare::Word(word) => format!("by the name, {word:?}"),
            Bare::Transparent => "as light shines through (alphaMode BLEND)".to_owned(),
            Bare::Cards => "as cards cut out by alpha (alphaMode MASK)".to_owned(),
        };
        format!("{} {why}", names.join(", "))
    };
    let left: Vec<String> = left.iter().map(told).collect();
    Some(format!("fur on {}; left out: {}; `material` chooses otherwise", furred.join(", "), left.join("; ")))
}
