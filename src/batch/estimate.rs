//! What a bake will cost, told beforehand: good enough to begin with the longest and to keep memory in bounds (`docs/steps/batch.md`).

use crate::asset::glimpse::glimpse;
use crate::bake::Method;
use crate::bake::recipe::Recipe;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Time and memory of one bake.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Cost {
    /// On one thread, s.
    pub seconds: f64,
    /// Memory at its most, bytes.
    pub bytes: u64,
}

/// A tile of 16 layers of 128 by 128 texels, s.
const TILE_S: f64 = 2.8;
/// A triangle of the skin, s.
const TRIANGLE_S: f64 = 30e-6;
/// What a bake holds of every texel of a layer, bytes.
const TEXEL_BYTES: f64 = 64.0;
/// What a bake holds of every triangle, bytes.
const TRIANGLE_BYTES: f64 = 2200.0;
/// What a bake holds of every byte of its input: files are read whole, and pictures are taken along.
const INPUT_BYTES: f64 = 4.0;
/// What every bake holds beside, bytes.
const BASE_BYTES: f64 = 48e6;

impl Cost {
    /// Of baking `input` by `recipe`. An input that cannot be read costs next to nothing.
    pub fn of(input: &Path, recipe: &Recipe) -> Self {
        let seen = glimpse(input);
        let files = std::iter::once(input).chain(seen.references.iter().map(|path| path.as_path()));
        let input_bytes: u64 = files.filter_map(|file| std::fs::metadata(file).ok()).map(|about| about.len()).sum();
        let texels: f64 = recipe
            .all_presets()
            .map(|preset| {
                let edge = match recipe.method {
                    Method::Atlas { texels } => texels.unwrap_or(4 * preset.shells.texture_size),
                    Method::Lapped | Method::Uv(_) => preset.shells.texture_size,
                };
                let tiles = 1 + preset.regions.len() as u32;
                f64::from(edge) * f64::from(edge) * f64::from(preset.shells.layers * tiles)
            })
            .sum();
        let triangles = seen.triangles.min(1 << 32) as f64;
        Self {
            seconds: 0.02 + TILE_S * texels / (16.0 * 128.0 * 128.0) + TRIANGLE_S * triangles,
            bytes: (BASE_BYTES + TEXEL_BYTES * texels + TRIANGLE_BYTES * triangles + INPUT_BYTES * input_bytes as f64)
                as u64,
        }
    }
}

/// Memory that a batch may take where nothing is said: three quarters of what is free, bytes; none where the system does not tell.
pub fn memory_bytes() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024 / 4 * 3)
}
