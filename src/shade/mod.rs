//! Floor 2: how a hair scatters light. Formulas stand once, generic over f32 and f64 (`docs/steps/shade.md`).
//!
//! All scattering functions S are of the form L(ω_o) = ∫ S(ω_i, ω_o) L(ω_i) cos θ_i dω_i over the whole sphere (Marschner
//! et al. 2003), θ being the inclination to the plane at a right angle to the hair. A hair under uniform light of radiance 1
//! then sends back ∫ S cos θ_i dω_i, which is its albedo and must not pass 1.

pub mod fibre;
pub mod law;
mod real;

pub use real::Real;

use crate::math::DVec3;
use crate::math::lanes::{F32s, Isa, Vec3s};

/// Where light comes from and goes to, relative to a hair. Both directions point away from the hair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Angles<R> {
    /// sin θ_i: towards the light, along the hair.
    pub sin_in: R,
    /// sin θ_o: towards the eye, along the hair.
    pub sin_out: R,
    /// Cosine of the difference in azimuth, 1 where light comes from the eye's side.
    pub cos_azimuth: R,
}

impl<R: Real> Angles<R> {
    /// From the three cosines between unit vectors: hair and light, hair and eye, light and eye.
    #[inline(always)]
    pub fn new(hair_light: R, hair_eye: R, light_eye: R) -> Self {
        let one = R::of(1.0);
        let (sin_in, sin_out) = (cosine(hair_light), cosine(hair_eye));
        let across = ((one - sin_in * sin_in) * (one - sin_out * sin_out)).max(R::of(0.0)).sqrt();
        let cos_azimuth =
            across.above(R::of(1e-6), cosine((light_eye - sin_in * sin_out) / across.max(R::of(1e-6))), R::of(0.0));
        Self { sin_in, sin_out, cos_azimuth }
    }

    /// cos θ_i, never negative.
    #[inline(always)]
    pub fn cos_in(self) -> R {
        (R::of(1.0) - self.sin_in * self.sin_in).max(R::of(0.0)).sqrt()
    }

    /// cos θ_o, never negative.
    #[inline(always)]
    pub fn cos_out(self) -> R {
        (R::of(1.0) - self.sin_out * self.sin_out).max(R::of(0.0)).sqrt()
    }
}

impl<I: Isa> Angles<F32s<I>> {
    /// From unit vectors: the hair's direction, towards the light, towards the eye.
    #[inline(always)]
    pub fn of_lanes(hair: Vec3s<I>, to_light: Vec3s<I>, to_eye: Vec3s<I>) -> Self {
        Self::new(hair.dot(to_light), hair.dot(to_eye), to_light.dot(to_eye))
    }
}

impl Angles<f64> {
    /// From unit vectors: the hair's direction, towards the light, towards the eye.
    pub fn of_dvectors(hair: DVec3, to_light: DVec3, to_eye: DVec3) -> Self {
        Self::new(hair.dot(to_light), hair.dot(to_eye), to_light.dot(to_eye))
    }
}

/// Within [−1, 1].
#[inline(always)]
fn cosine<R: Real>(x: R) -> R {
    x.max(R::of(-1.0)).min(R::of(1.0))
}
