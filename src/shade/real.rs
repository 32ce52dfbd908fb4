//! The numbers that scattering formulas are written in.

use std::ops::{Add, Div, Mul, Neg, Sub};

/// f32 where pictures are made, f64 where their error is measured. Functions come from `libm`, the same on every platform.
pub trait Real:
    Copy
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The nearest value to `x`.
    fn of(x: f64) -> Self;
    /// √self.
    fn sqrt(self) -> Self;
    /// e^self.
    fn exp(self) -> Self;
    /// self^power, for self ≥ 0.
    fn powf(self, power: Self) -> Self;
    /// Arc sine, rad; self in [−1, 1].
    fn asin(self) -> Self;
    /// Arc cosine, rad; self in [−1, 1].
    fn acos(self) -> Self;
    /// Cosine of self rad.
    fn cos(self) -> Self;

    /// The larger one.
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }

    /// The smaller one.
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }
}

macro_rules! real {
    ($type:ty, $exp:path, $pow:path, $asin:path, $acos:path, $cos:path) => {
        impl Real for $type {
            fn of(x: f64) -> Self {
                x as $type
            }
            fn sqrt(self) -> Self {
                <$type>::sqrt(self)
            }
            fn exp(self) -> Self {
                $exp(self)
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
        }
    };
}

real!(f32, libm::expf, libm::powf, libm::asinf, libm::acosf, libm::cosf);
real!(f64, libm::exp, libm::pow, libm::asin, libm::acos, libm::cos);
