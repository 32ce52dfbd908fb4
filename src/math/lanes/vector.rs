//! Vectors in lanes.

use super::{F32s, Isa, Mask, Row};
use crate::math::Vec3;
use std::ops::{Add, Mul, Sub};

/// Vectors of all lanes in memory, where single lanes are written.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Zeroable)]
pub struct Vec3Row {
    /// First coordinates.
    pub x: Row,
    /// Second coordinates.
    pub y: Row,
    /// Third coordinates.
    pub z: Row,
}

impl Vec3Row {
    /// Puts a vector into lane `i`.
    #[inline(always)]
    pub fn set(&mut self, i: usize, v: Vec3) {
        (self.x.0[i], self.y.0[i], self.z.0[i]) = (v.x, v.y, v.z);
    }

    /// The vector in lane `i`.
    #[inline(always)]
    pub fn lane(&self, i: usize) -> Vec3 {
        Vec3::new(self.x.0[i], self.y.0[i], self.z.0[i])
    }
}

/// Vectors.
#[derive(Clone, Copy, Debug)]
pub struct Vec3s<I: Isa> {
    /// First coordinates.
    pub x: F32s<I>,
    /// Second coordinates.
    pub y: F32s<I>,
    /// Third coordinates.
    pub z: F32s<I>,
}

impl<I: Isa> Vec3s<I> {
    /// From coordinates.
    #[inline(always)]
    pub fn new(x: F32s<I>, y: F32s<I>, z: F32s<I>) -> Self {
        Self { x, y, z }
    }

    /// The same vector in every lane.
    #[inline(always)]
    pub fn splat(v: Vec3) -> Self {
        Self::new(F32s::splat(v.x), F32s::splat(v.y), F32s::splat(v.z))
    }

    /// The same number in every lane and coordinate.
    #[inline(always)]
    pub fn all(x: f32) -> Self {
        Self::splat(Vec3::splat(x))
    }

    /// From memory.
    #[inline(always)]
    pub fn of(rows: &Vec3Row) -> Self {
        Self::new(F32s::of(&rows.x), F32s::of(&rows.y), F32s::of(&rows.z))
    }

    /// To memory.
    #[inline(always)]
    pub fn rows(self) -> Vec3Row {
        Vec3Row { x: self.x.row(), y: self.y.row(), z: self.z.row() }
    }

    /// Dot product.
    #[inline(always)]
    pub fn dot(self, other: Self) -> F32s<I> {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// Cross product.
    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        Self::new(
            self.y * other.z - other.y * self.z,
            self.z * other.x - other.z * self.x,
            self.x * other.y - other.x * self.y,
        )
    }

    /// Length.
    #[inline(always)]
    pub fn length(self) -> F32s<I> {
        self.dot(self).sqrt()
    }

    /// Of unit length; `otherwise` where there is none to speak of.
    #[inline(always)]
    pub fn normalized_or(self, otherwise: Self) -> Self {
        let length = self.length();
        let scaled = self * (F32s::splat(1.0) / length);
        scaled.select(length.gt(F32s::splat(1e-30)), otherwise)
    }

    /// Coordinate by coordinate.
    #[inline(always)]
    pub fn times(self, other: Self) -> Self {
        Self::new(self.x * other.x, self.y * other.y, self.z * other.z)
    }

    /// Divided by numbers.
    #[inline(always)]
    pub fn over(self, by: F32s<I>) -> Self {
        Self::new(self.x / by, self.y / by, self.z / by)
    }

    /// With `x` added to every coordinate.
    #[inline(always)]
    pub fn plus(self, x: F32s<I>) -> Self {
        Self::new(self.x + x, self.y + x, self.z + x)
    }

    /// Self in the lanes of `mask`, `otherwise` in the others.
    #[inline(always)]
    pub fn select(self, mask: Mask<I>, otherwise: Self) -> Self {
        Self::new(mask.select(self.x, otherwise.x), mask.select(self.y, otherwise.y), mask.select(self.z, otherwise.z))
    }

    /// Self in the lanes of `mask`, zero in the others.
    #[inline(always)]
    pub fn keep(self, mask: Mask<I>) -> Self {
        Self::new(mask.keep(self.x), mask.keep(self.y), mask.keep(self.z))
    }
}

impl<I: Isa> Add for Vec3s<I> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y, self.z + other.z)
    }
}

impl<I: Isa> Sub for Vec3s<I> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y, self.z - other.z)
    }
}

impl<I: Isa> Mul<F32s<I>> for Vec3s<I> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, by: F32s<I>) -> Self {
        Self::new(self.x * by, self.y * by, self.z * by)
    }
}
