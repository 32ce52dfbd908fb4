//! A camera made ready to project: world to pixels and back.

use crate::data::camera::Camera;
use crate::error::{Error, Result};
use crate::math::{DVec3, Vec2, Vec3};

/// Nothing nearer than this share of the eye's distance to the target is drawn.
const NEAREST: f32 = 1e-4;

/// The projection of one camera to one film. The middle of pixel (x, y) is at (x + ½, y + ½), rows from the top.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection {
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

impl Projection {
    /// Of a camera, for a film of `size`, in coordinates whose origin lies at `origin_m` in the world.
    ///
    /// # Errors
    /// Names what keeps the camera from looking anywhere.
    pub fn new(camera: &Camera, origin_m: DVec3, size: [usize; 2]) -> Result<Self> {
        let camera = camera.checked()?;
        if size.iter().any(|&n| n == 0 || n > 1 << 15) {
            return Err(Error::usage("there is no such picture")
                .with_field("size")
                .with_found(format!("{} x {}", size[0], size[1]))
                .with_expected("1 to 32768 pixels each way"));
        }
        let [right, up, back] = camera.axes().map(|axis| axis.as_vec3());
        let half = Vec2::new(size[0] as f32, size[1] as f32) * 0.5;
        let eye = DVec3::from(camera.eye);
        Ok(Self {
            eye_m: (eye - origin_m).as_vec3(),
            axes: [right, up, -back],
            focal_px: half.y / libm::tanf(0.5 * camera.vfov_deg.to_radians() as f32),
            size,
            near_m: NEAREST * eye.distance(DVec3::from(camera.target)) as f32,
            centre_px: half,
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
