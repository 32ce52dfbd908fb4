//! The skin's triangles in f64.

use super::bvh::{Bounds, DBvh, DRay};
use super::point::DShellPoint;
use crate::data::mesh::Mesh;
use crate::math::DVec3;

/// All triangles in one hierarchy.
#[derive(Debug)]
pub struct SkinBvh {
    corners_m: Vec<[DVec3; 3]>,
    bvh: DBvh,
}

impl SkinBvh {
    /// Of a mesh.
    pub fn new(mesh: &Mesh) -> Self {
        let corners_m: Vec<[DVec3; 3]> =
            (0..mesh.triangles.len()).map(|t| mesh.corners_m(t).map(|p| p.as_dvec3())).collect();
        let bounds: Vec<Bounds> = corners_m.iter().map(|&corners| Bounds::of(corners, 0.0)).collect();
        Self { corners_m, bvh: DBvh::new(&bounds) }
    }

    /// The plane of a triangle.
    pub fn plane(&self, triangle: u32) -> Plane {
        let [a, b, c] = self.corners_m[triangle as usize];
        Plane { point_m: a, normal: (b - a).cross(c - a) }
    }

    /// The first triangle that a ray meets after `near_m`, from either side; the one with the lower index of equals.
    pub fn meet(&self, ray: &DRay, near_m: f64) -> Option<(f64, DShellPoint)> {
        let mut best: Option<(f64, DShellPoint)> = None;
        self.bvh.visit(ray, near_m, f64::INFINITY, |triangle, far| {
            let Some((at_m, b)) = meet(&self.corners_m[triangle as usize], ray) else { return far };
            let nearer = best.is_none_or(|(best_m, point)| (at_m, triangle) < (best_m, point.triangle));
            if at_m <= near_m || !nearer {
                return far;
            }
            best = Some((at_m, DShellPoint { triangle, b, t: 0.0 }));
            at_m
        });
        best
    }
}

/// The plane of a triangle of the skin.
#[derive(Clone, Copy, Debug)]
pub struct Plane {
    point_m: DVec3,
    normal: DVec3,
}

impl Plane {
    /// Where a ray meets it, m; NaN or infinite where it never does.
    pub fn meet_m(&self, ray: &DRay) -> f64 {
        (self.point_m - ray.origin_m).dot(self.normal) / ray.direction.dot(self.normal)
    }
}

/// Distance and barycentric coordinates (Möller and Trumbore 1997).
fn meet([a, b, c]: &[DVec3; 3], ray: &DRay) -> Option<(f64, DVec3)> {
    let (e1, e2) = (*b - *a, *c - *a);
    let p = ray.direction.cross(e2);
    let determinant = e1.dot(p);
    if determinant == 0.0 {
        return None;
    }
    let to = (ray.origin_m - *a) / determinant;
    let u = to.dot(p);
    let q = to.cross(e1);
    let v = ray.direction.dot(q);
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0).then(|| (e2.dot(q), DVec3::new(1.0 - u - v, u, v)))
}
