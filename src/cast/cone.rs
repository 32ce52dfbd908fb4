//! A ray against a segment of hair: the union of spheres whose centre and radius go linearly from end to end.

use crate::data::ray::Ray;
use crate::math::Vec3;

/// A segment of a strand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// End nearer to the root, m.
    pub from_m: Vec3,
    /// End nearer to the tip, m.
    pub to_m: Vec3,
    /// Radius at `from_m`, m.
    pub from_radius_m: f32,
    /// Radius at `to_m`, m.
    pub to_radius_m: f32,
}

/// Where a ray is inside a cone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance to the first contact within the depth range, m.
    pub depth_m: f32,
    /// Distance to the last one on the whole ray, m.
    pub leave_m: f32,
    /// Where along the segment, in [0, 1].
    pub s: f32,
}

impl Cone {
    /// The first contact of `ray` between `near_m` and `far_m`, if any.
    ///
    /// A sphere at s meets the ray's line where D²(s) < r²(s), D the distance of its centre to the line. Both are
    /// quadratic in s, so the segment is met on one interval of s, whose ends and middle give the depths.
    pub fn hit(&self, ray: &Ray, near_m: f32, far_m: f32) -> Option<Hit> {
        let start = self.from_m - ray.origin_m;
        let along = self.to_m - self.from_m;
        let (t0, dt) = (start.dot(ray.direction), along.dot(ray.direction));
        let (e0, de) = (start - ray.direction * t0, along - ray.direction * dt);
        let dr = self.to_radius_m - self.from_radius_m;
        // c + 2 b s + a s² = D² − r² must be negative.
        let a = de.length_squared() - dr * dr;
        let b = e0.dot(de) - self.from_radius_m * dr;
        let c = e0.length_squared() - self.from_radius_m * self.from_radius_m;
        let (low, high) = negative_interval(a, b, c)?;
        let depths = [low, 0.5 * (low + high), high].map(|s| {
            let gap = (c + s * (2.0 * b + a * s)).min(0.0);
            let (middle, half) = (t0 + s * dt, (-gap).sqrt());
            (s, middle - half, middle + half)
        });
        let enter = depths.iter().map(|d| d.1).fold(f32::INFINITY, f32::min);
        let leave = depths.iter().map(|d| d.2).fold(f32::NEG_INFINITY, f32::max);
        if enter > far_m || leave < near_m {
            return None;
        }
        let depth_m = enter.max(near_m);
        // The place along the hair: where its axis passes that depth, kept inside the interval that is met.
        let s = if dt.abs() > 1e-12 { ((depth_m - t0) / dt).clamp(low, high) } else { 0.5 * (low + high) };
        Some(Hit { depth_m, leave_m: leave, s })
    }
}

/// Where in [0, 1] the parabola a s² + 2 b s + c is negative: the interval that holds it.
///
/// Where a < 0 (a cone seen almost along its axis) it may be negative at both ends of [0, 1] with a gap between;
/// the interval then spans the gap, which is thinner than the hair.
fn negative_interval(a: f32, b: f32, c: f32) -> Option<(f32, f32)> {
    let at = |s: f32| c + s * (2.0 * b + a * s);
    let (begin, end) = (c < 0.0, at(1.0) < 0.0);
    let discriminant = b * b - a * c;
    let root = |sign: f32| {
        // The stable form of the quadratic formula, so that small |a| loses nothing.
        let q = -(b + discriminant.max(0.0).sqrt().copysign(b));
        let (x, y) = (q / a, c / q);
        if (sign < 0.0) == (x < y) { x } else { y }
    };
    match (begin, end) {
        (true, true) => Some((0.0, 1.0)),
        (true, false) => Some((0.0, first_inside(root(-1.0), root(1.0), 1.0))),
        (false, true) => Some((first_inside(root(1.0), root(-1.0), 0.0), 1.0)),
        (false, false) => {
            if a <= 0.0 || discriminant <= 0.0 {
                return None;
            }
            let (low, high) = (root(-1.0), root(1.0));
            (low > 0.0 && high < 1.0).then_some((low, high))
        }
    }
}

/// The first of two candidates that lies in [0, 1]; `otherwise` when rounding leaves none.
fn first_inside(x: f32, y: f32, otherwise: f32) -> f32 {
    [x, y].into_iter().find(|s| (0.0..=1.0).contains(s)).unwrap_or(otherwise)
}
