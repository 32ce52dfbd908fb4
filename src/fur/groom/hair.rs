//! The course of one hair in shell space: root at the origin, z along the mean lean, x along the comb.
//!
//! A cubic Bézier from root to tip (Andersen et al. 2016 §3.1) that bends along the comb without a mean lean, then
//! sheared by the hair's own jitter, displaced by noise, wound into a helix and pulled to its clump.

use super::Shape;
use crate::math::hash::Stream;
use crate::math::{Vec2, Vec3};
use std::f32::consts::TAU;

/// Least share of a hair's length that curl leaves for its rise.
const LEAST_RISE: f32 = 0.3;

/// Points that hold the shape to about a hundredth of the length: more for bends, more still for windings.
pub fn points_per_strand(shape: &Shape) -> usize {
    let bends = (shape.bend_deg / 15.0).ceil();
    let sways = if shape.noise > 0.0 || shape.clump.strength > 0.0 { 5.0 } else { 0.0 };
    let windings = if shape.curl.radius_mm > 0.0 { 10.0 * shape.curl.turns } else { 0.0 };
    2 + bends.max(sways).max(windings) as usize
}

/// Share of the length that the helix leaves for the rise, and the radius it then has, m.
fn helix(shape: &Shape, length_m: f32) -> (f32, f32) {
    let circumference = TAU * shape.curl.radius_mm * 1e-3 * shape.curl.turns;
    if circumference <= 0.0 || length_m <= 0.0 {
        return (1.0, 0.0);
    }
    let widest = length_m * (1.0 - LEAST_RISE * LEAST_RISE).sqrt();
    let shrink = (widest / circumference).min(1.0);
    let wound = shrink * circumference / length_m;
    ((1.0 - wound * wound).sqrt(), shrink * shape.curl.radius_mm * 1e-3)
}

/// Rise of a bent hair over its length: the chord of an arc.
fn bend_rise(shape: &Shape) -> f32 {
    let half = 0.5 * shape.bend_deg.to_radians();
    if half < 1e-3 { 1.0 } else { libm::sinf(half) / half }
}

/// Height of a hair of this length that nothing but bend and curl shortens, m.
pub fn height(shape: &Shape, length_m: f32) -> f32 {
    length_m * bend_rise(shape) * helix(shape, length_m).0
}

/// Writes the points of one hair, root first.
///
/// `key` alone decides what is random in it; `to_clump_m` leads from its root to the centre of its clump.
pub fn shape_hair(shape: &Shape, length_m: f32, key: u64, to_clump_m: Vec2, points_m: &mut [Vec3]) {
    let mut random = Stream::new(key);
    let tangent = libm::tanf(shape.jitter_deg.to_radians());
    let jitter = Vec2::new(random.normal(), random.normal()) * tangent;
    let sway = [random.normal(), random.normal(), random.normal(), random.normal()].map(|n| n * shape.noise * length_m);
    let phase = TAU * random.unit();
    let (rise, radius_m) = helix(shape, length_m);

    let half = 0.5 * shape.bend_deg.to_radians();
    let handle = Vec3::new(libm::sinf(half), 0.0, libm::cosf(half)) * (length_m / 3.0);
    let end = Vec3::Z * (length_m * bend_rise(shape));
    let control = [Vec3::ZERO, Vec3::new(-handle.x, 0.0, handle.z), end - handle, end];

    let shrink = 1.0 / (1.0 + jitter.length_squared()).sqrt();
    let last = (points_m.len() - 1) as f32;
    for (i, point) in points_m.iter_mut().enumerate() {
        let s = i as f32 / last;
        let mut p = bezier(&control, s);
        p.z *= rise;
        p = Vec3::new(p.x + p.z * jitter.x, p.y + p.z * jitter.y, p.z) * shrink;
        let bow = libm::sinf(std::f32::consts::PI * s);
        p.x += sway[0] * s * s + sway[1] * bow;
        p.y += sway[2] * s * s + sway[3] * bow;
        if radius_m > 0.0 {
            let (sin, cos) = libm::sincosf(TAU * shape.curl.turns * s + phase);
            let opening = 1.0 - (1.0 - s).powi(4);
            p.x += radius_m * opening * cos;
            p.y += radius_m * opening * sin;
        }
        let pull = shape.clump.strength * s * s.sqrt();
        p.x += pull * to_clump_m.x;
        p.y += pull * to_clump_m.y;
        *point = p;
    }
}

fn bezier(c: &[Vec3; 4], s: f32) -> Vec3 {
    let r = 1.0 - s;
    c[0] * (r * r * r) + c[1] * (3.0 * r * r * s) + c[2] * (3.0 * r * s * s) + c[3] * (s * s * s)
}
