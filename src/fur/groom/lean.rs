//! The mean direction of hair, from comb and gravity.

use super::Groom;
use crate::math::Vec3;

/// Least angle between hair and skin, as its sine: a shell whose offset lies in the skin would have no height.
const LEAST_RISE: f32 = 0.17;

/// Root to tip of the mean hair, unit: leaned along the comb, pulled to the ground, never into the skin.
pub(super) fn lean(groom: &Groom, normal: Vec3, comb: Vec3) -> Vec3 {
    let (sin, cos) = libm::sincosf(groom.lean_deg.to_radians());
    let combed = if comb == Vec3::ZERO { normal } else { normal * cos + comb * sin };
    let pulled = (combed + Vec3::NEG_Y * groom.gravity).normalize_or(normal);
    raised(pulled, normal)
}

/// A lean turned up to the least angle with the skin.
pub(super) fn raised(lean: Vec3, normal: Vec3) -> Vec3 {
    let rise = lean.dot(normal);
    if rise >= LEAST_RISE {
        return lean;
    }
    let flat = (lean - normal * rise).normalize_or_zero();
    flat * (1.0 - LEAST_RISE * LEAST_RISE).sqrt() + normal * LEAST_RISE
}
