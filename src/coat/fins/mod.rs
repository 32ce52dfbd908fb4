//! The fin texture: a slab of the tile's hair seen along the skin (Lengyel et al. 2001 §2.2).

pub mod edges;
pub mod texture;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How the fin texture is sampled.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FinParameters {
    /// Texels along the edge (Lengyel et al. 2001: 512).
    #[schemars(range(min = 16, max = 4096), extend("powerOfTwo" = true))]
    pub texture_width: u32,
    /// Texels along the hair (Lengyel et al. 2001: 64).
    #[schemars(range(min = 16, max = 1024), extend("powerOfTwo" = true))]
    pub texture_height: u32,
    /// Thickness of the composited slab, mm.
    #[schemars(range(min = 1e-3, max = 1e4))]
    pub thickness_mm: f32,
}

impl Default for FinParameters {
    fn default() -> Self {
        Self { texture_width: 512, texture_height: 64, thickness_mm: 2.0 }
    }
}
