//! The numbers that scattering formulas are written in.

use crate::math::lanes::{F32s, Isa};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// f32 and lanes of them where pictures are made, f64 where their error is measured. Functions come from `libm` or are
/// polynomials, the same on every platform.
pub trait Real:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// The nearest value to `x`.
    fn of(x: f64) -> Self;
    /// `x` itself.
    fn of32(x: f32) -> Self;
    /// √self.
    fn sqrt(self) -> Self;
    /// e^self, for self ≤ 0.
    fn exp(self) -> Self;
    /// e^self, for self up to 80.
    fn exp_any(self) -> Self;
    /// Natural logarithm, for self > 0.
    fn ln(self) -> Self;
    /// self^power, for self ≥ 0.
    fn powf(self, power: Self) -> Self;
    /// Arc sine, rad; self in [−1, 1].
    fn asin(self) -> Self;
    /// Arc cosine, rad; self in [−1, 1].
    fn acos(self) -> Self;
    /// Cosine of self rad.
    fn cos(self) -> Self;

    /// `yes` where self > limit, else `no`.
    fn above(self, limit: Self, yes: Self, no: Self) -> Self;

    /// The larger one.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        self.above(other, self, other)
    }

    /// The smaller one.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        self.above(other, other, self)
    }
}

macro_rules! real {
    ($type:ty, $exp:path, $ln:path, $pow:path, $asin:path, $acos:path, $cos:path) => {
        impl Real for $type {
            fn of(x: f64) -> Self {
                x as $type
            }
            fn of32(x: f32) -> Self {
                <$type>::from(x)
            }
            fn sqrt(self) -> Self {
                <$type>::sqrt(self)
            }
            fn exp(self) -> Self {
                $exp(self)
            }
            fn exp_any(self) -> Self {
                $exp(self)
            }
            fn ln(self) -> Self {
                $ln(self)
            }
            fn powf(self, power: Self) -> Self {
                $pow(self, power)
            }
            fn asin(self) -> Self {
                $asin(self)
            }
            fn acos(self) -> Self {
                $acos(self)
            }
            fn cos(self) -> Self {
                $cos(self)
            }
            fn above(self, limit: Self, yes: Self, no: Self) -> Self {
                if self > limit { yes } else { no }
            }
        }
    };
}

real!(f32, libm::expf, libm::logf, libm::powf, libm::asinf, libm::acosf, libm::cosf);
real!(f64, libm::exp, libm::log, libm::pow, libm::asin, libm::acos, libm::cos);

/// Exponents at most 0, powers of numbers in [0, 1] and angles in [−π, π] are all that scattering asks for.
impl<I: Isa> Real for F32s<I> {
    #[inline(always)]
    fn of(x: f64) -> Self {
        Self::splat(x as f32)
    }
    #[inline(always)]
    fn of32(x: f32) -> Self {
        Self::splat(x)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }
    #[inline(always)]
    fn exp(self) -> Self {
        self.exp_negative()
    }
    #[inline(always)]
    fn exp_any(self) -> Self {
        self.exp()
    }
    #[inline(always)]
    fn ln(self) -> Self {
        self.log2() * std::f32::consts::LN_2
    }
    #[inline(always)]
    fn powf(self, power: Self) -> Self {
        self.pow_unit(power)
    }
    #[inline(always)]
    fn asin(self) -> Self {
        self.asin()
    }
    #[inline(always)]
    fn acos(self) -> Self {
        self.acos()
    }
    #[inline(always)]
    fn cos(self) -> Self {
        self.cos()
    }
    #[inline(always)]
    fn above(self, limit: Self, yes: Self, no: Self) -> Self {
        self.gt(limit).select(yes, no)
    }
}
