//! Where the key light's shadow is followed to.

use super::scene::Lighting;
use crate::data::light::Light;
use crate::data::mesh::Mesh;
use crate::math::Vec3;

impl Lighting {
    /// All lights, the key first.
    pub fn all(&self) -> impl Iterator<Item = &Light> {
        std::iter::once(&self.key).chain(&self.fill)
    }

    /// The unit vector along which the key light's shadow is followed everywhere: towards the light, from the middle of the
    /// skin's bounds where it is not infinitely far away (`docs/steps/shade.md`).
    pub fn shadow_direction(&self, skin: &Mesh) -> Vec3 {
        let (low_m, high_m) = skin.bounds_m();
        self.key.at(0.5 * (low_m + high_m)).to_light
    }
}
