//! One triangle laid into its own plane, and what texture coordinates do to it.

use crate::data::mesh::Mesh;
use crate::math::{DVec2, DVec3, Vec3};

/// A triangle's corners in its own plane, in metres: the first at the origin, the second on the x axis, all with the
/// normal towards the reader.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Face {
    /// Second and third corner.
    pub corner_m: [DVec2; 2],
    /// The plane's axes in the world; zero where the triangle has no area.
    pub axes: [DVec3; 2],
    /// Area; 0 also for triangles too thin for their plane to be known.
    pub area_m2: f64,
}

/// Below this share of its longest edge, a triangle's height is rounding (f32 positions carry 2⁻²⁴ of their size).
const THIN: f64 = 1e-7;

impl Face {
    /// The face with the given corners.
    pub fn new(corners_m: [Vec3; 3]) -> Self {
        let [p, q, r] = corners_m.map(Vec3::as_dvec3);
        let (a, b) = (q - p, r - p);
        let normal = a.cross(b);
        let longest = a.length_squared().max(b.length_squared()).max((b - a).length_squared());
        if normal.length_squared() <= (THIN * longest) * (THIN * longest) || normal.length_squared() == 0.0 {
            let x = a.normalize_or(b.normalize_or_zero());
            return Self { corner_m: [a, b].map(|p| DVec2::new(p.dot(x), 0.0)), ..Self::default() };
        }
        let x = a.normalize();
        let y = normal.normalize().cross(x);
        Self {
            corner_m: [DVec2::new(a.length(), 0.0), DVec2::new(b.dot(x), b.dot(y))],
            axes: [x, y],
            area_m2: 0.5 * normal.length(),
        }
    }

    /// Every triangle of `mesh`.
    pub fn all(mesh: &Mesh) -> Vec<Self> {
        (0..mesh.triangles.len()).map(|t| Self::new(mesh.corners_m(t))).collect()
    }

    /// A world direction in the plane's axes.
    pub fn flatten(&self, direction: DVec3) -> DVec2 {
        DVec2::new(direction.dot(self.axes[0]), direction.dot(self.axes[1]))
    }

    /// Columns ∂(u, v)/∂x and ∂(u, v)/∂y of the map that sends the corners to `uv`, per metre; `None` without area.
    pub fn jacobian(&self, uv: [DVec2; 3]) -> Option<[DVec2; 2]> {
        if self.area_m2 == 0.0 {
            return None;
        }
        let (a, b) = (uv[1] - uv[0], uv[2] - uv[0]);
        let x = a / self.corner_m[0].x;
        Some([x, (b - x * self.corner_m[1].x) / self.corner_m[1].y])
    }

    /// The corners in the plane.
    pub fn corners_m(&self) -> [DVec2; 3] {
        [DVec2::ZERO, self.corner_m[0], self.corner_m[1]]
    }

    /// The comb over this face in its axes: the mean of its corners' directions, each first turned into the plane, of
    /// length 0 (none, or they disagree) to 1.
    pub fn comb(&self, corners: [Vec3; 3]) -> DVec2 {
        corners.map(|d| self.flatten(d.as_dvec3()).normalize_or_zero()).iter().sum::<DVec2>() / 3.0
    }
}

/// Singular values, larger first, of the map with the given columns.
pub(super) fn singular_values([x, y]: [DVec2; 2]) -> [f64; 2] {
    // The two circles that a linear map of the plane adds: one turns with it, one against it (Blinn 1996).
    let with = DVec2::new(x.x + y.y, x.y - y.x).length();
    let against = DVec2::new(x.x - y.y, x.y + y.x).length();
    [0.5 * (with + against), 0.5 * (with - against).abs()]
}
