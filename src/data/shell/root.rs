//! What hair at a pixel has of the coat there, as its root and the skin's facets say.

use super::guards::APART;
use crate::data::slabs::Slabs;

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
    /// Of layer `layer` of a stack of `slabs` that is `height_m` high, where hair has the share `share` in [0, 1] of
    /// its offset.
    pub fn new(layer: u32, share: f32, slabs: &Slabs, height_m: f32) -> Self {
        let [bottom, top] = slabs.span(layer as usize - 1).map(|height| height / share.max(1e-6));
        let top = top.min(slabs.tops()[slabs.count()]);
        let filled = (top - bottom).max(0.0);
        let own = slabs.at(0.5 * (bottom + top)).max(layer as usize - 1);
        Self { layer: own as u32 + 1, slab_m: filled * height_m, slabs: filled / slabs.thickness(own) }
    }
}

/// How far fins stand for the hair around them, in [0, 1], and smooth normals for facets: as far as edges stand closer than hair is
/// long. `spacing_m` is the skin's area per length of edges, which is the thickness of the slab that a fin holds.
pub fn closeness(hair_m: f32, spacing_m: f32) -> f32 {
    (hair_m / (APART * spacing_m).max(1e-20)).min(1.0)
}
