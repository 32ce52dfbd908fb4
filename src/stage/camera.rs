//! A camera that sees all of the asset.

use crate::data::camera::Camera;
use crate::data::subject::Subject;
use crate::error::{Error, Result};
use crate::math::{DVec2, DVec3, Vec3};
use std::str::FromStr;

/// Field of view of cameras that frame, degrees: that of a short telephoto lens, which flatters animals.
const VFOV_DEG: f64 = 28.0;
/// What is left free around the subject, as a part of the picture.
const MARGIN: f64 = 0.06;

/// Where to look from.
#[derive(Clone, Debug, PartialEq)]
pub enum Viewpoint {
    /// From an angle, as close as the whole asset fits.
    Orbit(Orbit),
    /// As a camera file says.
    Camera(Camera),
    /// From the asset's own camera of this name.
    Named(String),
}

impl Default for Viewpoint {
    fn default() -> Self {
        Self::Orbit(Orbit::default())
    }
}

/// An angle and a distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orbit {
    /// 0 looks at the front (from +Z), 90 from +X, degrees.
    pub azimuth_deg: f64,
    /// Above the horizon, degrees, −89 to 89.
    pub elevation_deg: f64,
    /// Over the distance at which the asset just fits, 0.05 to 100.
    pub distance: f64,
}

impl Default for Orbit {
    fn default() -> Self {
        Self { azimuth_deg: 35.0, elevation_deg: 12.0, distance: 1.0 }
    }
}

impl FromStr for Orbit {
    type Err = Error;

    /// Reads `AZ,EL,DIST`: two angles in degrees and a factor on the distance at which the asset just fits.
    fn from_str(text: &str) -> Result<Self> {
        let fault = || {
            Error::usage("the orbit cannot be read")
                .with_parameter("orbit")
                .with_found(text)
                .with_expected("AZ,EL,DIST: degrees, degrees from -89 to 89, factor from 0.05 to 100")
                .with_hint("`orbit` 35,12,1 is the default")
        };
        let numbers: Vec<f64> =
            text.split(',').map(|n| n.trim().parse()).collect::<std::result::Result<_, _>>().map_err(|_| fault())?;
        let [azimuth_deg, elevation_deg, distance] = numbers[..] else { return Err(fault()) };
        let fine = azimuth_deg.is_finite() && elevation_deg.abs() <= 89.0 && (0.05..=100.0).contains(&distance);
        if fine { Ok(Self { azimuth_deg, elevation_deg, distance }) } else { Err(fault()) }
    }
}

impl Viewpoint {
    /// The camera for a picture of `aspect` (width over height).
    ///
    /// # Errors
    /// [`crate::error::Kind::Usage`] for a camera that sees nothing or that the asset does not have; lists those it has.
    pub fn camera(&self, subject: &Subject, aspect: f64) -> Result<Camera> {
        match self {
            Self::Camera(camera) => *camera,
            Self::Orbit(orbit) => orbit.camera(subject, aspect),
            Self::Named(name) => super::named(&subject.cameras, name, "camera")?,
        }
        .checked()
    }
}

impl Orbit {
    /// The camera that holds the subject's points in the rest pose, each with a ball of its own hair around it. It does not hang on
    /// the hair as drawn, so that every renderer of an asset has the same.
    pub fn camera(&self, subject: &Subject, aspect: f64) -> Camera {
        let (azimuth, elevation) = (self.azimuth_deg.to_radians(), self.elevation_deg.to_radians());
        let back = DVec3::new(azimuth.sin() * elevation.cos(), elevation.sin(), azimuth.cos() * elevation.cos());
        let right = DVec3::Y.cross(back).normalize();
        let up = back.cross(right);
        let seen: Vec<DVec3> = subject
            .points_m
            .iter()
            .map(|p| p.as_dvec3())
            .map(|p| DVec3::new(p.dot(right), p.dot(up), p.dot(back)))
            .collect();
        let slope_y = (0.5 * VFOV_DEG.to_radians()).tan() * (1.0 - MARGIN);
        let slopes = DVec2::new(slope_y * aspect, slope_y);
        // A plane of the frustum leaves room for a ball of radius r where it clears its middle by r, measured at a right angle.
        let room = (slopes * slopes + 1.0).map(f64::sqrt);
        let rooms: Vec<DVec2> = subject.hair_m.iter().map(|&hair_m| room * f64::from(hair_m)).collect();
        let (mut middle, mut distance) = (DVec3::ZERO, 1.0);
        if let Some(&first) = seen.first() {
            let (low, high) = seen.iter().fold((first, first), |(low, high), &p| (low.min(p), high.max(p)));
            middle = 0.5 * (low + high);
            // Perspective moves the outline's middle off that of the box; a few steps settle it.
            for _ in 0..8 {
                let needed = |(p, room): (&DVec3, &DVec2)| {
                    let d = *p - middle;
                    d.z + ((d.truncate().abs() + *room) / slopes).max_element()
                };
                distance = seen.iter().zip(&rooms).map(needed).fold(0.0, f64::max).max(1e-6);
                let project = |p: &DVec3| (*p - middle).truncate() / (distance - (p.z - middle.z)).max(1e-9);
                let start = project(&seen[0]);
                let (low, high) =
                    seen.iter().map(project).fold((start, start), |(low, high), q| (low.min(q), high.max(q)));
                middle += (0.5 * (low + high) * distance).extend(0.0);
            }
        }
        let target = subject.origin_m + right * middle.x + up * middle.y + back * middle.z;
        let eye = target + back * (distance * self.distance);
        Camera { eye: eye.into(), target: target.into(), up: [0.0, 1.0, 0.0], vfov_deg: VFOV_DEG }
    }
}

/// Depths that hold `points_m` in front of `camera`, with some room, m.
pub fn depth_range_m(camera: &Camera, points_m: &[Vec3], origin_m: DVec3) -> [f64; 2] {
    let back = camera.axes()[2];
    let eye = DVec3::from(camera.eye) - origin_m;
    let (low, high) = points_m
        .iter()
        .map(|p| (eye - p.as_dvec3()).dot(back))
        .fold((f64::INFINITY, 0.0_f64), |(low, high), d| (low.min(d), high.max(d)));
    let far = if high > 0.0 { high * 1.001 } else { 1.0 };
    [(low * 0.999).clamp(far * 1e-4, far * 0.999), far]
}
