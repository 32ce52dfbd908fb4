//! How directions spread: whether hair can stand so that it leaves every one of several faces.

use crate::math::Vec3;

/// Least sine of the angle between hair and any face that it leaves: a shell whose offset lies in the skin would have no height.
pub const LEAST_RISE: f32 = 0.17;

/// A direction that leaves all of them as steeply as this is good enough.
const STEEP: f32 = 0.4;

/// How often a direction is turned towards the face that it leaves least.
const ROUNDS: usize = 64;

/// The unit direction that leaves the one of these unit normals that it leaves least as steeply as can be, about, and the cosine
/// to that one.
pub fn widest(normals: &[Vec3]) -> (Vec3, f32) {
    let least = |direction: Vec3| {
        let nearer = |a: Vec3, b: Vec3| if b.dot(direction) < a.dot(direction) { b } else { a };
        let worst = normals.iter().copied().reduce(nearer).unwrap_or(direction);
        (worst, worst.dot(direction))
    };
    let mut direction = normals.iter().sum::<Vec3>().normalize_or(normals.first().copied().unwrap_or(Vec3::Y));
    let mut best = (direction, least(direction).1);
    for round in 0..ROUNDS {
        if best.1 >= STEEP {
            break;
        }
        let (worst, _) = least(direction);
        direction = (direction + worst / (round + 2) as f32).normalize_or(worst);
        let cosine = least(direction).1;
        if cosine > best.1 {
            best = (direction, cosine);
        }
    }
    best
}
