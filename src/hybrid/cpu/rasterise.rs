//! Ribbons of guard hair into the fragments of a tile.

use super::gather::Gathered;
use super::pass::{Hair, Pass, StrandBand};
use super::scratch::TileView;
use crate::data::strands::Strands;
use crate::hybrid::strands::ribbon::{self, NARROW, Narrow, Window};
use crate::hybrid::strands::{Fragment, LEAST_SHARE, Parts, RibbonPoint, radiance_at};
use crate::math::lanes::{self, F32s, Isa, Scalar, Vec3Row};
use crate::volume::bins::TILE;

/// Draws segments of strands into a tile, the nearest first.
pub(super) struct Rasteriser<'a, 'p> {
    pub(super) pass: &'a Pass<'p>,
    pub(super) strands: &'a Strands,
    pub(super) tile: &'a TileView<'a>,
    pub(super) band: &'a StrandBand,
    /// Depth's bits and index of each segment.
    pub(super) segments: &'a [u64],
    pub(super) window: Window,
    pub(super) guard: &'a mut Gathered,
}

impl lanes::Work for Rasteriser<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<I: Isa>(mut self) {
        let mut fetched = Vec::with_capacity(FETCH_AT_ONCE);
        for some in self.segments.chunks(BOUND_EVERY) {
            if f32::from_bits((some[0] >> 32) as u32) > self.guard.bound() {
                break;
            }
            // Some are fetched at a time: the machine waits for several at once then.
            for few in some.chunks(FETCH_AT_ONCE) {
                few.iter().for_each(|&key| self.call(key as u32));
                fetched.clear();
                for &key in few {
                    if let Some(segment) = self.fetch(f32::from_bits((key >> 32) as u32), key as u32) {
                        fetched.push(segment);
                    }
                }
                for segment in &fetched {
                    self.draw::<I>(segment);
                }
            }
        }
    }
}

impl Rasteriser<'_, '_> {
    /// Lets memory bring a segment.
    #[inline(always)]
    fn call(&self, segment: u32) {
        lanes::prefetch(&self.band.ribbon_points[segment as usize]);
        let log_radiance = &self.band.log_radiance[(segment / self.strands.points_per_strand as u32) as usize];
        lanes::prefetch(&log_radiance.x);
        lanes::prefetch(&log_radiance.z);
    }

    /// A segment, where it may be seen.
    #[inline(always)]
    fn fetch(&self, nearest_m: f32, segment: u32) -> Option<FetchedSegment> {
        let (a, b) = (self.band.ribbon_points[segment as usize], self.band.ribbon_points[segment as usize + 1]);
        let TileView { from, to, .. } = *self.tile;
        let pad = std::f32::consts::SQRT_2 * a.half_px.max(b.half_px);
        let columns = within(a.x, b.x, pad, from[0], to[0]);
        let rows = within(a.y, b.y, pad, from[1], to[1]);
        if !self.guard.may_show(nearest_m, columns, rows) {
            return None;
        }
        let points = self.strands.points_per_strand as u32;
        let strand = segment / points;
        let first = segment - strand * points;
        let id = self.band.ids[strand as usize];
        Some(FetchedSegment { a, b, log_radiance: self.band.log_radiance[strand as usize], number: segment, first, id })
    }

    #[inline(always)]
    fn draw<I: Isa>(&mut self, segment: &FetchedSegment) {
        let before = self.guard.count();
        match Narrow::new(&segment.a, &segment.b, self.window) {
            Some(narrow) => self.narrow::<I>(segment, &narrow),
            None => self.wide(segment),
        }
        if self.guard.count() > before {
            self.guard.keep_surface(segment.number);
        }
    }

    #[inline(always)]
    fn narrow<I: Isa>(&mut self, segment: &FetchedSegment, narrow: &Narrow) {
        let TileView { from, skin, .. } = *self.tile;
        let (pass, surface) = (self.pass, self.guard.next_surface());
        // From row to row, or from column to column where the ribbon lies flat, and from pixel to pixel.
        let (down, along) = if narrow.flat { (1, TILE) } else { (TILE, 1) };
        let [first_row, first_pixel] = if narrow.flat { [from[0], from[1]] } else { [from[1], from[0]] };
        let least = F32s::<I>::splat(segment.least_coverage());
        let mut first = narrow.rows[0];
        while first < narrow.rows[1] {
            let found = narrow.rows::<I>(first);
            let sites = self.sites(segment, F32s::<I>::of(&found.along));
            let inside = u32::MAX >> (u32::BITS - (narrow.rows[1] - first).min(I::LANES as i32) as u32);
            let origin = (first as usize - first_row) * down;
            let opacity = F32s::<I>::of(&sites.opacity);
            let code = Parts::codes(opacity);
            let (before, ribbon_row) = (self.guard.count(), self.guard.next_ribbon_row());
            self.guard.make_room(NARROW * I::LANES);
            for k in 0..NARROW {
                let coverage = F32s::<I>::of(&found.coverage[k]);
                let mut left = found.covered[k] & inside & coverage.gt(least).bits();
                if left == 0 {
                    continue;
                }
                let parts = Parts::of_lanes(coverage, opacity, code).row();
                while left != 0 {
                    let lane = left.trailing_zeros() as usize;
                    left &= left - 1;
                    let z_m = sites.z_m.0[lane];
                    let pixel = origin + lane * down + (found.begin[lane] as usize + k - first_pixel) * along;
                    let fragment = Fragment::new(z_m, segment.id, Parts(parts[lane]), ribbon_row + lane as u32);
                    self.guard.add(pixel, fragment, || {
                        let hair = Hair { a: &segment.a, b: &segment.b, linear: found.linear.0[lane], z_m };
                        pass.before_skin(&hair, self.tile.pixel(pixel), skin, pixel)
                    });
                }
            }
            first += I::LANES as i32;
            if self.guard.count() > before {
                let radiance = radiance_at(&segment.log_radiance, F32s::<I>::of(&sites.s)).rows();
                self.guard.show(&radiance, &sites.s, surface, (u32::BITS - inside.leading_zeros()) as usize);
            }
        }
    }

    /// A ribbon of any width, pixel by pixel.
    #[inline(always)]
    fn wide(&mut self, segment: &FetchedSegment) {
        let (pass, surface) = (self.pass, self.guard.next_surface());
        let least = segment.least_coverage();
        ribbon::rasterise(&segment.a, &segment.b, self.window, |share| {
            if share.coverage <= least {
                return;
            }
            let sites = self.sites(segment, F32s::<Scalar>::splat(share.along));
            let (z_m, parts) = (sites.z_m.0[0], Parts::new(share.coverage, sites.opacity.0[0]));
            let pixel = self.tile.at(share.pixel[0] as usize, share.pixel[1] as usize);
            let skin = self.tile.skin;
            let before = self.guard.count();
            let fragment = Fragment::new(z_m, segment.id, parts, self.guard.next_ribbon_row());
            self.guard.make_room(1);
            self.guard.add(pixel, fragment, || {
                let hair = Hair { a: &segment.a, b: &segment.b, linear: share.linear, z_m };
                pass.before_skin(&hair, share.pixel, skin, pixel)
            });
            if self.guard.count() > before {
                let radiance = radiance_at(&segment.log_radiance, F32s::<Scalar>::of(&sites.s)).rows();
                self.guard.show(&radiance, &sites.s, surface, 1);
            }
        });
    }

    /// What a hair is like at places `along` a segment.
    #[inline(always)]
    fn sites<I: Isa>(&self, segment: &FetchedSegment, along: F32s<I>) -> Sites {
        let s = (along + segment.first as f32) * self.pass.per_segment;
        Sites {
            z_m: (along * (segment.b.z_m - segment.a.z_m) + segment.a.z_m).row(),
            s: s.row(),
            opacity: self.pass.opacity.at_lanes(s).row(),
        }
    }
}

/// Places on a hair, in lanes.
struct Sites {
    z_m: lanes::Row,
    /// Along the hair, in [0, 1].
    s: lanes::Row,
    opacity: lanes::Row,
}

/// A segment of a strand.
struct FetchedSegment {
    a: RibbonPoint,
    b: RibbonPoint,
    log_radiance: Vec3Row,
    /// Its number in the band.
    number: u32,
    /// Its number along the strand.
    first: u32,
    id: u32,
}

impl FetchedSegment {
    /// Coverage that is not worth a fragment.
    #[inline(always)]
    fn least_coverage(&self) -> f32 {
        LEAST_SHARE * (2.0 * self.a.half_px.max(self.b.half_px)).min(1.0)
    }
}

/// Columns or rows of a tile that two ribbon points and what lies between them touch.
#[inline(always)]
fn within(a: f32, b: f32, pad: f32, from: usize, to: usize) -> [usize; 2] {
    let cut = |v: f32| ((v - from as f32).max(0.0) as i32 as usize).min(to - from - 1);
    [cut(a.min(b) - pad), cut(a.max(b) + pad)]
}

/// Segments fetched before they are drawn.
const FETCH_AT_ONCE: usize = 32;

/// Segments drawn between looks at what is hidden by now.
const BOUND_EVERY: usize = 128;
