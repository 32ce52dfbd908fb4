//! The eye: it orbits a point, is moved, flies, frames.

use crate::data::camera::Camera;
use crate::data::subject::Subject;
use crate::math::DVec3;
use crate::stage::camera::{Orbit, Viewpoint};

/// Steepest look up or down, degrees: straight along the axis a camera has no up.
const STEEPEST_DEG: f64 = 89.0;
/// Field of view that a framed subject is seen in where no camera gave another, degrees.
const VFOV_DEG: f64 = 28.0;

/// Where the eye is and what it looks at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eye {
    /// The point it looks at and turns about, m.
    pub target_m: DVec3,
    /// Distance to it, m.
    pub distance_m: f64,
    /// 0 looks at the front, 90 from +X, degrees.
    pub azimuth_deg: f64,
    /// Above the horizon, degrees.
    pub elevation_deg: f64,
    /// Vertical field of view, degrees.
    pub vfov_deg: f64,
    /// Up where a camera of the asset is leaned sideways; +Y once the eye is moved.
    up: DVec3,
}

impl Eye {
    /// Looks as `camera` does.
    pub fn of(camera: &Camera) -> Self {
        let (eye, target) = (DVec3::from(camera.eye), DVec3::from(camera.target));
        let back = (eye - target).normalize_or(DVec3::Z);
        Self {
            target_m: target,
            distance_m: (eye - target).length(),
            azimuth_deg: back.x.atan2(back.z).to_degrees(),
            elevation_deg: back.y.clamp(-1.0, 1.0).asin().to_degrees(),
            vfov_deg: camera.vfov_deg,
            up: DVec3::from(camera.up),
        }
    }

    /// All of the subject, from this direction.
    pub fn framing(subject: &Subject, [azimuth_deg, elevation_deg]: [f64; 2], aspect: f64) -> Self {
        let elevation_deg = elevation_deg.clamp(-STEEPEST_DEG, STEEPEST_DEG);
        let orbit = Orbit { azimuth_deg, elevation_deg, distance: 1.0 };
        Self { azimuth_deg, elevation_deg, vfov_deg: VFOV_DEG, ..Self::of(&orbit.camera(subject, aspect)) }
    }

    /// The camera that was asked for, or the whole subject where there is no such camera.
    pub fn first(viewpoint: &Viewpoint, subject: &Subject, aspect: f64) -> Self {
        match viewpoint.camera(subject, aspect) {
            Ok(camera) => Self::of(&camera),
            Err(_) => Self::framing(subject, [35.0, 12.0], aspect),
        }
    }

    /// As renderers take it.
    pub fn camera(&self) -> Camera {
        let eye = self.target_m + self.back() * self.distance_m;
        Camera { eye: eye.into(), target: self.target_m.into(), up: self.up.into(), vfov_deg: self.vfov_deg }
    }

    fn back(&self) -> DVec3 {
        let (azimuth, elevation) = (self.azimuth_deg.to_radians(), self.elevation_deg.to_radians());
        DVec3::new(azimuth.sin() * elevation.cos(), elevation.sin(), azimuth.cos() * elevation.cos())
    }

    /// To the right, up and towards the viewer.
    fn axes(&self) -> [DVec3; 3] {
        let back = self.back();
        let right = self.up.cross(back).normalize_or(DVec3::X);
        [right, back.cross(right), back]
    }

    /// Turns about the target, degrees to the right and up.
    pub fn orbit(&mut self, right_deg: f64, up_deg: f64) {
        self.up = DVec3::Y;
        self.azimuth_deg = (self.azimuth_deg + right_deg).rem_euclid(360.0);
        self.elevation_deg = (self.elevation_deg + up_deg).clamp(-STEEPEST_DEG, STEEPEST_DEG);
    }

    /// Moves sideways and up, in heights of the picture at the target.
    pub fn pan(&mut self, right: f64, up: f64) {
        let height_m = 2.0 * self.distance_m * (0.5 * self.vfov_deg.to_radians()).tan();
        let [x, y, _] = self.axes();
        self.target_m += (x * right + y * up) * height_m;
    }

    /// Nearer (below 1) or further away, by a factor.
    pub fn zoom(&mut self, factor: f64) {
        if factor.is_finite() && factor > 0.0 {
            self.distance_m = (self.distance_m * factor).clamp(1e-4, 1e6);
        }
    }

    /// Flies: the eye and what it looks at move together, m to the right, up and forward.
    pub fn fly(&mut self, [right_m, up_m, forward_m]: [f64; 3]) {
        let [x, y, back] = self.axes();
        self.target_m += x * right_m + y * up_m - back * forward_m;
    }

    /// Turns the head: the eye stays where it is, degrees to the right and up.
    pub fn look(&mut self, right_deg: f64, up_deg: f64) {
        let eye = self.target_m + self.back() * self.distance_m;
        self.orbit(right_deg, up_deg);
        self.target_m = eye - self.back() * self.distance_m;
    }
}
