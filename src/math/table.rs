//! A smooth function of [0, 1], looked up.

use crate::math::lanes::{F32s, Isa};

/// Intervals of a table; a power of two.
const INTERVALS: usize = 256;

/// Values at even distances, linear in between.
#[derive(Clone, Debug, PartialEq)]
pub struct Table([f32; INTERVALS + 1]);

impl Table {
    /// Values that it holds.
    pub const VALUES: usize = INTERVALS + 1;

    /// Of a function.
    pub fn new(f: impl Fn(f32) -> f32) -> Self {
        Self(std::array::from_fn(|i| f(i as f32 / INTERVALS as f32)))
    }

    /// The values at even distances, both ends included.
    pub fn values(&self) -> &[f32] {
        &self.0
    }

    /// The value at `x`, taken to the nearer end outside [0, 1].
    #[inline(always)]
    pub fn at(&self, x: f32) -> f32 {
        let at = x.clamp(0.0, 1.0) * INTERVALS as f32;
        // Shorter numbers are quicker to reach.
        let low = (at as i32 as usize).min(INTERVALS - 1);
        self.0[low] + (at - low as f32) * (self.0[low + 1] - self.0[low])
    }

    /// [`Self::at`] in lanes.
    #[inline(always)]
    pub fn at_lanes<I: Isa>(&self, x: F32s<I>) -> F32s<I> {
        let at = x.within(0.0, 1.0) * INTERVALS as f32;
        let low = at.floor().min(F32s::splat((INTERVALS - 1) as f32));
        let i = low.to_whole();
        let (from, to) = (i.gather(&self.0), i.plus_splat(1).gather(&self.0));
        from + (at - low) * (to - from)
    }
}
