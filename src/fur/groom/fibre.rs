//! One kind of hair, ready to grow: a preset's table in metres.

use super::{Colour, Guard, Shape, Undercoat};
use crate::data::strands::Profile;
use crate::math::Vec3;
use serde::Serialize;

/// Guard hair or undercoat with all lengths in metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Fibre {
    /// Hairs per skin area, 1/m².
    pub density_per_m2: f32,
    /// Mean length along the hair, m.
    pub length_m: f32,
    /// Radius at the root, m.
    pub radius_m: f32,
    /// Shape.
    pub shape: Shape,
    /// Taper, colour and opacity along the hair.
    pub profile: Profile,
    /// Spread of brightness from hair to hair.
    pub variation: f32,
}

/// How many standard deviations of length the longest and the shortest hair are off the mean.
pub const LENGTH_SPREAD: f32 = 2.0;

/// How steeply transparency grows towards the tip (exponent of Andersen et al. 2016 §3.1, our choice).
const TIP_EXPONENT: f32 = 4.0;

impl Fibre {
    /// Guard hair on skin with bounding diagonal `diagonal_m`.
    pub fn guard(guard: &Guard, colour: &Colour, diagonal_m: f32) -> Self {
        Self {
            density_per_m2: guard.density_per_cm2 * 1e4,
            length_m: guard.length.metres(diagonal_m),
            radius_m: 0.5e-6 * guard.diameter_um,
            shape: guard.shape,
            profile: Profile {
                taper: guard.taper,
                ramp: colour.guard_ramp(),
                tip_transparency: guard.tip_transparency,
                tip_exponent: TIP_EXPONENT,
            },
            variation: colour.variation,
        }
    }

    /// Undercoat on skin with bounding diagonal `diagonal_m`.
    pub fn undercoat(undercoat: &Undercoat, colour: &Colour, diagonal_m: f32) -> Self {
        Self {
            density_per_m2: undercoat.density_per_cm2 * 1e4,
            length_m: undercoat.length.metres(diagonal_m),
            radius_m: 0.5e-6 * undercoat.diameter_um,
            shape: undercoat.shape,
            profile: Profile {
                taper: 1.0,
                ramp: colour.undercoat_ramp(),
                tip_transparency: 0.0,
                tip_exponent: TIP_EXPONENT,
            },
            variation: 0.5 * colour.variation,
        }
    }

    /// The same hair without colour: it grows where and as this does.
    pub fn colourless(&self) -> Self {
        Self { profile: Profile { ramp: [Vec3::ZERO; 3], ..self.profile }, variation: 0.0, ..*self }
    }

    /// Length of the longest hair, m.
    pub fn longest_m(&self) -> f32 {
        self.length_m * (1.0 + LENGTH_SPREAD * self.shape.length_variation)
    }

    /// Greatest height a hair of this kind reaches along the lean, m: bend and curl take from it.
    pub fn height_m(&self) -> f32 {
        super::hair::height(&self.shape, self.longest_m())
    }
}
