//! The fin texture: a slab of the tile's hair seen along the skin (Lengyel et al. 2001 §2.2).

pub mod edges;
pub mod texture;

use crate::error::{Error, Result};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How the fin texture is sampled.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FinParameters {
    /// Texels along the edge: a power of two in 16 … 4096 (Lengyel et al. 2001: 512).
    pub texture_width: u32,
    /// Texels along the hair: a power of two in 16 … 1024 (Lengyel et al. 2001: 64).
    pub texture_height: u32,
    /// Thickness of the composited slab, mm.
    pub thickness_mm: f32,
}

impl Default for FinParameters {
    fn default() -> Self {
        Self { texture_width: 512, texture_height: 64, thickness_mm: 2.0 }
    }
}

impl FinParameters {
    /// Checks ranges.
    ///
    /// # Errors
    /// Names the parameter out of range.
    pub fn check(&self) -> Result<()> {
        let fault = |field: &str, found: String, expected: &str| {
            Err(Error::usage("a fin parameter is out of range")
                .with_field(field)
                .with_found(found)
                .with_expected(expected))
        };
        if !(16..=4096).contains(&self.texture_width) || !self.texture_width.is_power_of_two() {
            return fault("fins.texture_width", self.texture_width.to_string(), "a power of two from 16 to 4096");
        }
        if !(16..=1024).contains(&self.texture_height) || !self.texture_height.is_power_of_two() {
            return fault("fins.texture_height", self.texture_height.to_string(), "a power of two from 16 to 1024");
        }
        if !(1e-3..=1e4).contains(&self.thickness_mm) {
            return fault("fins.thickness_mm", self.thickness_mm.to_string(), "a number from 0.001 to 10000");
        }
        Ok(())
    }
}
