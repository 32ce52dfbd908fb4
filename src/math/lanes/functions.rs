//! Functions in lanes: polynomials, within a few units of the last place of what `libm` gives.

use super::{F32s, Isa};
use std::f32::consts::{FRAC_PI_2, LN_2, LOG2_E, PI};

/// Adding and taking away 1.5·2²³ rounds to the nearest whole number, which is then in the lowest bits.
const ROUND: f32 = 12_582_912.0;

impl<I: Isa> F32s<I> {
    /// e^self for self ≤ 0; 0 below −87. The same polynomial as [`crate::math::fast::exp_negative`].
    #[inline(always)]
    pub fn exp_negative(self) -> Self {
        self.gt(Self::splat(-87.0)).keep((self * LOG2_E).exp2_near())
    }

    /// e^self; 0 below −87, and e^87 above 87. The same polynomial as [`crate::math::fast::exp`].
    #[inline(always)]
    pub fn exp(self) -> Self {
        self.gt(Self::splat(-87.0)).keep((self.min(Self::splat(87.0)) * LOG2_E).exp2_near())
    }

    /// 2^self for self in −126 … 126.
    #[inline(always)]
    fn exp2_near(self) -> Self {
        let shifted = self + ROUND;
        let f = (self - (shifted - ROUND)) * LN_2;
        let mut power = Self::splat(1.0 / 720.0);
        for c in [1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0, 0.5, 1.0, 1.0] {
            power = power * f + c;
        }
        power * shifted.to_bits().shl::<23>().plus_splat(127 << 23).to_f32_bits()
    }

    /// log₂ self for normal self > 0.
    ///
    /// With m the mantissa moved into [√½, √2) and s = (m − 1)/(m + 1), ln m = 2 (s + s³/3 + s⁵/5 + …).
    #[inline(always)]
    pub fn log2(self) -> Self {
        // The bits of √½: what is below belongs to the exponent before.
        const ROOT_HALF: u32 = 0x3F35_04F3;
        let moved = self.to_bits().plus_splat(ROOT_HALF.wrapping_neg());
        let exponent = moved.sar::<23>().signed_to_f32();
        let mantissa = moved.and(0x007F_FFFF).plus_splat(ROOT_HALF).to_f32_bits();
        let s = (mantissa - 1.0) / (mantissa + 1.0);
        let s2 = s * s;
        let mut sum = Self::splat(1.0 / 9.0);
        for c in [1.0 / 7.0, 0.2, 1.0 / 3.0, 1.0] {
            sum = sum * s2 + c;
        }
        exponent + s * sum * (2.0 * LOG2_E)
    }

    /// self^power for self in [0, 1] and power > 0.
    #[inline(always)]
    pub fn pow_unit(self, power: Self) -> Self {
        let exponent = (power * self.max(Self::splat(1e-30)).log2()).max(Self::splat(-126.0));
        self.gt(Self::splat(1e-30)).keep(exponent.exp2_near())
    }

    /// Arc cosine, rad, of self in [−1, 1] (Abramowitz and Stegun 1964, 4.4.46).
    #[inline(always)]
    pub fn acos(self) -> Self {
        let x = self.abs().min(Self::splat(1.0));
        let mut sum = Self::splat(-0.001_262_491_1);
        for c in [0.006_670_09, -0.017_088_126, 0.030_891_88, -0.050_174_303, 0.088_978_99, -0.214_598_8, FRAC_PI_2] {
            sum = sum * x + c;
        }
        let right = (Self::splat(1.0) - x).sqrt() * sum;
        self.lt(Self::splat(0.0)).select(Self::splat(PI) - right, right)
    }

    /// Arc sine, rad, of self in [−1, 1].
    #[inline(always)]
    pub fn asin(self) -> Self {
        Self::splat(FRAC_PI_2) - self.acos()
    }

    /// Cosine of self rad in [−π, π]: by sin's Taylor polynomial and cos x = 1 − 2 sin²(x/2).
    #[inline(always)]
    pub fn cos(self) -> Self {
        let x = self * 0.5;
        let x2 = x * x;
        let mut sum = Self::splat(-1.0 / 39_916_800.0);
        for c in [1.0 / 362_880.0, -1.0 / 5040.0, 1.0 / 120.0, -1.0 / 6.0, 1.0] {
            sum = sum * x2 + c;
        }
        let sine = x * sum;
        Self::splat(1.0) - sine * sine * 2.0
    }
}
