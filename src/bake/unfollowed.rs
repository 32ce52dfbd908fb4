//! What changes the colour of furred skin and not that of the fur on it.

use crate::asset::material::BaseColour;
use crate::asset::{Asset, Part};
use crate::data::image::{srgb_from_linear, unorm8};
use std::collections::BTreeMap;

/// Material variants, one sentence for each material.
pub(super) fn variants(asset: &Asset, chosen: &[usize]) -> Vec<String> {
    let mut told: Vec<String> = Vec::new();
    for part in chosen.iter().map(|&i| &asset.parts[i]) {
        if let Some(sentence) = of(part).filter(|sentence| !told.contains(sentence)) {
            told.push(sentence);
        }
    }
    told
}

fn of(part: &Part) -> Option<String> {
    let mut others: BTreeMap<(&str, String), Vec<&str>> = BTreeMap::new();
    for variant in &part.variants {
        others.entry((&variant.material, shown(&variant.colour))).or_default().push(&variant.name);
    }
    let other = |((material, colour), names): (&(&str, String), &Vec<&str>)| {
        format!("{material:?}, {colour}, in {}", names.join(", "))
    };
    let others: Vec<String> = others.iter().map(other).collect();
    (!others.is_empty()).then(|| {
        format!(
            "fur keeps the colour of material {:?}, {}, in all material variants; its skin is {}",
            part.material_name,
            shown(&part.base_colour),
            others.join("; ")
        )
    })
}

/// A colour as people write it.
fn shown(colour: &BaseColour) -> String {
    let [r, g, b] = colour.factor.truncate().to_array().map(|c| unorm8(srgb_from_linear(c.clamp(0.0, 1.0))));
    let factor = format!("#{r:02x}{g:02x}{b:02x}");
    match &colour.texture {
        Some(texture) if (r, g, b) == (255, 255, 255) => format!("that of images[{}]", texture.image),
        Some(texture) => format!("that of images[{}] times {factor}", texture.image),
        None => factor,
    }
}
