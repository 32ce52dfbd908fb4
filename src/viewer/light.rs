//! Lights: as flags say, or those of a small studio.

use crate::data::camera::Camera;
use crate::data::light::Directional;
use crate::error::{Error, Result};
use crate::math::Vec3;

/// Radiance of the studio's walls, linear RGB.
pub const STUDIO_AMBIENT: Vec3 = Vec3::new(0.42, 0.44, 0.48);

/// Three numbers with commas between.
///
/// # Errors
/// Names `field`, the value and what was expected.
pub fn parse_triple(text: &str, field: &str) -> Result<Vec3> {
    let numbers: Vec<f32> =
        text.split(',').filter_map(|n| n.trim().parse().ok()).filter(|n: &f32| n.is_finite()).collect();
    match numbers[..] {
        [x, y, z] if text.split(',').count() == 3 => Ok(Vec3::new(x, y, z)),
        _ => Err(Error::usage("expected three numbers")
            .with_field(field)
            .with_found(text)
            .with_expected("X,Y,Z, all finite")),
    }
}

/// Reads `dir:X,Y,Z:R,G,B`: the direction the light travels, and its irradiance in linear RGB.
///
/// # Errors
/// Names `--light`, the value and what was expected.
pub fn parse_light(text: &str) -> Result<Directional> {
    let Some((direction, irradiance)) = text.strip_prefix("dir:").and_then(|rest| rest.split_once(':')) else {
        return Err(Error::usage("the light cannot be read")
            .with_field("--light")
            .with_found(text)
            .with_expected("dir:X,Y,Z:R,G,B: the direction it travels, its irradiance in linear RGB")
            .with_hint("`--light dir:0,-1,-1:3,3,3` shines from above and in front"));
    };
    Directional::travelling(parse_triple(direction, "--light")?, parse_triple(irradiance, "--light")?)
        .map_err(|error| error.with_field("--light"))
}

/// A key light from above the camera's left shoulder, a weak cool one from the right, and one from behind that shines
/// through the fringe. They turn with the camera.
pub fn studio(camera: &Camera) -> Vec<Directional> {
    let [right, up, back] = camera.axes().map(|axis| axis.as_vec3());
    [
        (Vec3::new(-0.60, 0.75, 0.55), Vec3::new(2.9, 2.75, 2.5)),
        (Vec3::new(0.85, 0.10, 0.50), Vec3::new(0.45, 0.5, 0.6)),
        (Vec3::new(0.45, 0.70, -0.75), Vec3::new(1.9, 1.95, 2.1)),
    ]
    .map(|(at, irradiance)| Directional { to_light: (right * at.x + up * at.y + back * at.z).normalize(), irradiance })
    .to_vec()
}
