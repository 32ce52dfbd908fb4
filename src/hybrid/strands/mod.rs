//! Guard hair as camera-facing ribbons, with sub-pixel coverage (`docs/steps/strands.md`).
//!
//! A segment of a strand between two points becomes a ribbon; each pixel it touches gets a fragment whose opacity is the
//! covered share of the pixel's area times the hair's own opacity. A hair thinner than a pixel loses opacity, not
//! existence.

pub mod project;
pub mod ribbon;
pub mod thin;

use crate::math::Vec3;
use crate::math::lanes::{F32s, Isa, MOST, Row, U32s, Vec3Row, Vec3s};

/// How often a strand is lit: logarithms of the opaque hair's radiance, linear RGB. Shadow, and radiance with it, goes
/// exponentially from one to the next.
pub const LIT_POINTS: usize = 8;
const _: () = assert!(LIT_POINTS <= MOST, "a row holds all looks of a strand");

/// Where along the hair, in [0, 1], lit point `i` lies: closer to each other towards the tips, which are seen most.
pub fn lit_point_s(i: usize) -> f32 {
    (i as f32 / (LIT_POINTS - 1) as f32).sqrt()
}

/// Radiance at each `s` in [0, 1] along a hair: its logarithm is a curve through the lit points.
#[inline(always)]
pub fn radiance_at<I: Isa>(log_radiance: &Vec3Row, s: F32s<I>) -> Vec3s<I> {
    let at = s * s * (LIT_POINTS - 1) as f32;
    let low = at.floor().within(0.0, (LIT_POINTS - 2) as f32);
    let part = at - low;
    // From the middle of three lit points; at the ends the nearest three.
    let around =
        [low.max(F32s::splat(1.0)).to_whole(), (low + 1.0).min(F32s::splat((LIT_POINTS - 2) as f32)).to_whole()];
    let places = BetweenLitPoints { low: low.to_whole(), part, hollow: (part - part * part) * 0.25, around };
    Vec3s::new(places.of(&log_radiance.x), places.of(&log_radiance.y), places.of(&log_radiance.z))
}

/// A light that ends between two lit points bends their curve no more than this, lest it swings over.
pub const MOST_BEND: f32 = 3.0;

/// Share of what a hair covers at most below which a corner of it is left out: of the fragments a fourteenth, of what they cover a
/// thousandth.
pub const LEAST_SHARE: f32 = 0.01;

/// Where between lit points.
struct BetweenLitPoints<I: Isa> {
    low: U32s<I>,
    part: F32s<I>,
    /// By how much a curve of unit second differences at both lit points lies below the straight line between them, halved.
    hollow: F32s<I>,
    /// The lit points whose second differences count.
    around: [U32s<I>; 2],
}

impl<I: Isa> BetweenLitPoints<I> {
    /// e to the power of the curve through logarithms.
    #[inline(always)]
    fn of(&self, row: &Row) -> F32s<I> {
        let (from, to) = (self.low.pick(row), self.low.plus_splat(1).pick(row));
        let bend = bend_at(row, self.around[0]) + bend_at(row, self.around[1]);
        let bend = bend.within(-2.0 * MOST_BEND, 2.0 * MOST_BEND);
        (from + (to - from) * self.part - bend * self.hollow).exp()
    }
}

/// Second difference at the middle of three numbers of a row.
#[inline(always)]
fn bend_at<I: Isa>(row: &Row, middle: U32s<I>) -> F32s<I> {
    middle.plus_splat(u32::MAX).pick(row) - middle.pick(row) * 2.0 + middle.plus_splat(1).pick(row)
}

/// A point of a strand on the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Zeroable)]
pub struct RibbonPoint {
    /// Pixel coordinates.
    pub x: f32,
    /// Pixel coordinates.
    pub y: f32,
    /// Depth along the optical axis, m; at or below the near plane where the point is not in front of the eye.
    pub z_m: f32,
    /// Half of the hair's width, px.
    pub half_px: f32,
}

/// A share of a pixel that a hair covers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Fragment {
    /// Source index of the hair; before the depth, so that both are read as one number to be sorted by.
    id: u32,
    /// Depth along the optical axis, m, > 0.
    z_m: f32,
    /// As [`Parts`].
    parts: u32,
    /// What it shows: index of a [`RibbonRow`], in the order of drawing.
    pub ribbon_row: u32,
}

/// What a hair hides of a pixel, a number but for its lowest eight bits, which hold the hair's own opacity there in 255ths: as much
/// as it can hide.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Parts(pub u32);

/// The bits of [`Parts`] that hold the opacity.
const OPACITY: u32 = 0xFF;

impl Parts {
    /// Of the covered share of the pixel's area and the hair's own opacity, both in [0, 1].
    #[inline(always)]
    pub fn new(coverage: f32, opacity: f32) -> Self {
        Self((coverage * opacity).to_bits() & !OPACITY | (opacity * 255.0 + 0.5) as u32)
    }

    /// The same in lanes, of a coverage, an opacity and its code.
    #[inline(always)]
    pub fn of_lanes<I: Isa>(coverage: F32s<I>, opacity: F32s<I>, code: U32s<I>) -> U32s<I> {
        (coverage * opacity).to_bits().and(!OPACITY).plus(code)
    }

    /// The lowest bits of opacities.
    #[inline(always)]
    pub fn codes<I: Isa>(opacity: F32s<I>) -> U32s<I> {
        (opacity * 255.0 + 0.5).to_whole()
    }
}

impl Fragment {
    /// Of hair `id` at depth `z_m` > 0 along the optical axis.
    #[inline(always)]
    pub fn new(z_m: f32, id: u32, Parts(parts): Parts, ribbon_row: u32) -> Self {
        Self { z_m, id, parts, ribbon_row }
    }

    /// What it hides of the pixel.
    #[inline(always)]
    pub fn alpha(&self) -> f32 {
        f32::from_bits(self.parts & !OPACITY)
    }

    /// Covers what `other`, the next segment of the same hair, covers too, with its own opacity.
    #[inline(always)]
    pub fn join(&mut self, other: &Self) {
        // Opacities of nothing hide nothing.
        let [own, others] = [self.parts, other.parts].map(|parts| (parts & OPACITY).max(1) as f32);
        let alpha = self.alpha();
        let most = alpha.max(own * (1.0 / 255.0));
        let joined = (alpha + other.alpha() * (own / others)).min(most);
        self.parts = joined.to_bits() & !OPACITY | self.parts & OPACITY;
    }

    /// Depth along the optical axis, m.
    #[inline(always)]
    pub fn z_m(&self) -> f32 {
        self.z_m
    }

    /// Source index of the hair.
    #[inline(always)]
    pub fn id(&self) -> u32 {
        self.id
    }

    /// Sorts by depth, then id, then in the order of drawing: positive floats are ordered as their bits.
    #[inline(always)]
    pub fn order(&self) -> (u64, u32) {
        (u64::from(self.z_m.to_bits()) << 32 | u64::from(self.id), self.ribbon_row)
    }
}

/// A row of a ribbon, or a column where it lies flat: what its fragments have in common.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RibbonRow {
    /// Radiance of the opaque hair, linear RGB.
    pub radiance: Vec3,
    /// Number of the segment among those that were drawn.
    pub surface: u32,
}
