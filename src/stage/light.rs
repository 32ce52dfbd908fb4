//! Lights: as flags say, or those of a small studio.

use super::named;
use crate::data::camera::Camera;
use crate::data::light::{Directional, InWorld, Light, Point, Spot};
use crate::data::subject::Subject;
use crate::error::{Error, Result};
use crate::math::{DVec3, Vec3};

/// Radiance of the studio's walls, linear RGB.
const STUDIO_AMBIENT: Vec3 = Vec3::new(0.42, 0.44, 0.48);

/// What falls on the subject.
#[derive(Clone, Debug, PartialEq)]
pub struct Lit {
    /// The key light first; positions are relative to the subject's origin.
    pub lights: Vec<Light>,
    /// Radiance from everywhere, linear RGB.
    pub ambient: Vec3,
    /// Whether lights after the key fall on undercoat too, where a renderer tells them apart.
    pub fill_on_undercoat: bool,
}

/// A light that was asked for.
#[derive(Clone, Debug, PartialEq)]
pub enum Asked {
    /// One with all its numbers.
    Light(InWorld),
    /// The asset's own light of this name.
    Named(String),
}

impl Asked {
    /// The light, its position relative to the subject's origin.
    ///
    /// # Errors
    /// [`crate::error::Kind::Usage`] for a name that the asset does not have, with those that it has, and for a position too far
    /// from the subject.
    pub fn light(&self, subject: &Subject) -> Result<Light> {
        match self {
            Self::Light(light) => light.relative_to(subject.origin_m),
            Self::Named(name) => {
                let hint = |error: Error| error.with_hint("lights that are no names begin with dir:, point: or spot:");
                named(&subject.lights, name, "light").map_err(hint)?.relative_to(subject.origin_m)
            }
        }
        .map_err(|error| error.with_parameter("light"))
    }
}

/// Three numbers with commas between.
///
/// # Errors
/// Names `parameter`, the value and what was expected.
pub fn parse_triple(text: &str, parameter: &'static str) -> Result<Vec3> {
    numbers(text).map(Vec3::from_array).ok_or_else(|| {
        Error::usage("expected three numbers")
            .with_parameter(parameter)
            .with_found(text)
            .with_expected("X,Y,Z, all finite")
    })
}

/// `N` finite numbers with commas between.
fn numbers<const N: usize>(text: &str) -> Option<[f32; N]> {
    let all: Option<Vec<f32>> =
        text.split(',').map(|n| n.trim().parse().ok().filter(|n: &f32| n.is_finite())).collect();
    all?.try_into().ok()
}

/// Reads a light: `dir:X,Y,Z:R,G,B`, the direction it travels and its irradiance; `point:X,Y,Z:R,G,B`, its place and its
/// intensity; `spot:X,Y,Z:DX,DY,DZ:ANGLE_DEG:R,G,B`, its place, the direction it shines, the angle from there to the cone's edge
/// and its intensity; or the name of a light of the asset.
///
/// # Errors
/// Names the value and what was expected.
pub fn parse(text: &str) -> Result<Asked> {
    let Some((kind, rest)) = text.split_once(':').filter(|(kind, _)| ["dir", "point", "spot"].contains(kind)) else {
        return Ok(Asked::Named(text.to_owned()));
    };
    let parts: Vec<&str> = rest.split(':').collect();
    let triple = |text: &str| numbers(text).map(Vec3::from_array);
    let read = || match (kind, &parts[..]) {
        ("dir", [direction, irradiance]) => Some(directional(triple(direction)?, triple(irradiance)?)),
        ("point", [place, intensity]) => Some(point(place_of(place)?, triple(intensity)?)),
        ("spot", [place, direction, angle, intensity]) => {
            let [angle_deg] = numbers(angle)?;
            Some(spot(place_of(place)?, triple(direction)?, angle_deg, triple(intensity)?))
        }
        _ => None,
    };
    let fault = || {
        Error::usage("the light cannot be read")
            .with_found(text)
            .with_expected(
                "dir:X,Y,Z:R,G,B, point:X,Y,Z:R,G,B, spot:X,Y,Z:DX,DY,DZ:ANGLE_DEG:R,G,B or the name of a light of the asset",
            )
            .with_hint("`light` dir:0,-1,-1:3,3,3 shines from above and in front")
    };
    let light = read().unwrap_or_else(|| Err(fault())).map_err(|error| error.with_parameter("light"))?;
    Ok(Asked::Light(light))
}

/// A place in the world, m: worlds may be large.
fn place_of(text: &str) -> Option<DVec3> {
    let all: Option<Vec<f64>> =
        text.split(',').map(|n| n.trim().parse().ok().filter(|n: &f64| n.is_finite())).collect();
    Some(DVec3::from_slice(all?.get(..3).filter(|_| text.split(',').count() == 3)?))
}

fn directional(direction: Vec3, irradiance: Vec3) -> Result<InWorld> {
    Ok(InWorld::directional(Directional::travelling(direction, irradiance)?))
}

fn point(place_m: DVec3, intensity: Vec3) -> Result<InWorld> {
    Ok(InWorld { place_m, light: Point::new(Vec3::ZERO, intensity, None)?.into() })
}

fn spot(place_m: DVec3, direction: Vec3, angle_deg: f32, intensity: Vec3) -> Result<InWorld> {
    let point = Point::new(Vec3::ZERO, intensity, None)?;
    Ok(InWorld { place_m, light: Spot::new(point, direction, 0.0, angle_deg.to_radians())?.into() })
}

/// A key light from above the camera's left shoulder, a weak cool one from the right, and one from behind that shines
/// through the fringe. They turn with the camera.
pub fn studio(camera: &Camera) -> Lit {
    let [right, up, back] = camera.axes().map(|axis| axis.as_vec3());
    let lights = [
        (Vec3::new(-0.60, 0.75, 0.55), Vec3::new(2.9, 2.75, 2.5)),
        (Vec3::new(0.85, 0.10, 0.50), Vec3::new(0.45, 0.5, 0.6)),
        (Vec3::new(0.45, 0.70, -0.75), Vec3::new(1.9, 1.95, 2.1)),
    ]
    .map(|(at, irradiance)| {
        Directional { to_light: (right * at.x + up * at.y + back * at.z).normalize(), irradiance }.into()
    });
    Lit { lights: lights.to_vec(), ambient: STUDIO_AMBIENT, fill_on_undercoat: true }
}
