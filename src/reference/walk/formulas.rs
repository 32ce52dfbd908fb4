//! The renderer's own fibre, as walks need it.

use super::scatter::{Meeting, Scatter};
use crate::math::DVec3;
use crate::shade::Angles;
use crate::shade::fibre::sample::Sampler;
use crate::shade::law::Scattering;

/// A hair's look without its law: every further scattering is walked.
#[derive(Clone, Debug)]
pub struct FibreWalk<'a> {
    look: &'a Scattering,
    sampler: Sampler,
}

impl<'a> FibreWalk<'a> {
    /// Of a look.
    pub fn new(look: &'a Scattering) -> Self {
        Self { look, sampler: Sampler::new(&look.fibre) }
    }

    /// Absorptions per radius of hair that wears a colour.
    fn absorptions(&self, colour: DVec3) -> DVec3 {
        DVec3::from(self.look.wear(colour.to_array()).map(|worn| worn.absorption))
    }
}

impl Scatter for FibreWalk<'_> {
    fn scatter(&self, at: &Meeting, to_eye: DVec3, to_light: DVec3, colour: DVec3) -> DVec3 {
        let angles = Angles::of_dvectors(at.hair, to_light, to_eye);
        let lit = self.look.fibre.lit(angles);
        self.absorptions(colour).map(|absorption| lit.through(absorption)) * angles.cos_in()
    }

    fn sample(&self, at: &Meeting, to_eye: DVec3, colour: DVec3, random: [f64; 4]) -> (DVec3, f64) {
        // As the lightest channel scatters.
        self.sampler.sample(at.hair, to_eye, self.absorptions(colour).min_element(), random)
    }
}
