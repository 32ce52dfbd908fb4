//! What a hair does with light that meets it, behind one door: fibres are plugged in here.

use crate::math::DVec3;

/// Where a ray meets a hair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meeting {
    /// Direction of the hair from root to tip, unit.
    pub hair: DVec3,
    /// How far the ray passes beside the hair's axis, in radii, −1 to 1: sin γ, where γ is the angle from the normal to the way
    /// back to the eye, both seen along the hair, right-handed about `hair`.
    pub across: f64,
    /// Normal of the hair's surface there, unit, at a right angle to the hair.
    pub normal: DVec3,
}

impl Meeting {
    /// Of a ray from `to_eye` with a hair whose surface has this normal, in about.
    pub fn new(hair: DVec3, normal: DVec3, to_eye: DVec3) -> Self {
        let level = |v: DVec3| (v - hair * v.dot(hair)).normalize_or_zero();
        let (normal, eye) = (level(normal), level(to_eye));
        Self { hair, across: hair.dot(normal.cross(eye)).clamp(-1.0, 1.0), normal }
    }

    /// Of a ray from `to_eye` that passes beside the axis by `across` radii.
    pub fn beside(hair: DVec3, across: f64, to_eye: DVec3) -> Self {
        let level = to_eye - hair * to_eye.dot(hair);
        let eye = level.try_normalize().unwrap_or_else(|| hair.any_orthonormal_vector());
        let normal = eye * (1.0 - across * across).max(0.0).sqrt() - hair.cross(eye) * across;
        Self { hair, across, normal }
    }
}

/// How hair scatters. All of a hair's scattering happens where a ray meets it: light that passes through leaves there too.
pub trait Scatter: Sync {
    /// Radiance sent towards `to_eye` per radiance and solid angle of light from `to_light`, per channel, for hair of these colour
    /// parameters: S cos θ_i of a far-field fibre, f |cos| of a near-field one. 1/sr.
    fn scatter(&self, at: &Meeting, to_eye: DVec3, to_light: DVec3, colour: DVec3) -> DVec3;

    /// A direction towards light, unit, and how densely such directions lie there, 1/sr. A density of 0 means none: the share of
    /// light for which there would have been a direction is lost, which an honest `sample` has counted into its other densities.
    fn sample(&self, at: &Meeting, to_eye: DVec3, colour: DVec3, random: [f64; 4]) -> (DVec3, f64);
}
