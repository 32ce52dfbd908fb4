//! Lights by name, that turn with the camera: what a coat is looked at in.

use super::light::{Lit, studio};
use crate::data::camera::Camera;
use crate::data::light::Directional;
use crate::error::{Error, Result};
use crate::math::Vec3;
use std::fmt;
use std::str::FromStr;

/// Irradiance of a single light, linear RGB.
const IRRADIANCE: Vec3 = Vec3::splat(3.0);
/// Radiance of the sky, linear RGB.
const SKY: Vec3 = Vec3::splat(1.0);
/// Angle at the subject between the eye and a light behind it, degrees.
const BEHIND_DEG: f32 = 155.0;

/// An arrangement of lights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rig {
    /// One light, from the eye.
    Front,
    /// One light, from the left: at a right angle to the line of sight, level with the picture.
    Side,
    /// One light from behind and above, 155° from the eye: it shines through the fringe.
    Rim,
    /// The same radiance from everywhere, and no light.
    Sky,
    /// Three lights and what comes from everywhere ([`studio`]).
    Studio,
}

impl Rig {
    /// All there are.
    pub const ALL: [Self; 5] = [Self::Front, Self::Side, Self::Rim, Self::Sky, Self::Studio];

    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Front => "front",
            Self::Side => "side",
            Self::Rim => "rim",
            Self::Sky => "sky",
            Self::Studio => "studio",
        }
    }

    /// What falls on a subject before `camera`.
    pub fn lit(self, camera: &Camera) -> Lit {
        let [right, up, back] = camera.axes().map(|axis| axis.as_vec3());
        let (sin, cos) = (libm::sinf(BEHIND_DEG.to_radians()), libm::cosf(BEHIND_DEG.to_radians()));
        let to_light = match self {
            Self::Studio => return studio(camera),
            Self::Sky => return Lit { lights: Vec::new(), ambient: SKY, fill_on_undercoat: true },
            Self::Front => back,
            Self::Side => -right,
            Self::Rim => back * cos + up * sin,
        };
        let light = Directional { to_light: to_light.normalize(), irradiance: IRRADIANCE };
        Lit { lights: vec![light.into()], ambient: Vec3::ZERO, fill_on_undercoat: true }
    }
}

impl fmt::Display for Rig {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Rig {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self> {
        Self::ALL.into_iter().find(|rig| rig.name() == text.trim()).ok_or_else(|| {
            Error::usage("there are no such lights")
                .with_parameter("lights")
                .with_found(text)
                .with_expected(Self::ALL.map(Self::name).join(", "))
        })
    }
}
