//! Triangles on the picture, without clipping: a pixel's ray against the planes through the eye and each edge (Olano and
//! Greer 1997, "Triangle scan conversion using 2D homogeneous coordinates"). Serves triangles that reach behind the eye.

use crate::math::{Vec2, Vec3};
use crate::stage::projection::Projection;
use crate::volume::bins::Reach;

/// A triangle ready to be met by the rays of a view.
#[derive(Clone, Copy, Debug)]
pub struct Flat {
    /// Inward normals of the planes through the eye and the edges, opposite to corner 0, 1, 2; camera axes.
    planes: [Vec3; 3],
    volume: f32,
}

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScreenHit {
    /// Depth along the optical axis, m.
    pub z_m: f32,
    /// Barycentric coordinates.
    pub barycentric: Vec3,
}

impl Flat {
    /// Of corners in camera axes. Positive `facing` is counter-clockwise as seen from the eye.
    pub fn new([a, b, c]: [Vec3; 3]) -> Self {
        let planes = [b.cross(c), c.cross(a), a.cross(b)];
        Self { planes, volume: a.dot(planes[0]) }
    }

    /// Whether the eye sees the counter-clockwise side. The camera's y points down, so that side has negative volume.
    pub fn faces_eye(&self) -> bool {
        self.volume < 0.0
    }

    /// Depth along the optical axis at which the ray along (x, y, 1) meets the triangle's plane, m; negative or infinite
    /// where it does not.
    pub fn plane_depth(&self, ray: Vec3) -> f32 {
        self.volume / (self.planes[0] + self.planes[1] + self.planes[2]).dot(ray)
    }

    /// Meets the ray along (x, y, 1) in camera axes, from either side.
    pub fn meet(&self, ray: Vec3) -> Option<ScreenHit> {
        let e = self.planes.map(|plane| plane.dot(ray));
        let inside = (e[0] >= 0.0 && e[1] >= 0.0 && e[2] >= 0.0) || (e[0] <= 0.0 && e[1] <= 0.0 && e[2] <= 0.0);
        let sum = e[0] + e[1] + e[2];
        if !inside || sum == 0.0 {
            return None;
        }
        let z_m = self.volume / sum;
        (z_m > 0.0).then(|| ScreenHit { z_m, barycentric: Vec3::from(e) / sum })
    }
}

/// What a triangle in camera axes may touch: everything where it reaches behind the near plane.
pub fn reach(view: &Projection, corners: &[Vec3; 3]) -> Reach {
    let behind = corners.iter().filter(|p| p.z <= view.near_m).count();
    if behind == 3 {
        return Reach::NOTHING;
    }
    if behind > 0 {
        return Reach::EVERYTHING;
    }
    let mut reach = Reach::NOTHING;
    for &corner in corners {
        let pixel = view.pixel(corner);
        reach.add(pixel.x, pixel.y, 0.0);
    }
    reach
}

/// The ray through the middle of pixel (x, y), in camera axes, of depth 1.
pub fn pixel_ray(view: &Projection, x: usize, y: usize) -> Vec3 {
    ((Vec2::new(x as f32 + 0.5, y as f32 + 0.5) - view.centre_px) / view.focal_px).extend(1.0)
}
