//! A pinhole camera in f64, its pixels, and where lines lie in them.

use super::bvh::Beam;
use super::line::Line;
use crate::data::camera::Camera;
use crate::math::DVec3;
use crate::math::hash::{combine, unit_f64};

/// Parts of a line that take undercoat and skin from one point each.
pub const PARTS: usize = 4;

/// A pinhole camera in f64.
#[derive(Debug)]
pub struct Pinhole {
    eye_m: DVec3,
    axes: [DVec3; 3],
    middle: [f64; 2],
    focal_px: f64,
}

impl Pinhole {
    /// Of a camera.
    pub fn new(camera: &Camera, origin_m: DVec3, size: [usize; 2]) -> Self {
        let [right, up, back] = camera.axes();
        let middle = size.map(|n| 0.5 * n as f64);
        let focal_px = middle[1] / libm::tan(0.5 * camera.vfov_deg.to_radians());
        Self { eye_m: DVec3::from(camera.eye) - origin_m, axes: [right, up, -back], middle, focal_px }
    }

    fn direction(&self, x: f64, y: f64) -> DVec3 {
        let across = (x - self.middle[0]) / self.focal_px;
        let down = (y - self.middle[1]) / self.focal_px;
        self.axes[0] * across - self.axes[1] * down + self.axes[2]
    }

    /// The pixel with this corner.
    pub fn pixel(&self, corner: [f64; 2]) -> PinholePixel<'_> {
        PinholePixel { lens: self, corner }
    }
}

/// A pixel, 1 wide and high.
#[derive(Clone, Copy, Debug)]
pub struct PinholePixel<'a> {
    lens: &'a Pinhole,
    corner: [f64; 2],
}

impl PinholePixel<'_> {
    fn direction(&self, x: f64, y: f64) -> DVec3 {
        self.lens.direction(self.corner[0] + x, self.corner[1] + y)
    }

    /// A row of it.
    pub fn row(&self, at: f64) -> Line {
        Line { eye_m: self.lens.eye_m, base: self.direction(0.0, at), step: self.lens.axes[0] / self.lens.focal_px }
    }

    /// A column of it.
    pub fn column(&self, at: f64) -> Line {
        Line { eye_m: self.lens.eye_m, base: self.direction(at, 0.0), step: -self.lens.axes[1] / self.lens.focal_px }
    }

    /// All that may be seen in it.
    pub fn beam(&self) -> Beam {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| self.direction(x, y));
        Beam::new(self.lens.eye_m, corners, self.lens.axes[2])
    }

    /// Distance of a sphere ahead, m, and between which columns and rows it lies, somewhat generously.
    pub fn bounds(&self, centre_m: DVec3, radius_m: f64) -> (f64, [[f64; 2]; 2]) {
        let lens = self.lens;
        let to = centre_m - lens.eye_m;
        let ahead_m = to.dot(lens.axes[2]);
        let near_m = ahead_m - radius_m;
        if near_m <= radius_m {
            return (near_m, [[f64::NEG_INFINITY, f64::INFINITY]; 2]);
        }
        let half = 1.01 * lens.focal_px * radius_m / near_m * to.length() / ahead_m;
        let middle = [to.dot(lens.axes[0]), -to.dot(lens.axes[1])];
        let bounds = |i: usize| {
            let at = middle[i] / ahead_m * lens.focal_px + lens.middle[i] - self.corner[i];
            [at - half, at + half]
        };
        (near_m, [bounds(0), bounds(1)])
    }
}

/// Where line `i` of `count` lies in a pixel, and at which points of it undercoat and skin are looked for.
///
/// Two and two lie opposite each other about the middle of an even share, and so do the points on them: what changes
/// linearly over such a share is no error.
pub fn point(i: usize, count: usize, key: u64) -> (f64, [f64; PARTS]) {
    let pair = i / 2;
    let key = combine(combine(key, !2), pair as u64);
    // The last of an odd number is alone.
    let alone = 2 * pair + 1 == count;
    let mirrored = |unit: f64| if i % 2 == 1 { 1.0 - unit } else { unit };
    let width = if alone { 1.0 } else { 2.0 };
    let at = ((2 * pair) as f64 + width * mirrored(unit_f64(key))) / count as f64;
    (at, std::array::from_fn(|part| (part as f64 + mirrored(unit_f64(combine(key, 1 + part as u64)))) / PARTS as f64))
}
