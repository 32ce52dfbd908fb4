//! How lobes are spread around the hair: N(φ) with ∫ N dφ = 1, from cos φ alone.

use super::LOBES;
use crate::shade::Real;
use bytemuck::{Pod, Zeroable};
use serde::{Deserialize, Serialize};
use std::f64::consts::{PI, TAU};

/// Profiles of the four lobes.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable, Serialize, Deserialize)]
pub struct Azimuth {
    /// Reflectance at a right angle of the surface lobe, by Schlick's form of Fresnel's law: a smooth cylinder mirrors cos(φ/2) of
    /// the light, met at the angle φ/2. At 1 the cosine alone is left.
    pub mirror: f32,
    /// What makes the surface lobe's integral 1.
    pub mirror_norm: f32,
    /// Concentration of what goes straight through, about φ = π (von Mises).
    pub through: f32,
    /// Its norm.
    pub through_norm: f32,
    /// Of what is once reflected inside: factor of cos(φ/2).
    pub inner_cosine: f32,
    /// The same all around.
    pub inner_even: f32,
    /// Factor of each of the two glints (von Mises).
    pub glint: f32,
    /// Their concentration.
    pub glint_sharpness: f32,
    /// Cosine of the angle where they stand.
    pub glint_cos: f32,
    /// Sine of the angle where they stand.
    pub glint_sin: f32,
    /// Of what the medulla scatters: factors of 1, cos φ, cos² φ.
    pub medulla: [f32; 3],
}

/// A von Mises distribution's norm times e^κ: what exp(κ (cos φ − 1)) is multiplied by.
fn von_mises_norm(sharpness: f64) -> f64 {
    1.0 / (2.0 * integral(|phi| libm::exp(sharpness * (libm::cos(phi) - 1.0))))
}

/// Over [0, π].
fn integral(f: impl Fn(f64) -> f64) -> f64 {
    const STEPS: usize = 2048;
    let step = PI / STEPS as f64;
    (0..STEPS).map(|i| f((i as f64 + 0.5) * step)).sum::<f64>() * step
}

/// What an artist's or a simulation's numbers say of the lobes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Around {
    /// Reflectance at a right angle, or 1.
    pub mirror: f64,
    /// Concentration of what goes straight through.
    pub through: f64,
    /// Shares of what is reflected inside: along cos(φ/2), all around; the glints have the rest.
    pub inner: [f64; 2],
    /// Concentration of the glints.
    pub glint_sharpness: f64,
    /// Where they stand, rad.
    pub glint_rad: f64,
    /// Means of cos φ and cos² φ of what the medulla scatters.
    pub medulla: [f64; 2],
}

impl Azimuth {
    pub(super) fn new(around: &Around) -> Self {
        let r0 = around.mirror;
        let norm = 2.0 * integral(|phi| mirrored(r0, libm::cos(0.5 * phi)));
        let [cosine, even] = around.inner;
        // From the means: N = (a₀ + a₁ cos φ + a₂ cos² φ)/2π, nowhere negative.
        let [mean, square] = around.medulla;
        let a2 = (8.0 * (square - 0.5)).clamp(-0.5, 1.0);
        let a0 = 1.0 - 0.5 * a2;
        let most = if a2 > 0.0 && a0 > a2 { 2.0 * (a0 * a2).sqrt() } else { 0.0 };
        let a1 = (2.0 * mean).clamp(-(a0 + a2).max(most), (a0 + a2).max(most));
        let glint = 0.5 * (1.0 - cosine - even) * von_mises_norm(around.glint_sharpness);
        Self {
            mirror: r0 as f32,
            mirror_norm: (1.0 / norm) as f32,
            through: around.through as f32,
            through_norm: von_mises_norm(around.through) as f32,
            inner_cosine: (0.25 * cosine) as f32,
            inner_even: (even / TAU) as f32,
            glint: glint as f32,
            glint_sharpness: around.glint_sharpness as f32,
            glint_cos: libm::cos(around.glint_rad) as f32,
            glint_sin: libm::sin(around.glint_rad) as f32,
            medulla: [a0, a1, a2].map(|a| (a / TAU) as f32),
        }
    }
}

/// cos(φ/2) times Schlick's reflectance there.
fn mirrored(r0: f64, cosine: f64) -> f64 {
    cosine * (r0 + (1.0 - r0) * libm::pow(1.0 - cosine, 5.0))
}

impl Azimuth {
    /// N of each lobe, 1/rad.
    #[inline(always)]
    pub fn at<R: Real>(&self, cos_azimuth: R) -> [R; LOBES] {
        let one = R::of(1.0);
        let zero = R::of(0.0);
        let u = cos_azimuth;
        let half = (R::of(0.5) * (one + u)).max(zero).sqrt();
        let lost = one - half;
        let lost2 = lost * lost;
        let mirror = R::of32(self.mirror);
        let surface = R::of32(self.mirror_norm) * half * (mirror + (one - mirror) * lost2 * lost2 * lost);
        let through = R::of32(self.through_norm) * (-(R::of32(self.through) * (one + u).max(zero))).exp();
        let sine = (one - u * u).max(zero).sqrt();
        let (along, across) = (u * R::of32(self.glint_cos) - one, sine * R::of32(self.glint_sin));
        let sharpness = R::of32(self.glint_sharpness);
        let near = (sharpness * (along + across).min(zero)).exp();
        let far = (sharpness * (along - across).min(zero)).exp();
        let inner = R::of32(self.inner_cosine) * half + R::of32(self.inner_even) + R::of32(self.glint) * (near + far);
        let [a0, a1, a2] = self.medulla;
        let medulla = R::of32(a0) + u * (R::of32(a1) + u * R::of32(a2));
        [surface, through, inner, medulla.max(zero)]
    }
}
