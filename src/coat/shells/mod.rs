//! Shell textures: a tile of hair in slabs, as the law of `docs/steps/shells.md` needs them.

pub mod above;
pub mod deposit;
pub mod encode;
pub mod ends;
pub mod gains;
pub mod heights;
pub mod undercoat;

use crate::error::{Error, Result};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How a tile is cut and sampled.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ShellParameters {
    /// Layers, the opaque skin included, in 2 … 256 (Lengyel et al. 2001: 16).
    pub layers: u32,
    /// Texels along a tile's edge: a power of two in 16 … 2048 (Lengyel et al. 2001: 128).
    pub texture_size: u32,
    /// Edge of the tile, mm.
    pub tile_mm: f32,
}

impl Default for ShellParameters {
    fn default() -> Self {
        Self { layers: 16, texture_size: 128, tile_mm: 12.0 }
    }
}

impl ShellParameters {
    /// Checks ranges.
    ///
    /// # Errors
    /// Names the parameter out of range.
    pub fn check(&self) -> Result<()> {
        let fault = |field: &str, found: String, expected: &str| {
            Err(Error::usage("a shell parameter is out of range")
                .with_field(field)
                .with_found(found)
                .with_expected(expected))
        };
        if !(2..=256).contains(&self.layers) {
            return fault("shells.layers", self.layers.to_string(), "a whole number from 2 to 256");
        }
        if !(16..=2048).contains(&self.texture_size) || !self.texture_size.is_power_of_two() {
            return fault("shells.texture_size", self.texture_size.to_string(), "a power of two from 16 to 2048");
        }
        if !(0.1..=10_000.0).contains(&self.tile_mm) {
            return fault("shells.tile_mm", self.tile_mm.to_string(), "a number from 0.1 to 10000");
        }
        Ok(())
    }
}
