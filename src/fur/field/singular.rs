//! Where a direction field turns round itself.

use super::smooth::transport;
use crate::data::mesh::Mesh;
use crate::math::Vec3;
use serde::{Deserialize, Serialize};
use std::f32::consts::TAU;

/// A point without direction.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Singularity {
    /// The triangle that holds it.
    pub triangle: u32,
    /// How often the field turns round it, counter-clockwise: 1 for a crown, −1 for a saddle.
    pub index: i32,
    /// The triangle's middle, m.
    pub position_m: Vec3,
}

/// All singularities of `direction`. Over a closed surface their indices add up to its Euler characteristic (Poincaré
/// and Hopf), as the turns along shared edges cancel and the transports round all triangles add up to its curvature.
pub(super) fn find(mesh: &Mesh, normals: &[Vec3], direction: &[Vec3]) -> Vec<Singularity> {
    let index = |t: usize| {
        let corners = mesh.triangles[t].map(|v| mesh.position_class[v as usize] as usize);
        let mut turn = 0.0;
        // A vector carried round the triangle comes back turned by the curvature inside.
        let mut carried = direction[corners[0]];
        for k in 0..3 {
            let (i, j) = (corners[k], corners[(k + 1) % 3]);
            if direction[i] == Vec3::ZERO || normals[i].dot(normals[j]) <= 0.0 {
                return 0;
            }
            turn += angle(normals[j], transport(direction[i], normals[i], normals[j]), direction[j]);
            carried = transport(carried, normals[i], normals[j]);
        }
        let holonomy = angle(normals[corners[0]], direction[corners[0]], carried);
        ((turn + holonomy) / TAU).round() as i32
    };
    (0..mesh.triangles.len())
        .filter_map(|t| match index(t) {
            0 => None,
            index => {
                let position_m = mesh.corners_m(t).iter().sum::<Vec3>() / 3.0;
                Some(Singularity { triangle: t as u32, index, position_m })
            }
        })
        .collect()
}

/// Angle from `a` to `b` about `n`, in (−π, π].
fn angle(n: Vec3, a: Vec3, b: Vec3) -> f32 {
    libm::atan2f(a.cross(b).dot(n), a.dot(b))
}
