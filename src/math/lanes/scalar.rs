//! One lane, for machines whose wider ones are not spoken here.

use super::{Isa, MOST, Row};

/// One lane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Scalar;

impl Isa for Scalar {
    const LANES: usize = 1;
    type F = f32;
    type U = u32;
    type M = bool;

    #[inline(always)]
    fn splat(x: f32) -> f32 {
        x
    }
    #[inline(always)]
    fn load(row: &Row) -> f32 {
        row.0[0]
    }
    #[inline(always)]
    fn store(f: f32) -> Row {
        Row([f; MOST])
    }
    #[inline(always)]
    fn add(a: f32, b: f32) -> f32 {
        a + b
    }
    #[inline(always)]
    fn sub(a: f32, b: f32) -> f32 {
        a - b
    }
    #[inline(always)]
    fn mul(a: f32, b: f32) -> f32 {
        a * b
    }
    #[inline(always)]
    fn div(a: f32, b: f32) -> f32 {
        a / b
    }
    #[inline(always)]
    fn min(a: f32, b: f32) -> f32 {
        if a < b { a } else { b }
    }
    #[inline(always)]
    fn max(a: f32, b: f32) -> f32 {
        if a > b { a } else { b }
    }
    #[inline(always)]
    fn sqrt(f: f32) -> f32 {
        f.sqrt()
    }
    #[inline(always)]
    fn floor(f: f32) -> f32 {
        f.floor()
    }
    #[inline(always)]
    fn lt(a: f32, b: f32) -> bool {
        a < b
    }
    #[inline(always)]
    fn select(m: bool, yes: f32, no: f32) -> f32 {
        if m { yes } else { no }
    }
    #[inline(always)]
    fn both(a: bool, b: bool) -> bool {
        a & b
    }
    #[inline(always)]
    fn not(m: bool) -> bool {
        !m
    }
    #[inline(always)]
    fn mask_bits(m: bool) -> u32 {
        u32::from(m)
    }
    #[inline(always)]
    fn pick(row: &Row, at: u32) -> f32 {
        row.0[at as usize % MOST]
    }
    #[inline(always)]
    fn gather(table: &[f32], at: u32) -> f32 {
        table.get(at as usize).or(table.last()).copied().unwrap_or(0.0)
    }
    #[inline(always)]
    fn of_whole(all: [u32; MOST]) -> u32 {
        all[0]
    }
    #[inline(always)]
    fn mask_from_bits(bits: u32) -> bool {
        bits & 1 != 0
    }
    #[inline(always)]
    fn to_bits(f: f32) -> u32 {
        f.to_bits()
    }
    #[inline(always)]
    fn from_bits(u: u32) -> f32 {
        f32::from_bits(u)
    }
    #[inline(always)]
    fn splat_whole(x: u32) -> u32 {
        x
    }
    #[inline(always)]
    fn store_whole(u: u32) -> [u32; MOST] {
        [u; MOST]
    }
    #[inline(always)]
    fn add_whole(a: u32, b: u32) -> u32 {
        a.wrapping_add(b)
    }
    #[inline(always)]
    fn mul_whole(a: u32, b: u32) -> u32 {
        a.wrapping_mul(b)
    }
    #[inline(always)]
    fn and(a: u32, b: u32) -> u32 {
        a & b
    }
    #[inline(always)]
    fn or(a: u32, b: u32) -> u32 {
        a | b
    }
    #[inline(always)]
    fn xor(a: u32, b: u32) -> u32 {
        a ^ b
    }
    #[inline(always)]
    fn shl<const N: i32>(u: u32) -> u32 {
        u << N
    }
    #[inline(always)]
    fn shr<const N: i32>(u: u32) -> u32 {
        u >> N
    }
    #[inline(always)]
    fn sar<const N: i32>(u: u32) -> u32 {
        ((u as i32) >> N) as u32
    }
    #[inline(always)]
    fn signed_to_f(u: u32) -> f32 {
        u as i32 as f32
    }
}
