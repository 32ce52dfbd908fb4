//! Texture coordinates: around and along each joint's limb, one chart a joint, all at one scale.

use super::body::weights;
use super::skeleton::JOINTS;
use super::surface::Surface;
use crate::math::{Vec2, Vec3};
use std::collections::HashMap;
use std::f32::consts::{PI, TAU};

/// Columns and rows of chart cells in the unit square.
const CELLS: [usize; 2] = [5, 4];
/// Width of a chart cell on the skin, m: wide enough for the trunk.
const CELL_M: f32 = 0.52;

/// The surface with vertices doubled along chart borders.
pub struct Charted {
    /// Surface vertex of each vertex.
    pub source: Vec<u32>,
    /// In the unit square.
    pub uvs: Vec<Vec2>,
    /// As the surface's.
    pub triangles: Vec<[u32; 3]>,
}

/// A limb: what its chart is rolled around.
struct Limb {
    origin: Vec3,
    axis: Vec3,
    across: [Vec3; 2],
    radius: f32,
}

/// Unrolls a surface.
pub fn unwrap(surface: &Surface) -> Charted {
    let owner: Vec<usize> = surface.positions.iter().map(|&p| usize::from(weights(p).0[0])).collect();
    let limbs: Vec<Limb> = (0..JOINTS.len()).map(|joint| limb(joint, surface, &owner)).collect();
    let mut charted = Charted { source: Vec::new(), uvs: Vec::new(), triangles: Vec::new() };
    let mut known: HashMap<(u32, usize, bool), u32> = HashMap::new();
    for triangle in &surface.triangles {
        // The joint of two corners, else of the first.
        let [a, b, c] = triangle.map(|v| owner[v as usize]);
        let joint = if b == c { b } else { a };
        let limb = &limbs[joint];
        let angles = triangle.map(|v| limb.angle(surface.positions[v as usize]));
        let low = angles.iter().copied().fold(f32::INFINITY, f32::min);
        let high = angles.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        let cut = high - low > PI;
        let mut corners = [0; 3];
        for ((corner, &v), angle) in corners.iter_mut().zip(triangle).zip(angles) {
            // Beyond the cut, angles go on past half a turn.
            let beyond = cut && angle < 0.0;
            *corner = *known.entry((v, joint, beyond)).or_insert_with(|| {
                let angle = if beyond { angle + TAU } else { angle };
                charted.source.push(v);
                charted.uvs.push(place(joint, angle * limb.radius, limb.height(surface.positions[v as usize])));
                charted.source.len() as u32 - 1
            });
        }
        charted.triangles.push(corners);
    }
    charted
}

/// A point of a chart, m, in the unit square.
fn place(joint: usize, around_m: f32, along_m: f32) -> Vec2 {
    let cell = Vec2::new((joint % CELLS[0]) as f32 + 0.5, (joint / CELLS[0]) as f32 + 0.5);
    (cell + Vec2::new(around_m, along_m) / CELL_M) / CELLS[0] as f32
}

fn limb(joint: usize, surface: &Surface, owner: &[usize]) -> Limb {
    let points: Vec<Vec3> = (0..owner.len()).filter(|&v| owner[v] == joint).map(|v| surface.positions[v]).collect();
    let n = points.len().max(1) as f32;
    let origin = points.iter().sum::<Vec3>() / n;
    // The axis along which the limb is longest, by power iteration on its spread.
    let mut axis = origin - Vec3::from_array(JOINTS[joint].at) + Vec3::new(1e-3, 2e-3, 3e-3);
    for _ in 0..20 {
        axis = points.iter().map(|&p| (p - origin) * (p - origin).dot(axis)).sum::<Vec3>().normalize_or(Vec3::Y);
    }
    let (x, y) = crate::math::orthonormal_basis(axis);
    let radius = points.iter().map(|&p| (p - origin).reject_from(axis).length()).sum::<f32>() / n;
    Limb { origin, axis, across: [x, y], radius }
}

impl Limb {
    fn angle(&self, point: Vec3) -> f32 {
        let away = point - self.origin;
        libm::atan2f(away.dot(self.across[1]), away.dot(self.across[0]))
    }

    fn height(&self, point: Vec3) -> f32 {
        (point - self.origin).dot(self.axis)
    }
}
