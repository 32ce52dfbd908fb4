//! The creature's shape: cones with round ends, melted together.

use super::skeleton::{CHEST, EAR_LEFT, FRONT_LEFT, HEAD, HIND_LEFT, HIPS, JOINTS, NECK, TAIL};
use crate::math::{Vec3, Vec4};
use std::sync::LazyLock;

/// Over what distance limbs melt into one another, m.
const MELT_M: f32 = 0.009;

/// A cone with round ends that moves with a joint.
#[derive(Clone, Copy, Debug)]
struct Limb {
    joint: usize,
    ends: [Vec3; 2],
    radii: [f32; 2],
    /// How much thinner than wide it is along z.
    flat: f32,
}

impl Limb {
    /// Distance to its surface, m; not quite Euclidean.
    fn distance(&self, point: Vec3) -> f32 {
        let axis = self.ends[1] - self.ends[0];
        let t = ((point - self.ends[0]).dot(axis) / axis.length_squared()).clamp(0.0, 1.0);
        let away = point - (self.ends[0] + axis * t);
        let radius = self.radii[0] + (self.radii[1] - self.radii[0]) * t;
        (Vec3::new(away.x, away.y, away.z * self.flat).length() - radius) / (1.0 + 0.35 * (self.flat - 1.0))
    }
}

/// All limbs; what is given for the left side stands on both.
static LIMBS: LazyLock<Vec<Limb>> = LazyLock::new(|| {
    let mut limbs = Vec::new();
    let mut chain = |joint: usize, sides: bool, flat: f32, points: &[[f32; 4]]| {
        let mirror: &[f32] = if sides { &[1.0, -1.0] } else { &[1.0] };
        for (right, side) in mirror.iter().enumerate() {
            for pair in points.windows(2) {
                let end = |p: [f32; 4]| Vec3::new(p[0] * side, p[1], p[2]);
                limbs.push(Limb {
                    joint: if right == 1 { JOINTS[joint].mirror } else { joint },
                    ends: [end(pair[0]), end(pair[1])],
                    radii: [pair[0][3], pair[1][3]],
                    flat,
                });
            }
        }
    };
    // x, y, z, radius, m.
    chain(HIPS, false, 1.0, &[[0.0, 0.205, -0.135, 0.058], [0.0, 0.204, -0.060, 0.058]]);
    chain(CHEST, false, 1.0, &[[0.0, 0.204, -0.020, 0.058], [0.0, 0.212, 0.060, 0.068], [0.0, 0.222, 0.105, 0.062]]);
    chain(NECK, false, 1.0, &[[0.0, 0.240, 0.120, 0.052], [0.0, 0.315, 0.185, 0.045]]);
    chain(HEAD, false, 1.0, &[[0.0, 0.352, 0.195, 0.056], [0.0, 0.350, 0.228, 0.054]]);
    chain(HEAD, true, 1.0, &[[0.024, 0.334, 0.205, 0.044], [0.036, 0.326, 0.232, 0.030]]);
    chain(HEAD, false, 1.0, &[[0.0, 0.338, 0.262, 0.030], [0.0, 0.324, 0.325, 0.0125]]);
    chain(
        EAR_LEFT,
        true,
        2.0,
        &[[0.037, 0.388, 0.200, 0.028], [0.055, 0.432, 0.196, 0.020], [0.068, 0.470, 0.192, 0.004]],
    );
    chain(FRONT_LEFT, true, 1.0, &[[0.040, 0.195, 0.098, 0.040], [0.046, 0.112, 0.084, 0.023]]);
    chain(
        FRONT_LEFT + 1,
        true,
        1.0,
        &[[0.046, 0.112, 0.084, 0.022], [0.045, 0.036, 0.094, 0.015], [0.045, 0.019, 0.112, 0.018]],
    );
    chain(HIND_LEFT, true, 1.0, &[[0.038, 0.195, -0.128, 0.050], [0.048, 0.122, -0.098, 0.029]]);
    chain(
        HIND_LEFT + 1,
        true,
        1.0,
        &[
            [0.048, 0.122, -0.098, 0.028],
            [0.046, 0.070, -0.158, 0.0165],
            [0.046, 0.020, -0.146, 0.016],
            [0.046, 0.018, -0.122, 0.018],
        ],
    );
    chain(TAIL, false, 1.0, &[[0.0, 0.222, -0.170, 0.022], [0.0, 0.212, -0.245, 0.022]]);
    chain(TAIL + 1, false, 1.0, &[[0.0, 0.212, -0.245, 0.024], [0.0, 0.186, -0.325, 0.030]]);
    chain(
        TAIL + 2,
        false,
        1.0,
        &[[0.0, 0.186, -0.325, 0.030], [0.0, 0.182, -0.400, 0.026], [0.0, 0.200, -0.455, 0.007]],
    );
    limbs
});

/// Distance to the skin, m, negative inside: a smooth minimum over all limbs.
pub fn distance(point: Vec3) -> f32 {
    let mut nearest = f32::INFINITY;
    let mut sum = 0.0;
    for limb in LIMBS.iter() {
        let d = limb.distance(point);
        // A running log-sum-exp; what is far beyond the nearest adds nothing.
        if d < nearest {
            sum = if nearest.is_finite() { sum * libm::expf((d - nearest) / MELT_M) } else { 0.0 } + 1.0;
            nearest = d;
        } else if d - nearest < 8.0 * MELT_M {
            sum += libm::expf((nearest - d) / MELT_M);
        }
    }
    nearest - MELT_M * libm::logf(sum)
}

/// The four joints that hold a point, and how much each does.
pub fn weights(point: Vec3) -> ([u8; 4], Vec4) {
    let mut nearest = [f32::INFINITY; JOINTS.len()];
    for limb in LIMBS.iter() {
        nearest[limb.joint] = nearest[limb.joint].min(limb.distance(point));
    }
    let mut order: Vec<usize> = (0..JOINTS.len()).collect();
    order.sort_by(|&a, &b| nearest[a].total_cmp(&nearest[b]));
    let joints = std::array::from_fn(|i| order[i] as u8);
    let raw = std::array::from_fn(|i| libm::expf((nearest[order[0]] - nearest[order[i]]) / 0.011));
    let raw = Vec4::from_array(raw);
    (joints, raw / raw.element_sum())
}
