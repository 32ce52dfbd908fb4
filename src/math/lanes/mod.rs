//! Several numbers at once, for the few loops where time goes.
//!
//! A [`Work`] is written once over an instruction set [`Isa`] and run by [`run`] with the widest one that the machine has.
//! Every lane is rounded as a lone `f32` would be, so results do not depend on the machine.

#[cfg(target_arch = "x86_64")]
mod avx2;
mod functions;
mod scalar;
mod vector;
mod whole;

pub use scalar::Scalar;
pub use vector::{Vec3Row, Vec3s};

use std::fmt::Debug;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// Most lanes that any instruction set has.
pub const MOST: usize = 8;

/// Numbers of all lanes in memory, where single lanes are written; those past an instruction set's last lane are unused.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Zeroable)]
#[repr(C, align(32))]
pub struct Row(pub [f32; MOST]);

/// An instruction set: numbers `F`, whole numbers `U` and truth values `M` in [`Self::LANES`] lanes. Only [`run`] chooses
/// one, after it has looked whether the machine has it.
pub trait Isa: Copy + Debug + Default + PartialEq + 'static {
    /// How many lanes, at most [`MOST`].
    const LANES: usize;
    /// Numbers.
    type F: Copy + Debug;
    /// Whole numbers, 32 bits, wrapping.
    type U: Copy + Debug;
    /// Truth values.
    type M: Copy + Debug;

    /// The same number in every lane.
    fn splat(x: f32) -> Self::F;
    /// From memory.
    fn load(row: &Row) -> Self::F;
    /// To memory.
    fn store(f: Self::F) -> Row;
    /// a + b.
    fn add(a: Self::F, b: Self::F) -> Self::F;
    /// a − b.
    fn sub(a: Self::F, b: Self::F) -> Self::F;
    /// a · b.
    fn mul(a: Self::F, b: Self::F) -> Self::F;
    /// a / b.
    fn div(a: Self::F, b: Self::F) -> Self::F;
    /// a where a < b, else b.
    fn min(a: Self::F, b: Self::F) -> Self::F;
    /// a where a > b, else b.
    fn max(a: Self::F, b: Self::F) -> Self::F;
    /// Square root.
    fn sqrt(f: Self::F) -> Self::F;
    /// The whole number at or below.
    fn floor(f: Self::F) -> Self::F;
    /// a < b.
    fn lt(a: Self::F, b: Self::F) -> Self::M;
    /// `yes` where m, else `no`.
    fn select(m: Self::M, yes: Self::F, no: Self::F) -> Self::F;
    /// Both.
    fn both(a: Self::M, b: Self::M) -> Self::M;
    /// Not.
    fn not(m: Self::M) -> Self::M;
    /// A bit per lane.
    fn mask_bits(m: Self::M) -> u32;
    /// From a bit per lane.
    fn mask_from_bits(bits: u32) -> Self::M;
    /// Bits as whole numbers.
    fn to_bits(f: Self::F) -> Self::U;
    /// Whole numbers as bits.
    fn from_bits(u: Self::U) -> Self::F;
    /// The same whole number in every lane.
    fn splat_whole(x: u32) -> Self::U;
    /// To memory.
    fn store_whole(u: Self::U) -> [u32; MOST];
    /// a + b.
    fn add_whole(a: Self::U, b: Self::U) -> Self::U;
    /// a · b.
    fn mul_whole(a: Self::U, b: Self::U) -> Self::U;
    /// Bits of both.
    fn and(a: Self::U, b: Self::U) -> Self::U;
    /// Bits of either.
    fn or(a: Self::U, b: Self::U) -> Self::U;
    /// Bits of just one.
    fn xor(a: Self::U, b: Self::U) -> Self::U;
    /// Shifted up by N bits.
    fn shl<const N: i32>(u: Self::U) -> Self::U;
    /// Shifted down by N bits, zeros moving in.
    fn shr<const N: i32>(u: Self::U) -> Self::U;
    /// Shifted down by N bits, copies of the top bit moving in.
    fn sar<const N: i32>(u: Self::U) -> Self::U;
    /// Signed whole numbers as the nearest numbers.
    fn signed_to_f(u: Self::U) -> Self::F;
    /// Numbers of a row of [`MOST`], by the lowest three bits of whole numbers.
    fn pick(row: &Row, at: Self::U) -> Self::F;
    /// Numbers of a table, by index; past its end the last, and 0 of an empty one.
    fn gather(table: &[f32], at: Self::U) -> Self::F;
    /// Whole numbers of all lanes.
    fn of_whole(all: [u32; MOST]) -> Self::U;
}

/// Work that is worth doing in lanes.
pub trait Work {
    /// What it gives.
    type Output;
    /// Does it; must be `#[inline(always)]`, as must all that it calls with lanes.
    fn run<I: Isa>(self) -> Self::Output;
}

/// Runs `work` with AVX2 where the machine has it, else one lane at a time.
pub fn run<W: Work>(work: W) -> W::Output {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = avx2::Avx2::found() {
        return avx2.run(work);
    }
    work.run::<Scalar>()
}

/// Asks memory for what will be read soon, where the machine can be asked.
#[inline(always)]
pub fn prefetch<T>(of: &T) {
    #[cfg(target_arch = "x86_64")]
    avx2::prefetch(of);
    #[cfg(not(target_arch = "x86_64"))]
    let _ = of;
}

/// Numbers in lanes.
#[derive(Clone, Copy, Debug)]
pub struct F32s<I: Isa>(I::F);

/// Whole numbers in lanes, wrapping.
#[derive(Clone, Copy, Debug)]
pub struct U32s<I: Isa>(I::U);

/// Truth values in lanes.
#[derive(Clone, Copy, Debug)]
pub struct Mask<I: Isa>(I::M);

impl<I: Isa> F32s<I> {
    /// The same number in every lane.
    #[inline(always)]
    pub fn splat(x: f32) -> Self {
        Self(I::splat(x))
    }

    /// What `f` gives for each lane.
    #[inline(always)]
    pub fn each(mut f: impl FnMut(usize) -> f32) -> Self {
        let mut row = Row::default();
        for (lane, x) in row.0.iter_mut().enumerate().take(I::LANES) {
            *x = f(lane);
        }
        Self::of(&row)
    }

    /// From memory.
    #[inline(always)]
    pub fn of(row: &Row) -> Self {
        Self(I::load(row))
    }

    /// To memory.
    #[inline(always)]
    pub fn row(self) -> Row {
        I::store(self.0)
    }

    /// self < other.
    #[inline(always)]
    pub fn lt(self, other: Self) -> Mask<I> {
        Mask(I::lt(self.0, other.0))
    }

    /// self > other.
    #[inline(always)]
    pub fn gt(self, other: Self) -> Mask<I> {
        Mask(I::lt(other.0, self.0))
    }

    /// The smaller one; `other` where either is no number.
    #[inline(always)]
    pub fn min(self, other: Self) -> Self {
        Self(I::min(self.0, other.0))
    }

    /// The larger one; `other` where either is no number.
    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        Self(I::max(self.0, other.0))
    }

    /// Taken to the nearer end of [low, high]; `low` where it is no number.
    #[inline(always)]
    pub fn within(self, low: f32, high: f32) -> Self {
        self.max(Self::splat(low)).min(Self::splat(high))
    }

    /// Without its sign.
    #[inline(always)]
    pub fn abs(self) -> Self {
        Self(I::from_bits(I::and(I::to_bits(self.0), I::splat_whole(0x7FFF_FFFF))))
    }

    /// Square root.
    #[inline(always)]
    pub fn sqrt(self) -> Self {
        Self(I::sqrt(self.0))
    }

    /// The whole number at or below.
    #[inline(always)]
    pub fn floor(self) -> Self {
        Self(I::floor(self.0))
    }

    /// The bits.
    #[inline(always)]
    pub fn to_bits(self) -> U32s<I> {
        U32s(I::to_bits(self.0))
    }

    /// Whole numbers in 0 … 2²³ − 1, without their fractions.
    #[inline(always)]
    pub fn to_whole(self) -> U32s<I> {
        // Adding 2²³ leaves a whole number's bits lowest.
        (self.floor() + 8_388_608.0).to_bits().and(0x007F_FFFF)
    }
}

impl<I: Isa> Mask<I> {
    /// From a bit per lane.
    #[inline(always)]
    pub fn from_bits(bits: u32) -> Self {
        Self(I::mask_from_bits(bits))
    }

    /// A bit per lane.
    #[inline(always)]
    pub fn bits(self) -> u32 {
        I::mask_bits(self.0)
    }

    /// `yes` in the lanes of this mask, `no` in the others.
    #[inline(always)]
    pub fn select(self, yes: F32s<I>, no: F32s<I>) -> F32s<I> {
        F32s(I::select(self.0, yes.0, no.0))
    }

    /// `yes` in the lanes of this mask, 0 in the others.
    #[inline(always)]
    pub fn keep(self, yes: F32s<I>) -> F32s<I> {
        self.select(yes, F32s::splat(0.0))
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident) => {
        impl<I: Isa> $trait for F32s<I> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(I::$method(self.0, other.0))
            }
        }

        impl<I: Isa> $trait<f32> for F32s<I> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: f32) -> Self {
                Self(I::$method(self.0, I::splat(other)))
            }
        }
    };
}

operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);

impl<I: Isa> Neg for F32s<I> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.to_bits().xor(U32s::splat(0x8000_0000)).to_f32_bits()
    }
}

impl<I: Isa> BitAnd for Mask<I> {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(I::both(self.0, other.0))
    }
}

impl<I: Isa> BitOr for Mask<I> {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        !(!self & !other)
    }
}

impl<I: Isa> Not for Mask<I> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(I::not(self.0))
    }
}
