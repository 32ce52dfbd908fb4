//! The law of a shell stack: what a stored texel means, how opaque a slab is along a ray, and how it is fetched, as a
//! fragment shader does at one pixel. `docs/extension/README.md` specifies it; `shaders/shared/coat.wgsl` is its twin.
//!
//! A tile lies sheared on the skin: a point (x, y, z) of the tile sits at x·X + y·Y + z·O of the skin's frame, where X and Y are
//! unit tangents and O is the coat's offset over the stack's height. Hair keeps its diameter under that map, so the
//! medium changes with it (`docs/steps/shells.md`). X is the skin's own direction, whichever way the texture lies there:
//! where a patch is stretched or turned, its picture is, and not the medium.

pub mod guards;
mod incidence;
mod root;
mod stack;
mod texel;

pub use super::slabs::Slabs;
pub use incidence::Incidence;
pub use root::{Filled, closeness};
pub use stack::Stack;
pub use texel::{
    HairMedium, MOST_ABOVE, Texel, above_of, above_of_transmittance, code_above, depth_of_byte, depth_of_opacity,
    signed, unorm,
};

use super::coat::GAIN_ANGLES_DEG;

/// The gain at `theta_deg`, linear between the stored angles.
pub fn gain_at(gains: &[f32; 9], theta_deg: f32) -> f32 {
    let i = GAIN_ANGLES_DEG.partition_point(|&a| a <= theta_deg).clamp(1, 8);
    let (low, high) = (GAIN_ANGLES_DEG[i - 1], GAIN_ANGLES_DEG[i]);
    let t = ((theta_deg - low) / (high - low)).clamp(0.0, 1.0);
    gains[i - 1] + (gains[i] - gains[i - 1]) * t
}

/// Optical depth of one slab of height `slab_m` (in the tile), without gain.
pub fn slab_optical_depth(texel: &Texel, seen: &Incidence, slab_m: f32) -> f32 {
    let ends = depth_of_opacity(texel.ends) * seen.share_of_ends();
    texel.medium.lateral(seen) * slab_m / seen.in_tile().z.abs() + ends
}
