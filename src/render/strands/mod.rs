//! Guard hair as camera-facing ribbons, with sub-pixel coverage (`docs/steps/strands.md`).
//!
//! A piece of a strand between two points becomes a ribbon; each pixel it touches gets a fragment whose opacity is the
//! covered share of the pixel's area times the hair's own opacity. A hair thinner than a pixel loses opacity, not
//! existence.

pub mod project;
pub mod ribbon;
pub mod shade;

use crate::math::Vec3;

/// What a guard hair sends towards the eye, at one of its points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Look {
    /// Logarithm of the opaque hair's radiance, linear RGB: shadow, and radiance with it, goes exponentially from point to
    /// point.
    pub log_radiance: Vec3,
    /// Diffuse colour.
    pub albedo: Vec3,
}

/// A point of a strand on the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Knot {
    /// Pixel coordinates.
    pub x: f32,
    /// Pixel coordinates.
    pub y: f32,
    /// Depth along the optical axis, m; at or below the near plane where the point is not in front of the eye.
    pub z_m: f32,
    /// Half of the hair's width, px.
    pub half_px: f32,
}

/// A share of a pixel that a hair covers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fragment {
    /// Depth's bits, then the hair's id: positive floats are ordered as their bits.
    order: u64,
    /// Covered share of the pixel, in (0, 1].
    pub coverage: f32,
    /// The hair's own opacity there, in [0, 1].
    pub opacity: f32,
    /// First knot of the piece.
    pub knot: u32,
    /// Where along the piece, in [0, 1].
    pub along: f32,
}

impl Fragment {
    /// Of hair `id` at depth `z_m` > 0 along the optical axis, `along` the piece that begins at `knot`.
    #[inline(always)]
    pub fn new(z_m: f32, id: u32, [coverage, opacity]: [f32; 2], knot: u32, along: f32) -> Self {
        Self { order: u64::from(z_m.to_bits()) << 32 | u64::from(id), coverage, opacity, knot, along }
    }

    /// What it hides of the pixel.
    #[inline(always)]
    pub fn alpha(&self) -> f32 {
        self.coverage * self.opacity
    }

    /// Depth along the optical axis, m.
    #[inline(always)]
    pub fn z_m(&self) -> f32 {
        f32::from_bits((self.order >> 32) as u32)
    }

    /// Source index of the hair.
    #[inline(always)]
    pub fn id(&self) -> u32 {
        self.order as u32
    }

    /// Sorts by depth, then id, then piece.
    #[inline(always)]
    pub fn order(&self) -> (u64, u32) {
        (self.order, self.knot)
    }
}
