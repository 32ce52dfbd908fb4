//! A row or column of a pixel, as the eye sees it.

use super::bvh::DRay;
use super::cone;
use crate::math::DVec3;

/// Directions base + x·step, x in [0, 1], from one eye.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    /// The eye, m.
    pub eye_m: DVec3,
    /// Direction at its beginning.
    pub base: DVec3,
    /// From beginning to end.
    pub step: DVec3,
}

impl Line {
    /// The ray at `x`.
    pub fn ray(&self, x: f64) -> DRay {
        DRay::new(self.eye_m, (self.base + self.step * x).normalize())
    }

    /// Where it begins and ceases to meet a round cone.
    pub fn extent(&self, from_m: DVec3, to_m: DVec3, radius_m: [f64; 2]) -> Option<[f64; 2]> {
        cone::extent(from_m - self.eye_m, to_m - self.eye_m, radius_m, self.base, self.step)
    }
}
