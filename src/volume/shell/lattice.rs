//! Depths of shadow stored at the corners of one prism's sub-elements, on the skin, on the top and between layers.
//!
//! Values at corners, and linear between them, go on from prism to prism, and begin at nothing on an open border that light
//! comes in over: what is seen there lies before the first sub-element's middle.

use super::block::value;
use crate::math::Vec3;
use crate::math::lanes::{F32s, Isa, MOST, Row, Scalar, U32s, Vec3s};

/// Values at the corners of sub-elements by corner and level, i·levels + i_l, so that two levels are read at once.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Lattice {
    n: u32,
    /// [`SPARE`] bytes more than there are values.
    values: Box<[u8]>,
}

/// Bytes are read in twos.
const SPARE: usize = 1;

/// Corners of sub-elements in a level split `d` times.
pub fn corners(d: u32) -> u32 {
    let n = 1 << d;
    (n + 1) * (n + 2) / 2
}

/// Barycentric coordinates of a level's corners, in their order.
pub fn points(d: u32) -> impl Iterator<Item = Vec3> {
    let n = 1_u32 << d;
    let at = move |i: u32, j: u32| Vec3::new((n - i - j) as f32, i as f32, j as f32) / n as f32;
    (0..=n).flat_map(move |j| (0..=n - j).map(move |i| at(i, j)))
}

/// Corners of the sub-element around a point in a level split `d` times, and their weights.
pub fn around(d: u32, b: Vec3) -> ([u32; 3], Vec3) {
    let n = (1_u32 << d) as f32;
    let (corners, weights) = corners_around(F32s::<Scalar>::splat(n), Vec3s::splat(b));
    (corners.map(|corner| corner.row()[0]), weights.rows().lane(0))
}

impl Lattice {
    /// Of `d` subdivisions, from what [`code`](super::block::code) gives by corner and level.
    pub fn of_codes(d: u32, mut codes: Vec<u8>) -> Self {
        debug_assert_eq!(codes.len() % corners(d) as usize, 0, "one value per corner and level");
        codes.resize(codes.len() + SPARE, 0);
        Self { n: 1 << d, values: codes.into() }
    }

    /// Bytes of its values.
    pub fn bytes(&self) -> usize {
        self.values.len().saturating_sub(SPARE)
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

    /// Values at points, linear between the three corners and two levels around them; any value in lanes whose points lie in
    /// no prism.
    #[inline(always)]
    pub fn at<I: Isa>(&self, b: Vec3s<I>, level: F32s<I>) -> F32s<I> {
        let (corners, weights) = corners_around(F32s::of(&self.n), b);
        let at = level.within(0.0, self.last_level);
        let low = at.floor().min(F32s::splat(self.last_level - 1.0));
        let levels = U32s::splat(self.last_level as u32 + 1);
        let [mut from, mut to] = [F32s::splat(0.0); 2];
        for (corner, weight) in corners.into_iter().zip([weights.x, weights.y, weights.z]) {
            let two = self.two(corner.times(levels).plus(low.to_whole()));
            from = from + value(two.and(0xFF)) * weight;
            to = to + value(two.shr::<8>()) * weight;
        }
        (from + (at - low) * (to - from)).max(F32s::splat(0.0))
    }

    /// A byte and, above it, the next one.
    #[inline(always)]
    fn two<I: Isa>(&self, at: U32s<I>) -> U32s<I> {
        let at = at.row();
        U32s::each(|lane| {
            let values = self.values[lane];
            match values.get(at[lane] as usize..).and_then(|from| from.first_chunk()) {
                Some(&two) => u32::from(u16::from_le_bytes(two)),
                None => 0,
            }
        })
    }
}

/// Corners of the sub-elements around points in levels split into `n` rows, and their weights.
#[inline(always)]
fn corners_around<I: Isa>(n: F32s<I>, b: Vec3s<I>) -> ([U32s<I>; 3], Vec3s<I>) {
    let (zero, one) = (F32s::splat(0.0), F32s::splat(1.0));
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
    (corners, weights)
}

/// Index of the corner `i` steps towards corner 1 and `j` towards corner 2 in a level split into rows of `n`.
#[inline(always)]
fn corner<I: Isa>(n: F32s<I>, i: F32s<I>, j: F32s<I>) -> U32s<I> {
    (j * (n * 2.0 + 3.0 - j) * 0.5 + i).to_whole()
}
