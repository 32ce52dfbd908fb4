//! Directional lights.

use crate::error::{Error, Result};
use crate::math::Vec3;

/// A light from infinitely far away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Directional {
    /// Unit vector towards the light.
    pub to_light: Vec3,
    /// Irradiance on a plane at a right angle to it, linear RGB.
    pub irradiance: Vec3,
}

impl Directional {
    /// From the direction in which the light travels, of any length.
    ///
    /// # Errors
    /// Names a zero or non-finite direction, or an irradiance that is negative or not finite.
    pub fn travelling(direction: Vec3, irradiance: Vec3) -> Result<Self> {
        let to_light = (-direction).normalize_or_zero();
        if to_light == Vec3::ZERO || !direction.is_finite() {
            return Err(Error::usage("a light needs a direction")
                .with_field("direction")
                .with_found(direction)
                .with_expected("three finite numbers, not all zero"));
        }
        if !irradiance.is_finite() || irradiance.min_element() < 0.0 {
            return Err(Error::usage("a light cannot take light away")
                .with_field("irradiance")
                .with_found(irradiance)
                .with_expected("three finite numbers, none negative"));
        }
        Ok(Self { to_light, irradiance })
    }
}

/// Luminance of linear sRGB primaries (Rec. 709).
pub fn luminance(colour: Vec3) -> f32 {
    colour.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}
