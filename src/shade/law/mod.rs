//! The law by which fur is lit: what light that was scattered more than once adds to a hair.
//!
//! One scattering is exact: S of the fibre, times what the followed shadow lets through. All further ones come from the
//! fibre's own slab: flat fur of this fibre, deep and black below, in which every scattering is followed (`slab.rs`). What
//! its hairs send is put into a few terms whose factors stand for all colours, inclinations, depths and leans (`solve.rs`).

pub mod colour;
pub mod known;
pub mod light;
pub mod polynomial;
pub mod slab;
pub mod solve;
mod wet;

pub use colour::{Colouring, Worn};
pub use known::Scattering;
pub use polynomial::{COLOUR_TERMS, SKY_TERMS, TERMS};

use super::{Angles, Real};
use bytemuck::{Pod, Zeroable};
use serde::{Deserialize, Serialize};

/// Where a hair stands in a coat, and what lights it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place<R> {
    /// Hair area above per skin area.
    pub above: R,
    /// Optical depth towards the light.
    pub depth: R,
    /// Cosine between light and mean hair direction, root to tip.
    pub light_hair: R,
    /// Cosine between eye and mean hair direction.
    pub eye_hair: R,
    /// Cosine between light and eye.
    pub light_eye: R,
    /// Cosine between mean hair direction and skin normal.
    pub hair_normal: R,
    /// Cosine between eye and normal.
    pub eye_normal: R,
    /// Cosine between light and normal.
    pub light_normal: R,
}

impl<R: Real> Place<R> {
    /// Of a hair seen and lit at these angles.
    #[inline(always)]
    pub fn new(angles: Angles<R>, light_eye: R, above: R, depth: R, normals: [R; 3]) -> Self {
        let [hair_normal, eye_normal, light_normal] = normals;
        let (light_hair, eye_hair) = (angles.sin_in, angles.sin_out);
        Self { above, depth, light_hair, eye_hair, light_eye, hair_normal, eye_normal, light_normal }
    }

    /// What is left of scattered light where more lies before the light than in any slab: behind a limb, say. The less the further the
    /// light is below the horizon.
    #[inline(always)]
    fn beyond(&self) -> R {
        let lowest = R::of(polynomial::LOWEST_LIGHT);
        let level = (self.light_normal - lowest).max(lowest - self.light_normal) + lowest;
        let known = (self.above.max(R::of(LEAST_ABOVE)) * R::of(MOST_SLANT) / level).min(R::of(MOST_KNOWN));
        let more = self.depth - known;
        (-(more.max(R::of(0.0)) * R::of(FADING))).exp()
    }
}

/// Depth per hair area at a right angle to the light from which on scattered light fades.
pub const MOST_SLANT: f64 = 1.25;
/// Depth that is more than that of any slab, wherever in it.
pub const MOST_KNOWN: f64 = 15.0;
/// Hair area of which a hair always has so much around it.
pub const LEAST_ABOVE: f64 = 0.1;
/// Share of further depth that scattered light is dimmed by.
pub const FADING: f64 = 1.0;
/// ln of the most that a hair sends per irradiance of what was scattered before.
pub const BRIGHTEST: f64 = -1.2;

/// Factors of the law's terms for one fibre: each a cubic in the colour's logit.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable, Serialize, Deserialize)]
pub struct Law {
    /// Of light from one direction.
    pub light: [[f32; COLOUR_TERMS]; TERMS],
    /// Of light from the whole sky.
    pub sky: [[f32; COLOUR_TERMS]; SKY_TERMS],
}

/// A cubic in the logit of a colour: what a place has in common for all colours.
pub type Cubic<R> = [R; COLOUR_TERMS];

impl Law {
    /// ln of what a hair sends towards the eye per irradiance, of light scattered twice or more.
    #[inline(always)]
    pub fn multiple<R: Real>(&self, place: &Place<R>) -> Cubic<R> {
        dot(&self.light, &polynomial::light(place))
    }

    /// ln of what a hair sends towards the eye per radiance of the sky, of all its light.
    #[inline(always)]
    pub fn sky<R: Real>(&self, place: &Place<R>) -> Cubic<R> {
        dot(&self.sky, &polynomial::sky(place))
    }
}

/// The value for a colour of this logit, e^`most` at most.
#[inline(always)]
pub fn of_colour<R: Real>(cubic: Cubic<R>, logit: R, most: f64) -> R {
    let [a, b, c, d] = cubic;
    (a + logit * (b + logit * (c + logit * d))).min(R::of(most)).exp()
}

#[inline(always)]
fn dot<R: Real, const N: usize>(factors: &[[f32; COLOUR_TERMS]; N], terms: &[R; N]) -> Cubic<R> {
    let mut sum = [R::of(0.0); COLOUR_TERMS];
    for i in 0..N {
        for power in 0..COLOUR_TERMS {
            sum[power] = sum[power] + R::of32(factors[i][power]) * terms[i];
        }
    }
    sum
}
