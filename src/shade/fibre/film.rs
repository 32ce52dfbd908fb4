//! Water on a hair.

use super::FibreParameters;

/// Index of refraction of water.
const WATER: f64 = 1.33;

/// A film of water on hair.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Film {
    /// How much of one there is, 0 to 1.
    pub amount: f32,
    /// How much of the roughness and of the scales' tilt a whole one takes away, 0 to 1.
    pub gloss: f32,
}

impl Film {
    /// By how much it draws the logit of a colour down: ln n² for a whole film.
    ///
    /// Light that a dull body of albedo A sends into a film leaves it with the chance 1/n²; what does not leave falls on the body again. So
    /// the wet body's albedo is A/(n²(1 − A) + A) (Ångström 1925, "The albedo of various surfaces of ground"; Lekner and Dorf 1988, "Why some
    /// things are darker when wet"), which is A/(1 − A) over n².
    pub fn logit_shift(&self) -> f64 {
        2.0 * libm::log(WATER) * f64::from(self.amount)
    }

    /// A colour in [0, 1] under the film.
    pub fn darkened(&self, colour: f32) -> f32 {
        let factor = libm::exp(self.logit_shift()) as f32;
        colour / (factor * (1.0 - colour) + colour)
    }

    /// A hair's surface under the film.
    pub fn smoothed(&self, dry: &FibreParameters) -> FibreParameters {
        let left = 1.0 - self.amount * self.gloss;
        let smoothed = |roughness: f32| (left * roughness).max(SMOOTHEST.min(roughness));
        FibreParameters {
            roughness: smoothed(dry.roughness),
            azimuthal_roughness: smoothed(dry.azimuthal_roughness),
            tilt_deg: left * dry.tilt_deg,
            ..*dry
        }
    }
}

/// Least roughness that a film leaves: that which a preset may have.
const SMOOTHEST: f32 = 0.1;
