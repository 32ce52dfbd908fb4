//! What stored bytes mean.

use super::Incidence;
use super::guards::{LEAST_CLEAR, LEAST_DIRECTION};
use crate::data::image::unorm8;
use crate::math::Vec3;

/// A byte that holds a number in [0, 1].
pub fn unorm(byte: u8) -> f32 {
    f32::from(byte) / 255.0
}

/// A byte that holds a number in [−1, 1]; 128 is 0.
pub fn signed(byte: u8) -> f32 {
    (f32::from(byte) - 128.0) / 127.0
}

/// Hair in a voxel, as a medium that depends on direction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HairMedium {
    /// Lateral extinction A, 1/m.
    pub extinction: f32,
    /// A times the mean tangent, 1/m.
    pub tangent: Vec3,
}

impl HairMedium {
    /// Of the four bytes of a texel in a mip whose stored 1 stands for `scale_per_m`.
    pub fn decode(bytes: &[u8], scale_per_m: f32) -> Self {
        let tangent = Vec3::new(signed(bytes[1]), signed(bytes[2]), signed(bytes[3]));
        Self { extinction: unorm(bytes[0]) * scale_per_m, tangent: tangent * scale_per_m }
    }

    /// Extinction that a ray meets, 1/m of the ray. Hair keeps its diameter under M: it becomes |M m̂| times as long in a
    /// volume det M times as large. Hair without a direction has none.
    pub fn lateral(&self, seen: &Incidence) -> f32 {
        let length = self.tangent.length();
        if self.extinction <= 0.0 || length <= LEAST_DIRECTION {
            return 0.0;
        }
        let map = seen.skin_from_tile;
        let volume = seen.volume();
        let stretch = (map * (self.tangent / length)).length();
        let extinction = self.extinction * stretch / volume;
        let along = seen.direction.dot(map * self.tangent) / volume;
        (extinction * extinction - along * along).max(0.0).sqrt()
    }

    /// The same in a tile that is neither sheared nor stretched, A √(1 − (ω·m)²) for the unit vector `ray`. Hair without a
    /// direction counts as lying across the ray.
    pub fn upright(&self, ray: Vec3) -> f32 {
        let along = ray.dot(self.tangent);
        (self.extinction * self.extinction - along * along).max(0.0).sqrt()
    }
}

/// Optical depth of an opacity: κ of the filtered 1 − e^−κ.
pub fn depth_of_opacity(ends: f32) -> f32 {
    -libm::log1pf(-ends.min(1.0 - LEAST_CLEAR))
}

/// The same of a byte that was not filtered. 255 stands for an end that hides all; half a step less keeps the logarithm finite.
pub fn depth_of_byte(byte: u8) -> f32 {
    -libm::logf(1.0 - f32::from(byte).min(254.5) / 255.0)
}

/// Most hair area above per skin area that a byte holds: the law of light knows no deeper hair.
pub const MOST_ABOVE: f32 = 16.0;

/// Hair area above per skin area as a byte: 255 where none is, then by its root.
pub fn code_above(above: f32) -> u8 {
    unorm8(1.0 - (above / MOST_ABOVE).clamp(0.0, 1.0).sqrt())
}

/// The hair area above that a byte stands for.
pub fn above_of(byte: u8) -> f32 {
    let root = 1.0 - unorm(byte);
    MOST_ABOVE * root * root
}

/// The same of a byte of versions 1 and 2, which hold what light at 45° comes through.
pub fn above_of_transmittance(byte: u8) -> f32 {
    -libm::logf(unorm(byte).max(LEAST_CLEAR))
}

/// A texel as a shader sees it after filtering.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Texel {
    /// Hair seen from its side.
    pub medium: HairMedium,
    /// End opacity 1 − e^−κ.
    pub ends: f32,
    /// Luminance of the albedo times e to minus the hair area above: how bright the hair is under a light above it.
    pub brightness: f32,
}

impl Texel {
    /// Adds `weight` of another.
    pub fn add(&mut self, other: &Self, weight: f32) {
        self.medium.extinction += other.medium.extinction * weight;
        self.medium.tangent += other.medium.tangent * weight;
        self.ends += other.ends * weight;
        self.brightness += other.brightness * weight;
    }
}
