//! A line from which hair falls away to both sides.

use crate::math::Vec3;
use serde::Serialize;

/// A parting. Lengths and places are in the mesh's rest pose, m.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Parting {
    /// The line, on or near the skin.
    pub line_m: Vec<Vec3>,
    /// How far to either side hair falls away from it.
    pub reach_m: f32,
    /// Width of the strip along the line in which no hair grows.
    pub width_m: f32,
    /// Angle between the hair and the way straight off the line, rad: π/2 for hair that lies along it.
    pub angle_rad: f32,
}

/// Where a place of the skin lies beside a parting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aside {
    /// Along the skin from the line to the place, m.
    pub off_m: Vec3,
    /// The line's direction along the skin; it has no length where the line meets the skin upright.
    pub along: Vec3,
}

impl Parting {
    /// Where the place `p_m` of a skin with the normal `normal` lies; `None` beyond the reach and beyond the line's ends.
    ///
    /// The line may hang over the skin or run below it: what of the distance is upright does not count as sideways.
    pub fn aside(&self, p_m: Vec3, normal: Vec3) -> Option<Aside> {
        let last = self.line_m.len().checked_sub(2)?;
        let step = |(i, ends): (usize, &[Vec3])| {
            let along = ends[1] - ends[0];
            let t = (p_m - ends[0]).dot(along) / along.length_squared().max(f32::MIN_POSITIVE);
            let beyond = (i == 0 && t < 0.0) || (i == last && t > 1.0);
            (p_m - ends[0] - along * t.clamp(0.0, 1.0), along, beyond)
        };
        let nearest = self.line_m.windows(2).enumerate().map(step);
        let (off, along, beyond) = nearest.min_by(|a, b| a.0.length_squared().total_cmp(&b.0.length_squared()))?;
        let flat = |v: Vec3| v - normal * normal.dot(v);
        (!beyond && off.length() < self.reach_m)
            .then(|| Aside { off_m: flat(off), along: flat(along).normalize_or_zero() })
    }

    /// Density of hair at a place over what it were without the parting, where the strip's hair stands beside it: each as far
    /// from the strip's border as it was inside.
    pub fn density(&self, p_m: Vec3, normal: Vec3) -> f32 {
        match self.aside(p_m, normal).map(|aside| aside.off_m.length()) {
            Some(off_m) if off_m < 0.5 * self.width_m => 0.0,
            Some(off_m) if off_m < self.width_m => 2.0,
            _ => 1.0,
        }
    }
}
