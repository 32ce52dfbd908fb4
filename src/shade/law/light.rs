//! What a hair in a coat sends towards the eye: the one law of pictures and coats.

use super::known::Scattering;
use super::{BRIGHTEST, Place, Worn, of_colour};
use crate::shade::{Angles, Real};

/// A colour per channel, as a fibre wears it.
pub type WornColour<R> = [Worn<R>; 3];

/// How much better light finds its way out along the way it came, by the azimuth φ between light and eye around the hair: light
/// and eye share the gaps between hairs that have a width. Times hair area per volume and diameter it is the optical depth that
/// is taken away (found by tracing explicit hair; `docs/steps/light.md`).
#[inline(always)]
fn hot_spot<R: Real>(cos_azimuth: R) -> R {
    let half_sine = (R::of(0.5) * (R::of(1.0) - cos_azimuth)).max(R::of(0.0)).sqrt();
    R::of(1.0) / (R::of(0.18) + half_sine * (R::of(0.735) + half_sine * R::of(20.7)))
}

impl Scattering {
    /// The nearest that the hair comes to a colour.
    #[inline(always)]
    pub fn wear<R: Real>(&self, colour: [R; 3]) -> WornColour<R> {
        [self.colouring.worn(colour[0]), self.colouring.worn(colour[1]), self.colouring.worn(colour[2])]
    }

    /// Radiance towards the eye per irradiance of one light, which an optical depth of `place.depth` shadows; `crowding` is hair
    /// area per volume times diameter.
    #[inline(always)]
    pub fn light<R: Real>(&self, angles: Angles<R>, place: &Place<R>, worn: &WornColour<R>, crowding: R) -> [R; 3] {
        let lit = self.fibre.lit(angles);
        let shared = (crowding * hot_spot(angles.cos_azimuth)).min(place.depth);
        let arriving = angles.cos_in() * (shared - place.depth).exp();
        let (multiple, beyond) = (self.law.multiple(place), place.beyond());
        let mut sum = [arriving; 3];
        for channel in 0..3 {
            let Worn { absorption, logit } = worn[channel];
            sum[channel] = lit.through(absorption) * arriving + of_colour(multiple, logit, BRIGHTEST) * beyond;
        }
        sum
    }

    /// Radiance towards the eye per radiance of a sky that is everywhere the same.
    #[inline(always)]
    pub fn sky<R: Real>(&self, place: &Place<R>, worn: &WornColour<R>) -> [R; 3] {
        let sky = self.law.sky(place);
        [of_colour(sky, worn[0].logit, 0.0), of_colour(sky, worn[1].logit, 0.0), of_colour(sky, worn[2].logit, 0.0)]
    }
}
