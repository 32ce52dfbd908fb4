//! Kajiya and Kay 1989, "Rendering fur with three dimensional textures", with the constants that conserve energy.

use super::{Angles, Real};
use std::f64::consts::PI;

/// A hair that scatters the same way all around: diffuse plus a highlight on the mirror cone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KajiyaKay<R> {
    /// Part of the light scattered diffusely; tinted by the hair's colour.
    pub diffuse: R,
    /// Part of the light in the highlight at θ_o = 0; untinted.
    pub specular: R,
    /// Exponent p of the highlight; wider with a smaller one.
    pub exponent: R,
    specular_scale: R,
}

impl<R: Real> KajiyaKay<R> {
    /// Of albedos `diffuse` + `specular` ≤ 1 and a highlight exponent in [1, 1000].
    pub fn new(diffuse: f64, specular: f64, exponent: f64) -> Self {
        Self {
            diffuse: R::of(diffuse),
            specular: R::of(specular),
            exponent: R::of(exponent),
            specular_scale: R::of(1.0 / (2.0 * PI * cosine_power_integral(exponent + 2.0))),
        }
    }

    /// What [`Self::scatter`] is made of: the diffuse part, the factor on the highlight's power, its exponent.
    pub fn coefficients(&self) -> [R; 3] {
        [self.diffuse * R::of(1.0 / (PI * PI)), self.specular * self.specular_scale, self.exponent]
    }

    /// The same in other numbers.
    #[inline(always)]
    pub fn map<S>(&self, of: impl Fn(R) -> S) -> KajiyaKay<S> {
        KajiyaKay {
            diffuse: of(self.diffuse),
            specular: of(self.specular),
            exponent: of(self.exponent),
            specular_scale: of(self.specular_scale),
        }
    }

    /// S per channel of the hair's colour, 1/sr: (factor of the colour, untinted rest).
    ///
    /// Diffuse is 1/π², since ∫ cos θ dω = π² over the sphere. The highlight cos^p(θ_i + θ_o) holds its albedo at
    /// θ_o = 0 and less elsewhere, as the cosine and the poles take their part.
    #[inline(always)]
    pub fn scatter(&self, angles: Angles<R>) -> (R, R) {
        let mirror = angles.cos_in() * angles.cos_out() - angles.sin_in * angles.sin_out;
        let highlight = mirror.max(R::of(0.0)).min(R::of(1.0)).powf(self.exponent) * self.specular_scale;
        (self.diffuse * R::of(1.0 / (PI * PI)), self.specular * highlight)
    }
}

/// ∫ cos^n over [−π/2, π/2] = √π Γ((n+1)/2) / Γ(n/2 + 1).
fn cosine_power_integral(n: f64) -> f64 {
    PI.sqrt() * libm::exp(libm::lgamma(0.5 * (n + 1.0)) - libm::lgamma(0.5 * n + 1.0))
}
