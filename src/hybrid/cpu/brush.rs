//! Ribbons of guard hair into the fragments of a tile.

use super::gather::Gathered;
use super::pass::{Band, Hair, Pass};
use super::scratch::TileView;
use crate::data::strands::Strands;
use crate::hybrid::strands::ribbon::{self, NARROW, Narrow, Window};
use crate::hybrid::strands::{Fragment, Knot, LEAST_SHARE, Parts, radiance_at};
use crate::math::lanes::{self, F32s, Isa, Scalar, Vec3Row};
use crate::volume::bins::TILE;

/// Draws pieces of strands into a tile, the nearest first.
pub(super) struct Brush<'a, 'p> {
    pub(super) pass: &'a Pass<'p>,
    pub(super) strands: &'a Strands,
    pub(super) place: &'a TileView<'a>,
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
        let mut fetched = Vec::with_capacity(FETCH_AT_ONCE);
        for some in self.pieces.chunks(BOUND_EVERY) {
            if f32::from_bits((some[0] >> 32) as u32) > self.guard.bound() {
                break;
            }
            // Some are fetched at a time: the machine waits for several at once then.
            for few in some.chunks(FETCH_AT_ONCE) {
                few.iter().for_each(|&key| self.call(key as u32));
                fetched.clear();
                for &key in few {
                    if let Some(piece) = self.fetch(f32::from_bits((key >> 32) as u32), key as u32) {
                        fetched.push(piece);
                    }
                }
                for piece in &fetched {
                    self.draw::<I>(piece);
                }
            }
        }
    }
}

impl Brush<'_, '_> {
    /// Lets memory bring a piece.
    #[inline(always)]
    fn call(&self, piece: u32) {
        lanes::prefetch(&self.band.knots[piece as usize]);
        let looks = &self.band.looks[(piece / self.strands.points_per_strand as u32) as usize];
        lanes::prefetch(&looks.x);
        lanes::prefetch(&looks.z);
    }

    /// A piece, where it may be seen.
    #[inline(always)]
    fn fetch(&self, nearest_m: f32, piece: u32) -> Option<Piece> {
        let (a, b) = (self.band.knots[piece as usize], self.band.knots[piece as usize + 1]);
        let TileView { from, to, .. } = *self.place;
        let pad = std::f32::consts::SQRT_2 * a.half_px.max(b.half_px);
        let columns = within(a.x, b.x, pad, from[0], to[0]);
        let rows = within(a.y, b.y, pad, from[1], to[1]);
        if !self.guard.may_show(nearest_m, columns, rows) {
            return None;
        }
        let points = self.strands.points_per_strand as u32;
        let strand = piece / points;
        let first = piece - strand * points;
        let id = self.band.ids[strand as usize];
        Some(Piece { a, b, looks: self.band.looks[strand as usize], number: piece, first, id })
    }

    #[inline(always)]
    fn draw<I: Isa>(&mut self, piece: &Piece) {
        let before = self.guard.count();
        match Narrow::new(&piece.a, &piece.b, self.window) {
            Some(narrow) => self.narrow::<I>(piece, &narrow),
            None => self.wide(piece),
        }
        if self.guard.count() > before {
            self.guard.keep_stroke(piece.number);
        }
    }

    #[inline(always)]
    fn narrow<I: Isa>(&mut self, piece: &Piece, narrow: &Narrow) {
        let TileView { from, skin, .. } = *self.place;
        let (pass, stroke) = (self.pass, self.guard.next_stroke());
        // From row to row, or from column to column where the ribbon lies flat, and from pixel to pixel.
        let (down, along) = if narrow.flat { (1, TILE) } else { (TILE, 1) };
        let [first_row, first_pixel] = if narrow.flat { [from[0], from[1]] } else { [from[1], from[0]] };
        let least = F32s::<I>::splat(piece.least_coverage());
        let mut first = narrow.rows[0];
        while first < narrow.rows[1] {
            let found = narrow.rows::<I>(first);
            let sites = self.sites(piece, F32s::<I>::of(&found.along));
            let inside = u32::MAX >> (u32::BITS - (narrow.rows[1] - first).min(I::LANES as i32) as u32);
            let origin = (first as usize - first_row) * down;
            let opacity = F32s::<I>::of(&sites.opacity);
            let code = Parts::codes(opacity);
            let (before, streak) = (self.guard.count(), self.guard.next_streak());
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
                    let fragment = Fragment::new(z_m, piece.id, Parts(parts[lane]), streak + lane as u32);
                    self.guard.add(pixel, fragment, || {
                        let hair = Hair { a: &piece.a, b: &piece.b, linear: found.linear.0[lane], z_m };
                        pass.before_skin(&hair, self.place.pixel(pixel), skin, pixel)
                    });
                }
            }
            first += I::LANES as i32;
            if self.guard.count() > before {
                let radiance = radiance_at(&piece.looks, F32s::<I>::of(&sites.s)).rows();
                self.guard.show(&radiance, &sites.s, stroke, (u32::BITS - inside.leading_zeros()) as usize);
            }
        }
    }

    /// A ribbon of any width, pixel by pixel.
    #[inline(always)]
    fn wide(&mut self, piece: &Piece) {
        let (pass, stroke) = (self.pass, self.guard.next_stroke());
        let least = piece.least_coverage();
        ribbon::rasterise(&piece.a, &piece.b, self.window, |share| {
            if share.coverage <= least {
                return;
            }
            let sites = self.sites(piece, F32s::<Scalar>::splat(share.along));
            let (z_m, parts) = (sites.z_m.0[0], Parts::new(share.coverage, sites.opacity.0[0]));
            let pixel = self.place.at(share.pixel[0] as usize, share.pixel[1] as usize);
            let skin = self.place.skin;
            let before = self.guard.count();
            let fragment = Fragment::new(z_m, piece.id, parts, self.guard.next_streak());
            self.guard.make_room(1);
            self.guard.add(pixel, fragment, || {
                let hair = Hair { a: &piece.a, b: &piece.b, linear: share.linear, z_m };
                pass.before_skin(&hair, share.pixel, skin, pixel)
            });
            if self.guard.count() > before {
                let radiance = radiance_at(&piece.looks, F32s::<Scalar>::of(&sites.s)).rows();
                self.guard.show(&radiance, &sites.s, stroke, 1);
            }
        });
    }

    /// What a hair is like at places `along` a piece.
    #[inline(always)]
    fn sites<I: Isa>(&self, piece: &Piece, along: F32s<I>) -> Sites {
        let s = (along + piece.first as f32) * self.pass.per_piece;
        Sites {
            z_m: (along * (piece.b.z_m - piece.a.z_m) + piece.a.z_m).row(),
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

/// A piece of a strand.
struct Piece {
    a: Knot,
    b: Knot,
    looks: Vec3Row,
    /// Its number in the band.
    number: u32,
    /// Its number along the strand.
    first: u32,
    id: u32,
}

impl Piece {
    /// Coverage that is not worth a fragment.
    #[inline(always)]
    fn least_coverage(&self) -> f32 {
        LEAST_SHARE * (2.0 * self.a.half_px.max(self.b.half_px)).min(1.0)
    }
}

/// Columns or rows of a tile that two knots and what lies between them touch.
#[inline(always)]
fn within(a: f32, b: f32, pad: f32, from: usize, to: usize) -> [usize; 2] {
    let cut = |v: f32| ((v - from as f32).max(0.0) as i32 as usize).min(to - from - 1);
    [cut(a.min(b) - pad), cut(a.max(b) + pad)]
}

/// Pieces fetched before they are drawn.
const FETCH_AT_ONCE: usize = 32;

/// Pieces drawn between looks at what is hidden by now.
const BOUND_EVERY: usize = 128;
