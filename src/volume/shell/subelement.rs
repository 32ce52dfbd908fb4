//! Sub-elements of a layer: a triangle split d times by joining its edges' middles (Andersen et al. 2016, eq. (1) to (3)).
//!
//! dist⊥(p, e_x) / dist⊥(p_x, e_x) is the barycentric coordinate b_x, so that eq. (1) reads i_x = ⌊(1 − b_x) 2^d⌋.

use crate::math::Vec3;
use crate::math::lanes::{F32s, Isa, U32s, Vec3s};

/// Indices of the sub-elements that hold barycentric coordinates `b` in a layer of n = 2^d along an edge, in 0 … 4^d − 1.
///
/// Points on a lattice line go to the row nearer to the edge opposite to corner 0, and within a row by what eq. (1) gives
/// for corner 1; points outside the triangle to a sub-element on its rim.
#[inline(always)]
pub fn indices<I: Isa>(b: Vec3s<I>, n: F32s<I>) -> U32s<I> {
    let (zero, one, last) = (F32s::splat(0.0), F32s::splat(1.0), n - 1.0);
    let u0 = ((one - b.x) * n).max(zero).min(n);
    let u1 = ((one - b.y) * n).max(zero).min(n);
    let u2 = (n * 2.0 - u0 - u1).max(zero).min(n);
    let row = u0.floor().min(last);
    let across = u1.floor().min(last) - u2.floor().min(last);
    // Equation (2).
    (row * (row + 1.0) + across.max(-row).min(row)).to_whole()
}

/// Barycentric coordinates of a sub-element's centre.
pub fn centre(index: u32, d: u32) -> Vec3 {
    let n = 1_i32 << d;
    let i = index as i32;
    let row = f64::from(index).sqrt() as i32;
    let across = i - row * (row + 1);
    // i₁ + i₂ is 2n − 1 − i₀ in sub-elements that point as the triangle does, one less in the others.
    let upright = (across + 2 * n - 1 - row) % 2 == 0;
    let sum = 2 * n - 1 - row - i32::from(!upright);
    let rest = if upright { 1.0 / 3.0 } else { 2.0 / 3.0 };
    let b = |i: i32| 1.0 - (i as f32 + rest) / n as f32;
    Vec3::new(b(row), b((sum + across) / 2), b((sum - across) / 2))
}
