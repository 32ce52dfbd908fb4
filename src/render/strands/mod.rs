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
    /// Radiance of the opaque hair, linear RGB.
    pub radiance: Vec3,
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
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fragment {
    /// Depth along the optical axis, m.
    pub z_m: f32,
    /// Source index of the hair.
    pub id: u32,
    /// Covered share of the pixel, in (0, 1].
    pub coverage: f32,
    /// First knot of the piece.
    pub knot: u32,
    /// Where along the piece, in [0, 1].
    pub along: f32,
}
