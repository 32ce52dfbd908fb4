//! Signs drawn on the skin.

use super::colours::INK;
use crate::math::Vec3;
use crate::runtime::SkinMesh;

/// Small signs on the skin, all in one surface.
#[derive(Default)]
pub(super) struct Shapes<'a>(pub SkinMesh<'a>);

impl Shapes<'_> {
    fn push(&mut self, corners: [(Vec3, Vec3); 3], colour: Vec3) {
        let first = self.0.positions_m.len() as u32;
        for (position_m, normal) in corners {
            self.0.positions_m.push(position_m);
            self.0.normals.push(normal);
            self.0.colour.push(colour);
        }
        self.0.triangles.push([first, first + 1, first + 2]);
    }

    /// A stroke along the hair, wide at the root.
    pub fn stroke(&mut self, p: Vec3, normal: Vec3, along: Vec3, size_m: f32) {
        let lifted = p + normal * (0.12 * size_m);
        let side = normal.cross(along) * (0.13 * size_m);
        let (root, tip) =
            (lifted - along * (0.42 * size_m), lifted + along * (0.42 * size_m) + normal * (0.06 * size_m));
        self.push([(root - side, normal), (tip, normal), (root + side, normal)], INK);
    }

    /// A line on the skin between two points.
    pub fn line(&mut self, ends: [Vec3; 2], normal: Vec3, width_m: f32) {
        let [a, b] = ends.map(|p| p + normal * (0.5 * width_m));
        let side = normal.cross(b - a).normalize_or_zero() * (0.5 * width_m);
        self.push([(a - side, normal), (b - side, normal), (b + side, normal)], INK);
        self.push([(a - side, normal), (b + side, normal), (a + side, normal)], INK);
    }

    /// A ball: an octahedron whose faces are divided in 16.
    pub fn ball(&mut self, centre_m: Vec3, radius_m: f32, colour: Vec3) {
        for octant in 0..8 {
            let axis = |bit: u32| if octant >> bit & 1 == 0 { 1.0 } else { -1.0 };
            let [x, y, z] = [Vec3::X * axis(0), Vec3::Y * axis(1), Vec3::Z * axis(2)];
            let cells = 4;
            let at = |i: i32, j: i32| {
                let n = (x * i as f32 + y * j as f32 + z * (cells - i - j) as f32).normalize();
                (centre_m + n * radius_m, n)
            };
            for i in 0..cells {
                for j in 0..cells - i {
                    self.push([at(i, j), at(i + 1, j), at(i, j + 1)], colour);
                    if i + j + 1 < cells {
                        self.push([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)], colour);
                    }
                }
            }
        }
    }
}
