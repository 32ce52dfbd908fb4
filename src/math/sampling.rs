//! Low-discrepancy points and the mappings that use them.

use super::{Vec2, Vec3};

/// Point `index` of the R2 sequence (Roberts 2018: the plastic number's powers), shifted by `offset`, in [0, 1)².
///
/// Computed in 64-bit fixed point, so that the millionth point is as evenly spread as the first.
pub fn r2(index: u64, offset: u64) -> Vec2 {
    const STEP: [u64; 2] = [0xC13F_A9A9_02A6_328F, 0x91E1_0DA5_C79E_7B1D];
    let at = |step: u64, offset: u64| super::hash::unit_f32(index.wrapping_mul(step).wrapping_add(offset));
    Vec2::new(at(STEP[0], offset), at(STEP[1], super::hash::mix(offset)))
}

/// Maps the unit square to barycentric coordinates, evenly by area and without a fold (Heitz 2019).
pub fn square_to_triangle(u: Vec2) -> Vec3 {
    let (mut x, mut y) = (u.x, u.y);
    if y > x {
        x *= 0.5;
        y -= x;
    } else {
        y *= 0.5;
        x -= y;
    }
    Vec3::new(x, y, 1.0 - x - y)
}
