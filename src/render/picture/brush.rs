//! Ribbons of guard hair into the fragments of a tile.

use super::gather::Gathered;
use super::pass::{Band, Pass};
use super::tile::Place;
use crate::data::strands::Strands;
use crate::math::lanes::{self, F32s, Isa, Row, Scalar, Vec3Row};
use crate::render::strands::ribbon::{self, Narrow, Share, Window};
use crate::render::strands::{Fragment, Knot, Streak, radiance_at};

/// Draws pieces of strands into a tile, the nearest first.
pub(super) struct Brush<'a, 'p> {
    pub(super) pass: &'a Pass<'p>,
    pub(super) strands: &'a Strands,
    pub(super) place: &'a Place<'a>,
    pub(super) band: &'a Band,
    /// Depth's bits and index of each piece.
    pub(super) pieces: &'a [u64],
    pub(super) window: Window,
    pub(super) guard: &'a mut Gathered,
}

impl lanes::Work for Brush<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<I: Isa>(mut self) {
        for some in self.pieces.chunks(BOUND_EVERY) {
            if f32::from_bits((some[0] >> 32) as u32) > self.guard.bound() {
                break;
            }
            for &key in some {
                if let Some(stroke) = self.fetch(f32::from_bits((key >> 32) as u32), key as u32) {
                    self.stroke::<I>(&stroke);
                }
            }
        }
    }
}

impl Brush<'_, '_> {
    /// A piece, where it may be seen.
    #[inline(always)]
    fn fetch(&self, nearest_m: f32, piece: u32) -> Option<Stroke> {
        let (a, b) = (&self.band.knots[piece as usize], &self.band.knots[piece as usize + 1]);
        let Place { from, to, .. } = *self.place;
        let pad = std::f32::consts::SQRT_2 * a.half_px.max(b.half_px);
        let columns = within(a.x, b.x, pad, from[0], to[0]);
        let rows = within(a.y, b.y, pad, from[1], to[1]);
        if !self.guard.may_show(nearest_m, columns, rows) {
            return None;
        }
        let points = self.strands.points_per_strand as u32;
        let strand = piece / points;
        let id = self.strands.id[self.band.strands[strand as usize] as usize];
        let looks = self.band.looks[strand as usize];
        Some(Stroke { a: *a, b: *b, looks, strand, first: (piece - strand * points) as f32, id })
    }

    #[inline(always)]
    fn stroke<I: Isa>(&mut self, stroke: &Stroke) {
        let Stroke { a, b, strand, .. } = stroke;
        let Some(narrow) = Narrow::new(a, b, self.window) else {
            ribbon::rasterise(a, b, self.window, |share| {
                let sites = self.sites(stroke, F32s::<Scalar>::splat(share.along));
                self.touch(stroke, &share, sites.z_m.0[0], sites.opacity.0[0]);
                self.guard.keep_streak(|| sites.streak(0, *strand));
            });
            return;
        };
        let mut first = narrow.rows[0];
        while first < narrow.rows[1] {
            let found = narrow.rows::<I>(first);
            let sites = self.sites(stroke, F32s::<I>::of(&found.along));
            for lane in 0..I::LANES.min((narrow.rows[1] - first) as usize) {
                let (row, begin) = (first + lane as i32, found.begin[lane] as i32);
                let linear = found.linear.0[lane];
                for k in 0..found.count[lane] as usize {
                    let coverage = found.coverage[k].0[lane];
                    if coverage > 0.0 {
                        let x = begin + k as i32;
                        let pixel = if narrow.flat { [row, x] } else { [x, row] };
                        let share = Share { pixel, coverage, linear, along: 0.0 };
                        self.touch(stroke, &share, sites.z_m.0[lane], sites.opacity.0[lane]);
                    }
                }
                self.guard.keep_streak(|| sites.streak(lane, *strand));
            }
            first += I::LANES as i32;
        }
    }

    /// What a hair is like at places `along` a piece.
    #[inline(always)]
    fn sites<I: Isa>(&self, stroke: &Stroke, along: F32s<I>) -> Sites {
        let s = (along + stroke.first) * self.pass.per_piece;
        Sites {
            z_m: (along * (stroke.b.z_m - stroke.a.z_m) + stroke.a.z_m).row(),
            s: s.row(),
            opacity: self.pass.opacity.at_lanes(s).row(),
            radiance: radiance_at(&stroke.looks, s).rows(),
        }
    }

    /// Adds a fragment where it may be seen.
    #[inline(always)]
    fn touch(&mut self, stroke: &Stroke, share: &Share, z_m: f32, opacity: f32) {
        let at = self.place.at(share.pixel[0] as usize, share.pixel[1] as usize);
        if z_m <= self.guard.limit_m(at)
            && (z_m < self.guard.clear_m(at)
                || self.pass.before_skin(&stroke.a, &stroke.b, share, z_m, self.place.skin, at))
        {
            let streak = self.guard.next_streak();
            self.guard.push(Fragment::new(z_m, stroke.id, [share.coverage, opacity], streak, at as u32));
        }
    }
}

/// Places on a hair, in lanes.
struct Sites {
    z_m: Row,
    /// Along the hair, in [0, 1].
    s: Row,
    opacity: Row,
    radiance: Vec3Row,
}

impl Sites {
    #[inline(always)]
    fn streak(&self, lane: usize, strand: u32) -> Streak {
        Streak { radiance: self.radiance.lane(lane), strand, s: self.s.0[lane] }
    }
}

/// A piece of a strand.
struct Stroke {
    a: Knot,
    b: Knot,
    looks: Vec3Row,
    /// The strand's number in the band.
    strand: u32,
    /// Its number along the strand.
    first: f32,
    id: u32,
}

/// Columns or rows of a tile that two knots and what lies between them touch.
#[inline(always)]
fn within(a: f32, b: f32, pad: f32, from: usize, to: usize) -> [usize; 2] {
    let cut = |v: f32| ((v - from as f32).max(0.0) as i32 as usize).min(to - from - 1);
    [cut(a.min(b) - pad), cut(a.max(b) + pad)]
}

/// Pieces drawn between looks at what is hidden by now.
const BOUND_EVERY: usize = 128;
