//! What a fibre absorbs so that thick fur of it shows a colour.

use super::slab::{COLOURS, Slab, Stand};
use crate::math::solve::least_squares;
use crate::shade::Real;
use crate::shade::fibre::Fibre;
use crate::shade::fibre::sample::Sampler;
use bytemuck::{Pod, Zeroable};
use serde::{Deserialize, Serialize};

/// Photons per eight absorptions.
const PHOTONS: usize = 60_000;
/// Lean and spread of the fur that colours are meant for, degrees.
const STAND_DEG: [f64; 2] = [37.0, 10.0];
/// Absorptions tried, in eights.
const EIGHTS: usize = 4;
/// Least and greatest of them, per radius.
const ABSORPTIONS: [f64; 2] = [2e-6, 20.0];
/// ln of the least and greatest absorption that a colour may need.
pub const LOG_ABSORPTIONS: [f64; 2] = [-14.0, 4.0];
/// How near a colour comes to the darkest and lightest that a fibre reaches.
pub const NEAR: f64 = 8e-3;

/// Factors of its polynomial.
pub const POWERS: usize = 5;

/// From colours to absorption: ln σ = a polynomial of ln((C − C₀)/(C₁ − C)).
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable, Serialize, Deserialize)]
pub struct Colouring {
    /// Darkest colour that the fibre reaches, C₀.
    pub darkest: f32,
    /// Lightest, C₁.
    pub lightest: f32,
    /// Factors of powers.
    pub factors: [f32; POWERS],
}

/// A colour as a fibre wears it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Worn<R> {
    /// Absorption per radius.
    pub absorption: R,
    /// ln(C/(1 − C)) of the colour that is reached.
    pub logit: R,
}

impl Colouring {
    /// The nearest that the fibre reaches to a colour in [0, 1].
    #[inline(always)]
    pub fn worn<R: Real>(&self, colour: R) -> Worn<R> {
        let one = R::of(1.0);
        let (darkest, lightest) = (R::of32(self.darkest), R::of32(self.lightest));
        let near = R::of(NEAR) * (lightest - darkest);
        let c = colour.max(darkest + near).min(lightest - near);
        let u = ((c - darkest) / (lightest - c)).ln();
        let [f0, f1, f2, f3, f4] = self.factors;
        let upper = R::of32(f2) + u * (R::of32(f3) + u * R::of32(f4));
        let log = R::of32(f0) + u * (R::of32(f1) + u * upper);
        Worn {
            absorption: log.min(R::of(LOG_ABSORPTIONS[1])).max(R::of(LOG_ABSORPTIONS[0])).exp_any(),
            logit: (c / (one - c)).ln(),
        }
    }

    /// Of a fibre, from slabs of it.
    pub fn new(fibre: &Fibre, sampler: &Sampler) -> Self {
        let stand = Stand::new(STAND_DEG[0], STAND_DEG[1]);
        let count = EIGHTS * COLOURS;
        let [low, high] = ABSORPTIONS.map(libm::log);
        let absorption = |i: usize| libm::exp(low + (high - low) * i as f64 / (count - 1) as f64);
        let mut shown = Vec::with_capacity(count + 2);
        for eight in 0..EIGHTS {
            let absorptions = std::array::from_fn(|i| absorption(eight * COLOURS + i));
            shown.extend(Slab::new(fibre, sampler, absorptions).albedo(&stand, PHOTONS));
        }
        let ends: [f64; COLOURS] = std::array::from_fn(|i| if i == 0 { 0.0 } else { 1e9 });
        let ends = Slab::new(fibre, sampler, ends).albedo(&stand, PHOTONS);
        let (darkest, lightest) = (ends[1], ends[0]);
        let log_colour = |i: usize| libm::log(shown[i].max(1e-6));
        let rows: Vec<_> = (1..count - 1)
            .filter(|&i| shown[i] > darkest + 1e-3 && shown[i] < lightest - 4e-3)
            .map(|i| {
                let u = libm::log((shown[i] - darkest) / (lightest - shown[i]));
                // As firmly as the colour hangs on the absorption.
                let weight = (log_colour(i - 1) - log_colour(i + 1)).max(0.03);
                let powers: [f64; POWERS] = std::array::from_fn(|power| weight * libm::pow(u, power as f64));
                (powers, weight * libm::log(absorption(i)))
            })
            .collect();
        let factors = least_squares(&rows).map(|x| x as f32);
        Self { darkest: darkest as f32, lightest: lightest as f32, factors }
    }
}
