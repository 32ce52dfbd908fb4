//! Depths of shadow stored at the corners of one prism's sub-elements, on the skin, on the top and between layers.
//!
//! Values at corners, and linear between them, go on from prism to prism, and begin at nothing on an open border that light
//! comes in over: what is seen there lies before the first sub-element's middle.

use super::block::{LARGEST, code};
use crate::math::Vec3;
use crate::math::lanes::{F32s, Isa, MOST, Mask, Row, U32s, Vec3s};

/// Values at the corners of sub-elements in levels: i_l·corners + i.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Lattice {
    n: u32,
    values: Box<[u8]>,
}

/// Corners of sub-elements in a level split `d` times.
pub fn corners(d: u32) -> u32 {
    let n = 1 << d;
    (n + 1) * (n + 2) / 2
}

/// Barycentric coordinates of a level's corners, in their order.
pub fn places(d: u32) -> impl Iterator<Item = Vec3> {
    let n = 1_u32 << d;
    let at = move |i: u32, j: u32| Vec3::new((n - i - j) as f32, i as f32, j as f32) / n as f32;
    (0..=n).flat_map(move |j| (0..=n - j).map(move |i| at(i, j)))
}

impl Lattice {
    /// Of `d` subdivisions, from values by level and then in the order of [`places`].
    pub fn new(d: u32, values: &[f32]) -> Self {
        debug_assert_eq!(values.len() % corners(d) as usize, 0, "one value per corner and level");
        Self { n: 1 << d, values: values.iter().map(|&v| code(v)).collect() }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.values.len()
    }
}

/// The lattices that marches side by side are in.
#[derive(Clone, Copy, Debug)]
pub struct Lattices<'a> {
    values: [&'a [u8]; MOST],
    /// 2^d.
    n: Row,
    last_level: f32,
}

impl<'a> Lattices<'a> {
    /// No lattice yet, of a volume of so many layers.
    pub fn new(layers: u32) -> Self {
        Self { values: [&[]; MOST], n: Row([1.0; MOST]), last_level: layers as f32 }
    }

    /// Puts lane `i` into a lattice.
    #[inline(always)]
    pub fn set(&mut self, i: usize, lattice: &'a Lattice) {
        self.values[i] = &lattice.values;
        self.n.0[i] = lattice.n as f32;
    }

    /// Values at places, linear between the three corners and two levels around them; 0 in lanes not in `on`.
    #[inline(always)]
    pub fn at<I: Isa>(&self, b: Vec3s<I>, level: F32s<I>, on: Mask<I>) -> F32s<I> {
        let (zero, one) = (F32s::splat(0.0), F32s::splat(1.0));
        let n = F32s::of(&self.n);
        let (u, v) = ((b.y * n).max(zero).min(n), (b.z * n).max(zero).min(n));
        let j = v.floor().min(n - 1.0);
        let i = u.floor().min(n - 1.0 - j);
        let (fu, fv) = (u - i, v - j);
        // The sub-element that points the other way; none beyond the edge opposite to corner 0, where rounding may lead.
        let turned = (fu + fv).gt(one) & (n - 1.0).gt(i + j);
        let shift = turned.keep(one);
        let corners = [corner(n, i + shift, j + shift), corner(n, i + 1.0, j), corner(n, i, j + 1.0)];
        let rest = one - fu - fv;
        let weights = Vec3s::new(turned.select(-rest, rest), turned.select(one - fv, fu), turned.select(one - fu, fv));
        let per_level = ((n + 1.0) * (n + 2.0) * 0.5).to_whole();
        let at = level.within(0.0, self.last_level);
        let low = at.floor().min(F32s::splat(self.last_level - 1.0));
        let first = low.to_whole().times(per_level);
        let from = self.level(first, &corners, weights, on);
        let to = self.level(first.plus(per_level), &corners, weights, on);
        (from + (at - low) * (to - from)).max(zero)
    }

    #[inline(always)]
    fn level<I: Isa>(&self, first: U32s<I>, corners: &[U32s<I>; 3], weights: Vec3s<I>, on: Mask<I>) -> F32s<I> {
        let a = self.fetch(first.plus(corners[0]), on);
        let b = self.fetch(first.plus(corners[1]), on);
        let c = self.fetch(first.plus(corners[2]), on);
        a * weights.x + b * weights.y + c * weights.z
    }

    #[inline(always)]
    fn fetch<I: Isa>(&self, at: U32s<I>, on: Mask<I>) -> F32s<I> {
        let (at, on) = (at.row(), on.bits());
        let byte =
            F32s::each(|lane| if on >> lane & 1 != 0 { f32::from(self.values[lane][at[lane] as usize]) } else { 0.0 });
        let root = byte * (1.0 / 255.0);
        root * root * LARGEST
    }
}

/// Index of the corner `i` steps towards corner 1 and `j` towards corner 2 in a level split into rows of `n`.
#[inline(always)]
fn corner<I: Isa>(n: F32s<I>, i: F32s<I>, j: F32s<I>) -> U32s<I> {
    (j * (n * 2.0 + 3.0 - j) * 0.5 + i).to_whole()
}
