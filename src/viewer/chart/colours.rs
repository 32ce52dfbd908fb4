//! Colours that mean something, linear RGB.

use crate::math::Vec3;

/// Twelve colours that the eye tells apart, light enough for shading; linear RGB.
pub(super) const DISTINCT: [Vec3; 12] = [
    Vec3::new(0.72, 0.15, 0.10),
    Vec3::new(0.10, 0.36, 0.68),
    Vec3::new(0.78, 0.58, 0.08),
    Vec3::new(0.12, 0.45, 0.16),
    Vec3::new(0.47, 0.17, 0.56),
    Vec3::new(0.10, 0.55, 0.55),
    Vec3::new(0.80, 0.32, 0.05),
    Vec3::new(0.70, 0.32, 0.48),
    Vec3::new(0.42, 0.58, 0.12),
    Vec3::new(0.30, 0.32, 0.75),
    Vec3::new(0.42, 0.25, 0.12),
    Vec3::new(0.55, 0.58, 0.62),
];
/// Least and most of a length: cream to teal.
pub(super) const LENGTHS: [Vec3; 2] = [Vec3::new(0.85, 0.80, 0.62), Vec3::new(0.05, 0.36, 0.40)];
/// Strokes along the hair.
pub(super) const INK: Vec3 = Vec3::new(0.012, 0.012, 0.03);
/// Where the field turns round itself with its turn, as at a crown.
pub(super) const CROWN: Vec3 = Vec3::new(0.80, 0.03, 0.02);
/// Where it turns against it, as at a saddle.
pub(super) const SADDLE: Vec3 = Vec3::new(0.03, 0.10, 0.80);
/// Beyond the range that a diverging map shows.
pub(super) const BEYOND: Vec3 = Vec3::new(0.75, 0.65, 0.02);

/// Blue at −1, white at 0, red at 1.
pub(super) fn diverging(t: f32) -> Vec3 {
    const ENDS: [Vec3; 2] = [Vec3::new(0.02, 0.12, 0.55), Vec3::new(0.60, 0.02, 0.04)];
    let white = Vec3::splat(0.82);
    white.lerp(ENDS[usize::from(t > 0.0)], t.abs().min(1.0))
}
