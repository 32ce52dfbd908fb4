//! Whole numbers in lanes.

use super::{F32s, Isa, MOST, Row, U32s};

impl<I: Isa> U32s<I> {
    /// The same whole number in every lane.
    #[inline(always)]
    pub fn splat(x: u32) -> Self {
        Self(I::splat_whole(x))
    }

    /// What `f` gives for each lane.
    #[inline(always)]
    pub fn each(mut f: impl FnMut(usize) -> u32) -> Self {
        let mut all = [0; MOST];
        for (lane, x) in all.iter_mut().enumerate().take(I::LANES) {
            *x = f(lane);
        }
        Self(I::of_whole(all))
    }

    /// Numbers of a table, by index; past its end the last, and 0 of an empty one.
    #[inline(always)]
    pub fn gather(self, table: &[f32]) -> F32s<I> {
        F32s(I::gather(table, self.0))
    }

    /// The numbers with these bits.
    #[inline(always)]
    pub fn to_f32_bits(self) -> F32s<I> {
        F32s(I::from_bits(self.0))
    }

    /// The nearest numbers to signed whole ones.
    #[inline(always)]
    pub fn signed_to_f32(self) -> F32s<I> {
        F32s(I::signed_to_f(self.0))
    }

    /// To memory.
    #[inline(always)]
    pub fn row(self) -> [u32; MOST] {
        I::store_whole(self.0)
    }

    /// self + other.
    #[inline(always)]
    pub fn plus(self, other: Self) -> Self {
        Self(I::add_whole(self.0, other.0))
    }

    /// self + x.
    #[inline(always)]
    pub fn plus_splat(self, x: u32) -> Self {
        self.plus(Self::splat(x))
    }

    /// self · other.
    #[inline(always)]
    pub fn times(self, other: Self) -> Self {
        Self(I::mul_whole(self.0, other.0))
    }

    /// Bits of both.
    #[inline(always)]
    pub fn and(self, x: u32) -> Self {
        Self(I::and(self.0, I::splat_whole(x)))
    }

    /// Bits of either.
    #[inline(always)]
    pub fn or(self, x: u32) -> Self {
        Self(I::or(self.0, I::splat_whole(x)))
    }

    /// Bits of just one.
    #[inline(always)]
    pub fn xor(self, other: Self) -> Self {
        Self(I::xor(self.0, other.0))
    }

    /// Numbers of a row of [`MOST`], by the lowest three bits.
    #[inline(always)]
    pub fn pick(self, row: &Row) -> F32s<I> {
        F32s(I::pick(row, self.0))
    }

    /// Shifted up by N bits.
    #[inline(always)]
    pub fn shl<const N: i32>(self) -> Self {
        Self(I::shl::<N>(self.0))
    }

    /// Shifted down by N bits, zeros moving in.
    #[inline(always)]
    pub fn shr<const N: i32>(self) -> Self {
        Self(I::shr::<N>(self.0))
    }

    /// Shifted down by N bits, copies of the top bit moving in.
    #[inline(always)]
    pub fn sar<const N: i32>(self) -> Self {
        Self(I::sar::<N>(self.0))
    }
}
