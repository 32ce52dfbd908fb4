//! A hair as a fibre: what it does with light, by published models written as one sum of lobes.
//!
//! S(θ_i, θ_o, φ) = Σ_p D_p(θ_i) D_p(θ_o) · exp((cos(θ_i + θ_o − 2α_p√(cos θ_i cos θ_o)) − 1)/v_p) · N_p(φ) · e^{−σ ℓ_p ḡ}
//!
//! with φ = 0 where light comes from the eye's side, and ḡ the mean of 1/cos θ_t of both directions: light crosses a fibre on
//! a slant. Marschner et al. 2003 and those after them write a lobe as a profile along the hair over a power of a cosine;
//! with tilted scales that is not reciprocal, and not of the energy it was given. Here D_p is found such that the lobe of a
//! fibre without colour sends back the share ρ_p(θ_o) of all light, for every θ_o (`scale.rs`): since the kernel between
//! the two D is symmetric, S is symmetric as well, whatever tilt and width are, and Σ ρ_p = 1 gives back all light.

mod azimuth;
mod build;
mod film;
pub mod parameters;
pub mod sample;
mod scale;
mod simulate;

pub use film::Film;
pub use parameters::{FibreModel, FibreParameters, Fibres};

use super::{Angles, Real};
use azimuth::Azimuth;
use bytemuck::{Pod, Zeroable};
use serde::{Deserialize, Serialize};

/// Surface reflection, straight through, once reflected inside, scattered by the medulla.
pub const LOBES: usize = 4;

/// Terms of D: 1, q, q², q³, c, s, sq, sq², sc, with s = sin θ, c = cos θ and q = w/(c + w), w being a lobe's softness.
pub const SCALE_TERMS: usize = 9;

/// One lobe along the hair.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable, Serialize, Deserialize)]
pub struct FibreLobe {
    /// Factors of D's terms.
    pub scale: [f32; SCALE_TERMS],
    /// What D is divided by: cos θ and this.
    pub softness: f32,
    /// sin 2α of the tilt α.
    pub tilt: f32,
    /// 1/v, v being about the variance of θ_i + θ_o, rad².
    pub sharpness: f32,
}

/// A fibre, ready to evaluate.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable, Serialize, Deserialize)]
pub struct Fibre {
    /// Along the hair.
    pub lobes: [FibreLobe; LOBES],
    /// Path of each lobe through the fibre, in radii, where light crosses it at a right angle.
    pub paths: [f32; LOBES],
    /// Around the hair.
    pub azimuth: Azimuth,
    /// 1 over the square of the index of refraction.
    pub inverse_index_squared: f32,
}

/// S, 1/sr, of each lobe without colour, and what colour takes: the exponents per absorption.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lit<R> {
    /// Of each lobe.
    pub of: [R; LOBES],
    /// Paths ℓ_p ḡ, in radii.
    pub paths: [R; LOBES],
}

impl<R: Real> Lit<R> {
    /// S, 1/sr, of a fibre that absorbs `absorption` per radius.
    #[inline(always)]
    pub fn through(&self, absorption: R) -> R {
        let mut sum = self.of[0];
        for p in 1..LOBES {
            sum = sum + self.of[p] * (-(absorption * self.paths[p])).exp();
        }
        sum
    }
}

// In lanes, what these call must be inlined to use the widest registers there are: no closures, no adaptors.

impl FibreLobe {
    /// D at an inclination.
    #[inline(always)]
    fn scale_at<R: Real>(&self, sine: R, cosine: R) -> R {
        let [a, b, c, d, e, f, g, h, i] = self.scale;
        let softness = R::of32(self.softness);
        let per = R::of(1.0) / (cosine + softness);
        let q = softness * per;
        let even = R::of32(a) + q * (R::of32(b) + q * (R::of32(c) + q * R::of32(d))) + cosine * R::of32(e);
        let odd = R::of32(f) + q * (R::of32(g) + q * R::of32(h)) + cosine * R::of32(i);
        (even + sine * odd) * per
    }

    /// The lobe along the hair, between the two D; `level` is √(cos θ_i cos θ_o). Scales tilt less the more light grazes them,
    /// so that no direction is left without a mirror image.
    #[inline(always)]
    fn kernel<R: Real>(&self, cos_sum: R, sin_sum: R, level: R) -> R {
        let tilt = R::of32(self.tilt) * level;
        let tilted = cos_sum - R::of(1.0) + tilt * (sin_sum - R::of(0.5) * tilt);
        (tilted.min(R::of(0.0)) * R::of32(self.sharpness)).exp()
    }
}

impl Fibre {
    /// S for the given directions; symmetric in light and eye.
    #[inline(always)]
    pub fn lit<R: Real>(&self, angles: Angles<R>) -> Lit<R> {
        let (si, so) = (angles.sin_in, angles.sin_out);
        let (ci, co) = (angles.cos_in(), angles.cos_out());
        let (cos_sum, sin_sum) = (ci * co - si * so, si * co + ci * so);
        let level = (ci * co).sqrt();
        let mut of = self.azimuth.at(angles.cos_azimuth);
        let crossing = R::of(0.5) * (self.crossing(si) + self.crossing(so));
        let mut paths = [crossing; LOBES];
        for p in 0..LOBES {
            let lobe = &self.lobes[p];
            let scale = lobe.scale_at(si, ci) * lobe.scale_at(so, co);
            of[p] = of[p] * scale * lobe.kernel(cos_sum, sin_sum, level);
            paths[p] = crossing * R::of32(self.paths[p]);
        }
        Lit { of, paths }
    }

    /// 1/cos θ_t: by how much longer the way through is on a slant.
    #[inline(always)]
    fn crossing<R: Real>(&self, sine: R) -> R {
        let square = sine * sine * R::of32(self.inverse_index_squared);
        R::of(1.0) / (R::of(1.0) - square).max(R::of(0.01)).sqrt()
    }
}
