//! Where a picture is taken from.

use crate::error::{Error, Kind, Result};
use crate::math::{DMat4, DVec3, DVec4};
use serde::{Deserialize, Serialize};

/// A perspective camera, as camera files hold it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// Where the eye is, m, world axes.
    pub eye: [f64; 3],
    /// The point it looks at, m.
    pub target: [f64; 3],
    /// Which way is up in the picture.
    #[serde(default = "up")]
    pub up: [f64; 3],
    /// Vertical field of view, degrees, in 1 … 170.
    #[serde(default = "vfov_deg")]
    pub vfov_deg: f64,
}

fn up() -> [f64; 3] {
    [0.0, 1.0, 0.0]
}

fn vfov_deg() -> f64 {
    40.0
}

impl Camera {
    /// Reads a camera file: `{"eye": [x,y,z], "target": […], "up": […], "vfov_deg": 40}`; the last two may be left out.
    ///
    /// # Errors
    /// [`Kind::Usage`] naming the field that is missing, unknown or out of range.
    pub fn from_json(text: &str) -> Result<Self> {
        let camera: Self = serde_json::from_str(text).map_err(|error| {
            Error::usage("the camera file cannot be read")
                .with_found(error)
                .with_expected(r#"{"eye": [x, y, z], "target": [x, y, z], "up": [x, y, z], "vfov_deg": 40}"#)
        })?;
        camera.checked()
    }

    /// Checks that the camera sees something.
    ///
    /// # Errors
    /// [`Kind::Usage`] naming the field.
    pub fn checked(self) -> Result<Self> {
        let fault = |field: &str, found: String, expected: &str| {
            Err(Error::new(Kind::Usage, "the camera sees nothing")
                .with_field(field)
                .with_found(found)
                .with_expected(expected))
        };
        let numbers = [self.eye, self.target, self.up];
        if let Some(at) = numbers.iter().position(|v| v.iter().any(|c| !c.is_finite())) {
            return fault(["eye", "target", "up"][at], format!("{:?}", numbers[at]), "finite numbers");
        }
        if !(1.0..=170.0).contains(&self.vfov_deg) {
            return fault("vfov_deg", self.vfov_deg.to_string(), "1 to 170 degrees");
        }
        let forward = DVec3::from(self.target) - DVec3::from(self.eye);
        if forward.length_squared() == 0.0 {
            return fault("target", format!("{:?}", self.target), "another point than the eye");
        }
        if forward.normalize().cross(DVec3::from(self.up).normalize_or_zero()).length_squared() < 1e-12 {
            return fault("up", format!("{:?}", self.up), "not along the line of sight");
        }
        Ok(self)
    }

    /// Unit vectors to the right, up and towards the viewer.
    pub fn axes(&self) -> [DVec3; 3] {
        let back = (DVec3::from(self.eye) - DVec3::from(self.target)).normalize();
        let right = DVec3::from(self.up).cross(back).normalize();
        [right, back.cross(right), back]
    }

    /// Points relative to `origin_m` to clip space: x right, y up, depth 0 at `near_m` and 1 at `far_m`.
    pub fn clip_from_world(&self, origin_m: DVec3, aspect: f64, near_m: f64, far_m: f64) -> DMat4 {
        let axes = self.axes();
        let eye = DVec3::from(self.eye) - origin_m;
        let row = |i: usize| DVec4::from((axes[i], -axes[i].dot(eye)));
        let view = DMat4::from_cols(row(0), row(1), row(2), DVec4::W).transpose();
        let focal = 1.0 / (0.5 * self.vfov_deg.to_radians()).tan();
        let depth = far_m / (near_m - far_m);
        let projection = DMat4::from_cols(
            DVec4::X * (focal / aspect),
            DVec4::Y * focal,
            DVec4::new(0.0, 0.0, depth, -1.0),
            DVec4::Z * (depth * near_m),
        );
        projection * view
    }
}
