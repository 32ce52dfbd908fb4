//! Roots step out of partings.

use crate::data::fields::Fields;
use crate::data::mesh::Mesh;
use crate::data::parting::Parting;
use crate::data::strands::Strands;
use crate::data::topology::Topology;
use crate::math::{Vec3, orthonormal_basis};

/// Triangles that a root may cross on its way.
const MOST_STEPS: usize = 64;
/// Barycentric coordinates down to this are inside.
const INSIDE: f32 = -1e-4;

/// A skin with partings, in its rest pose.
pub(super) struct Parted<'a> {
    mesh: &'a Mesh,
    partings: &'a [Parting],
    normals: Vec<Vec3>,
    topology: Topology,
}

impl<'a> Parted<'a> {
    /// Of a skin that has any.
    pub fn new(mesh: &'a Mesh, fields: &'a Fields) -> Option<Self> {
        let normals = || if mesh.rest_m.is_some() { mesh.at_rest().smooth_normals() } else { mesh.smooth_normals() };
        (!fields.partings.is_empty()).then(|| Self {
            mesh,
            partings: &fields.partings,
            normals: normals(),
            topology: Topology::new(&mesh.triangles, |v| mesh.position_class[v as usize]),
        })
    }

    /// Where a root at `b` of triangle `t` stands: in a strip, as far beyond its border as it was inside.
    pub fn out(&self, t: usize, b: Vec3) -> (usize, Vec3) {
        self.partings.iter().fold((t, b), |(t, b), parting| {
            let normal = mix(self.mesh.triangles[t].map(|v| self.normals[v as usize]), b).normalize_or_zero();
            let root_m = mix(self.mesh.rest_corners_m(t), b);
            let Some(off_m) = parting.aside(root_m, normal).map(|aside| aside.off_m) else { return (t, b) };
            let inside_m = 0.5 * parting.width_m - off_m.length();
            if inside_m <= 0.0 {
                return (t, b);
            }
            let out = off_m.try_normalize().unwrap_or_else(|| orthonormal_basis(normal).0);
            self.walk(t, b, root_m + out * (2.0 * inside_m))
        })
    }

    /// The place of the skin below `to_m`, from triangle to triangle; at a border of the skin, the last place on the way.
    fn walk(&self, mut t: usize, mut b: Vec3, to_m: Vec3) -> (usize, Vec3) {
        for _ in 0..MOST_STEPS {
            let Some(there) = barycentric(self.mesh.rest_corners_m(t), to_m) else { return (t, b) };
            b = there.max(Vec3::ZERO) / there.max(Vec3::ZERO).element_sum();
            if there.min_element() >= INSIDE {
                break;
            }
            // Edge k is opposite to corner k + 2.
            let Some(next) = self.topology.neighbour(t, (there.min_position() + 1) % 3) else { break };
            (t, b) = (next, Vec3::splat(1.0 / 3.0));
        }
        (t, b)
    }
}

/// Hairs in the order of their triangles, as growth has them where no root moves.
pub(super) fn in_order(strands: &Strands) -> Strands {
    let mut order: Vec<usize> = (0..strands.len()).collect();
    order.sort_by_key(|&i| strands.roots[i].triangle);
    let mut sorted = strands.none_alike();
    order.into_iter().for_each(|i| sorted.push_alike(strands, i, strands.points_of_m(i).iter().copied(), 1.0));
    sorted
}

/// Coordinates of a point over a triangle's plane; `None` for one without area.
fn barycentric([p, q, r]: [Vec3; 3], at_m: Vec3) -> Option<Vec3> {
    let normal = (q - p).cross(r - p);
    let twice_area = normal.length_squared();
    let share = |from: Vec3, to: Vec3| (to - from).cross(at_m - from).dot(normal) / twice_area;
    let b = Vec3::new(share(q, r), share(r, p), share(p, q));
    (twice_area > 0.0 && b.is_finite()).then_some(b)
}

fn mix(values: [Vec3; 3], b: Vec3) -> Vec3 {
    values[0] * b.x + values[1] * b.y + values[2] * b.z
}
