//! Which way shadows of lights go.

use super::scene::Lighting;
use crate::data::light::Light;
use crate::data::mesh::Mesh;
use crate::gpu::Constant::{self, F32};
use crate::math::Vec3;
use crate::shade::law::polynomial::{DEEPEST, LOWEST_EYE, LOWEST_LIGHT, SLANTS, THIN, USUAL};
use crate::shade::law::{BRIGHTEST, FADING, LEAST_ABOVE, MOST_KNOWN, MOST_SLANT, colour};

/// What the law of light in Rust and in shaders both need: the module `furrier::law_constants`.
pub const LAW_CONSTANTS: [Constant; 15] = [
    F32("COLOUR_NEAR", colour::NEAR as f32),
    F32("LEAST_LOG_ABSORPTION", colour::LOG_ABSORPTIONS[0] as f32),
    F32("MOST_LOG_ABSORPTION", colour::LOG_ABSORPTIONS[1] as f32),
    F32("DEEPEST_LAW", DEEPEST as f32),
    F32("LOWEST_LIGHT", LOWEST_LIGHT as f32),
    F32("LOWEST_EYE", LOWEST_EYE as f32),
    F32("SLANT_LEAST", SLANTS[0] as f32),
    F32("SLANT_MOST", SLANTS[1] as f32),
    F32("THIN", THIN as f32),
    F32("USUAL", USUAL as f32),
    F32("LEAST_ABOVE", LEAST_ABOVE as f32),
    F32("MOST_SLANT", MOST_SLANT as f32),
    F32("MOST_KNOWN", MOST_KNOWN as f32),
    F32("FADING", FADING as f32),
    F32("BRIGHTEST", BRIGHTEST as f32),
];

/// Distance of a key light from the middle of the skin's bounds, in diagonals of these, below which pictures of dense fur are more than
/// 0.05 of FLIP off, as the shadow of guard hair is followed along one direction.
const NEAREST_DIAGONALS: f32 = 2.0;

impl Lighting {
    /// All lights, the key first.
    pub fn all(&self) -> impl Iterator<Item = &Light> {
        std::iter::once(&self.key).chain(&self.fill)
    }

    /// The unit vector along which the key light's shadow in the mean is followed everywhere: towards the light, from the middle
    /// of the skin's bounds where it is not infinitely far away (`docs/steps/shade.md`).
    pub fn mean_direction(&self, skin: &Mesh) -> Vec3 {
        let (low_m, high_m) = skin.bounds_m();
        self.key.at(0.5 * (low_m + high_m)).to_light
    }

    /// What a person should know of how these lights light `skin`, one sentence each.
    pub fn notes(&self, skin: &Mesh) -> Vec<String> {
        let (low_m, high_m) = skin.bounds_m();
        let near = self.key.position_m().map(|p| p.distance(0.5 * (low_m + high_m)) / skin.diagonal_m());
        let told = |diagonals: f32| {
            format!(
                "the first light is {diagonals:.2} diagonals of the skin from its middle: nearer than {NEAREST_DIAGONALS:.0}, \
                 its shadow in the fur is off (docs/steps/shade.md)"
            )
        };
        near.filter(|&diagonals| diagonals < NEAREST_DIAGONALS).map(told).into_iter().collect()
    }
}
