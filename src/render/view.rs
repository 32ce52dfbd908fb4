//! A camera made ready to project: world to pixels and back.

use super::rays::Camera;
use crate::error::{Error, Result};
use crate::math::{Vec2, Vec3};

/// Nothing nearer than this share of the eye's distance to the target is drawn.
const NEAREST: f32 = 1e-4;

/// The projection of one camera to one film. The middle of pixel (x, y) is at (x + ½, y + ½), rows from the top.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Position, m.
    pub eye_m: Vec3,
    /// Unit vectors: to the right, up, and into the picture.
    pub axes: [Vec3; 3],
    /// Distance of the picture's plane, in pixels.
    pub focal_px: f32,
    /// Pixels per row and rows.
    pub size: [usize; 2],
    /// Smallest depth that is drawn, m.
    pub near_m: f32,
    /// Where the optical axis meets the picture, px.
    pub centre_px: Vec2,
}

impl View {
    /// Of a camera, for a film of `size`, all pixels moved by `shift_px` (for supersampling).
    ///
    /// # Errors
    /// Names what keeps the camera from looking anywhere.
    pub fn new(camera: &Camera, size: [usize; 2], shift_px: Vec2) -> Result<Self> {
        let fault = |field: &str, found: String, expected: &str| {
            Err(Error::usage("the camera does not look anywhere")
                .with_field(field)
                .with_found(found)
                .with_expected(expected))
        };
        let towards = camera.target_m - camera.eye_m;
        let forward = towards.normalize_or_zero();
        let right = forward.cross(camera.up).normalize_or_zero();
        if forward == Vec3::ZERO || !camera.eye_m.is_finite() {
            return fault("target", camera.target_m.to_string(), "a point away from the eye");
        }
        if right == Vec3::ZERO {
            return fault("up", camera.up.to_string(), "a direction across the line of sight");
        }
        if !(1e-3..3.1).contains(&camera.vfov_rad) {
            return fault("vfov_deg", camera.vfov_rad.to_degrees().to_string(), "0.1 to 177");
        }
        if size.iter().any(|&n| n == 0 || n > 1 << 15) {
            return fault("size", format!("{} x {}", size[0], size[1]), "1 to 32768 pixels each way");
        }
        let half = Vec2::new(size[0] as f32, size[1] as f32) * 0.5;
        Ok(Self {
            eye_m: camera.eye_m,
            axes: [right, right.cross(forward), forward],
            focal_px: half.y / libm::tanf(0.5 * camera.vfov_rad),
            size,
            near_m: NEAREST * towards.length(),
            centre_px: half - shift_px,
        })
    }

    /// From the eye, along the camera's axes: to the right, down, and into the picture, m.
    pub fn camera_from_world(&self, point_m: Vec3) -> Vec3 {
        let p = point_m - self.eye_m;
        Vec3::new(p.dot(self.axes[0]), -p.dot(self.axes[1]), p.dot(self.axes[2]))
    }

    /// Pixel coordinates of a point in camera axes; its depth must be positive.
    pub fn pixel(&self, camera_m: Vec3) -> Vec2 {
        Vec2::new(camera_m.x, camera_m.y) * (self.focal_px / camera_m.z) + self.centre_px
    }

    /// Direction from the eye through a point of the picture, of depth 1: not of unit length.
    pub fn direction(&self, pixel: Vec2) -> Vec3 {
        let p = (pixel - self.centre_px) / self.focal_px;
        self.axes[0] * p.x - self.axes[1] * p.y + self.axes[2]
    }
}
