//! Rays, and the part of them that counts.

use crate::math::Vec3;

/// A half line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts, m.
    pub origin_m: Vec3,
    /// Unit vector.
    pub direction: Vec3,
}

/// The part of each ray that counts, m from its origin. Hair is cut at its ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthRange {
    /// Begin.
    pub near_m: f32,
    /// End.
    pub far_m: f32,
}

impl DepthRange {
    /// All of the ray.
    pub const ALL: Self = Self { near_m: 0.0, far_m: f32::INFINITY };
}
