//! Smooth noise in space.

use super::lanes::{F32s, Isa, U32s, Vec3s};

/// Simplex noise (Perlin 2001; the kernel (0.6 − r²)⁴ of Gustavson 2005), mean 0, within [−1, 1], features about 1 apart.
/// Where `period` is given, a multiple of 3, the noise repeats after it along x and along y.
#[inline(always)]
pub fn simplex_lanes<I: Isa>(p: Vec3s<I>, seed: u32, period: Option<f32>) -> F32s<I> {
    let skew = (p.x + p.y + p.z) * (1.0 / 3.0);
    let cell = Vec3s::new((p.x + skew).floor(), (p.y + skew).floor(), (p.z + skew).floor());
    let unskew = (cell.x + cell.y + cell.z) * (1.0 / 6.0);
    let x0 = Vec3s::new(p.x - (cell.x - unskew), p.y - (cell.y - unskew), p.z - (cell.z - unskew));
    let (xy, yz, zx) = (x0.x.lt(x0.y), x0.y.lt(x0.z), x0.z.lt(x0.x));
    let (zero, one) = (F32s::splat(0.0), F32s::splat(1.0));
    // A coordinate is first where it is no less than the next and more than the one before, and last the other way.
    let first = Vec3s::new((!xy & zx).keep(one), (xy & !yz).keep(one), (yz & !zx).keep(one));
    let second = Vec3s::new((xy & !zx).select(zero, one), (!xy & yz).select(zero, one), (!yz & zx).select(zero, one));
    let mut sum = F32s::splat(0.0);
    for (corner, unskew) in [(Vec3s::all(0.0), 0.0), (first, 1.0 / 6.0), (second, 1.0 / 3.0), (Vec3s::all(1.0), 0.5)] {
        let d = (x0 - corner).plus(F32s::splat(unskew));
        let fall = F32s::splat(0.6) - d.dot(d);
        let corner = match period {
            Some(period) => wrapped(cell + corner, period),
            None => cell + corner,
        };
        let term = fall * fall * fall * fall * d.dot(gradient_lanes(corner, seed));
        sum = sum + fall.gt(F32s::splat(0.0)).keep(term);
    }
    sum * 32.0
}

/// The same corners with 0 ≤ x, y < `period` (Gustavson and McEwan 2022, "Tiling simplex noise and flow noise"): corner c
/// lies at c − Σc/6, so that a period along x is a step of (4, 1, 1)/3 periods from corner to corner.
#[inline(always)]
fn wrapped<I: Isa>(corner: Vec3s<I>, period: f32) -> Vec3s<I> {
    let sum = corner.x + corner.y + corner.z;
    let steps = |c: F32s<I>| ((c * 6.0 - sum) / F32s::splat(6.0 * period)).floor() * (period / 3.0);
    let (x, y) = (steps(corner.x), steps(corner.y));
    Vec3s::new(corner.x - x * 4.0 - y, corner.y - x - y * 4.0, corner.z - x - y)
}

/// One of the twelve edge directions of a cube.
#[inline(always)]
fn gradient_lanes<I: Isa>(corner: Vec3s<I>, seed: u32) -> Vec3s<I> {
    // Adding 1.5·2²³ leaves a whole number's bits lowest.
    const ROUND: f32 = 12_582_912.0;
    let mut h = U32s::splat(seed);
    for c in [corner.x, corner.y, corner.z] {
        let whole = (c + ROUND).to_bits().plus_splat(ROUND.to_bits().wrapping_neg());
        h = h.xor(whole).times(U32s::splat(0x9E37_79B1));
        h = h.xor(h.shr::<15>());
    }
    h = h.times(U32s::splat(0x85EB_CA77));
    // Bits 31 and 30 become signs.
    let u = h.and(0x8000_0000).or(1.0_f32.to_bits()).to_f32_bits();
    let v = h.shl::<1>().and(0x8000_0000).or(1.0_f32.to_bits()).to_f32_bits();
    // n = h >> 8 has 24 bits, so that 2³² n/3, less whole turns, has n mod 3 in its highest two.
    let third = h.shr::<8>().times(U32s::splat(0x5555_5556));
    let zero = F32s::splat(0.0);
    let (is_2, is_1) = (third.signed_to_f32().lt(zero), third.shl::<1>().signed_to_f32().lt(zero));
    Vec3s::new(is_2.select(zero, u), is_1.select(zero, is_2.select(u, v)), (is_1 | is_2).keep(v))
}
