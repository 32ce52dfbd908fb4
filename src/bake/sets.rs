//! Which parts are one skin to be laid out, and which are measured.

use crate::asset::Asset;
use std::collections::BTreeMap;

/// Those of `parts` that are of the finest level of detail among them.
pub(super) fn finest(asset: &Asset, parts: &[usize]) -> Vec<usize> {
    let level = |part: &usize| asset.parts[*part].level;
    let least = parts.iter().map(level).min();
    parts.iter().copied().filter(|part| Some(level(part)) == least).collect()
}

/// `parts` as they are laid out together: levels of detail each by itself, the finest first, or every part `alone`.
pub(super) fn laid_out_together(asset: &Asset, parts: &[usize], alone: bool) -> Vec<Vec<usize>> {
    if alone {
        return parts.iter().map(|&part| vec![part]).collect();
    }
    let mut levels: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    parts.iter().for_each(|&part| levels.entry(asset.parts[part].level).or_default().push(part));
    levels.into_values().collect()
}
