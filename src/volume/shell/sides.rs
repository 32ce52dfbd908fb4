//! Where straight lines in prism coordinates leave a prism, and where they go on.

use super::prism::ShellPoint;
use super::prisms::ShellPoints;
use crate::math::lanes::{F32s, Isa, Vec3s};

/// The sides that straight lines in coordinates pass first, and after what distance: the edges opposite to corners 0, 1
/// and 2, then the top, at height `top`, and skin.
#[inline(always)]
pub fn next_side<I: Isa>(points: &ShellPoints<I>, rates: Vec3s<I>, top: f32) -> (F32s<I>, F32s<I>) {
    let mut side = F32s::splat(3.0);
    let mut after = F32s::splat(f32::INFINITY);
    let b = points.barycentric();
    let left = [
        (b.x, -rates.x - rates.y),
        (b.y, rates.x),
        (b.z, rates.y),
        (F32s::splat(top) - points.t, -rates.z),
        (points.t, rates.z),
    ];
    for (i, (left, rate)) in left.into_iter().enumerate() {
        let distance = left / -rate;
        let first = rate.lt(F32s::splat(0.0)) & distance.lt(after);
        side = first.select(F32s::splat(i as f32), side);
        after = first.select(distance, after);
    }
    (side, after)
}

/// A point on the edge opposite to `corner`, in the neighbour whose `opposite` corner lies beyond it.
///
/// The neighbour runs through the shared edge the other way around.
pub fn across(point: &ShellPoint, corner: usize, opposite: usize) -> ShellPoint {
    let b = point.barycentric().to_array();
    let mut beyond = [0.0; 3];
    beyond[(opposite + 1) % 3] = b[(corner + 2) % 3];
    beyond[(opposite + 2) % 3] = b[(corner + 1) % 3];
    let sum = beyond[0] + beyond[1] + beyond[2];
    let scale = if sum > 0.0 { 1.0 / sum } else { 0.0 };
    ShellPoint { b: [beyond[1] * scale, beyond[2] * scale], t: point.t }
}
