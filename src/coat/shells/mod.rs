//! Shell textures: a tile of hair in slabs, as the law of `docs/steps/shells.md` needs them.

pub mod above;
pub mod deposit;
pub mod encode;
pub mod ends;
pub mod gains;
pub mod heights;
pub mod undercoat;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How a tile is cut and sampled.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ShellParameters {
    /// Layers, the opaque skin included (Lengyel et al. 2001: 16). Three more or less change the error by 0.002 of FLIP.
    #[schemars(range(min = 2, max = 256))]
    pub layers: u32,
    /// Texels along a tile's edge (Lengyel et al. 2001: 128).
    #[schemars(range(min = 16, max = 2048), extend("powerOfTwo" = true))]
    pub texture_size: u32,
    /// Edge of the tile, mm.
    #[schemars(range(min = 0.1, max = 10000.0))]
    pub tile_mm: f32,
}

impl Default for ShellParameters {
    fn default() -> Self {
        Self { layers: 13, texture_size: 128, tile_mm: 12.0 }
    }
}
