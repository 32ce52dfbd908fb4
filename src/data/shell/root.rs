//! What hair at a pixel has of the coat there, as its root and the skin's facets say.

use super::guards::APART;

/// What of a slab of the stack hair fills that is shorter than the coat's offset: the tile is squeezed to a share of the stack, and
/// ends there (`docs/extension/README.md`, "What is painted at the root").
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filled {
    /// Layer of the tile in the middle of what is filled.
    pub layer: u32,
    /// Thickness of what is filled, m of the squeezed tile.
    pub slab_m: f32,
    /// The same in slabs of the tile; 0 where there is no hair.
    pub slabs: f32,
}

impl Filled {
    /// Of slab `layer` of a stack of `layers`, the skin counted, that is `height_m` high, where hair has the share `share` in [0, 1] of
    /// its offset.
    pub fn new(layer: u32, share: f32, layers: u32, height_m: f32) -> Self {
        let slabs = layers as f32 - 1.0;
        let bottom = layer as f32 - 1.0;
        let filled = (share * slabs - bottom).clamp(0.0, 1.0) / share.max(1e-6);
        let middle = bottom / share.max(1e-6) + 0.5 * filled;
        let layer = (middle.floor() + 1.0).clamp(1.0, slabs) as u32;
        Self { layer, slab_m: filled * height_m / slabs, slabs: filled }
    }
}

/// How far fins stand for the hair around them, in [0, 1], and smooth normals for facets: as far as edges stand closer than hair is
/// long. `spacing_m` is the skin's area per length of edges, which is the thickness of the slab that a fin holds.
pub fn closeness(hair_m: f32, spacing_m: f32) -> f32 {
    (hair_m / (APART * spacing_m).max(1e-20)).min(1.0)
}
