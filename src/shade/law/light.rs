//! What a hair in a coat sends towards the eye: the one law of pictures and coats.

use super::known::Scattering;
use super::{BRIGHTEST, Place, Worn, of_colour};
use crate::shade::{Angles, Real};

/// A colour per channel, as a fibre wears it.
pub type WornColour<R> = [Worn<R>; 3];

/// How much better light finds its way to a hair that is seen: what the eye sees lies in gaps, which light uses too, the more the
/// nearer it comes to the eye's way (φ, the azimuth between them around the hair) and the more hair it has to pass. Times hair
/// area per volume and diameter it is the optical depth that is taken away. Found with walks through explicit hair
/// (`docs/steps/light.md`).
#[inline(always)]
fn gaps<R: Real>(cos_azimuth: R, light_normal: R) -> R {
    let half_sine = (R::of(0.5) * (R::of(1.0) - cos_azimuth)).max(R::of(0.0)).sqrt();
    let shared = R::of(1.0) / (R::of(0.18) + half_sine * (R::of(0.735) + half_sine * R::of(20.7)));
    shared + R::of(1.1) / light_normal.max(R::of(0.2)) - R::of(0.65)
}

/// The same for light of the whole sky on black hair.
const SKY_GAPS: f64 = 2.4;

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
        let shared = (crowding * gaps(angles.cos_azimuth, place.light_normal)).min(place.depth);
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
    pub fn sky<R: Real>(&self, place: &Place<R>, worn: &WornColour<R>, crowding: R) -> [R; 3] {
        let sky = self.law.sky(place);
        let shared = (crowding * R::of(SKY_GAPS)).min(place.above);
        let mut sum = [shared; 3];
        for channel in 0..3 {
            // What is scattered again and again finds its way anyhow.
            let logit = worn[channel].logit;
            let lost = R::of(1.0) / (R::of(1.0) + logit.exp_any());
            sum[channel] = of_colour(sky, logit, 0.0) * (shared * lost * lost).exp_any();
        }
        sum
    }
}
