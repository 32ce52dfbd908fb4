//! The fragments of guard hair in one tile, pixel by pixel, each in its order of depth.

use crate::math::{Vec3, radix};
use crate::render::bins::TILE;
use crate::render::resolve::{HIDDEN, Pile, Touch};
use crate::render::strands::{Fragment, Streak};

/// Pixels of a tile.
const PIXELS: usize = TILE * TILE;
/// Edge of a block of pixels that share one bound, px.
const BLOCK: usize = 8;
/// Blocks along a tile's edge.
const BLOCKS: usize = TILE / BLOCK;

/// Fragments of a tile: rows of ribbons are gathered as they come, nearest pieces first, then dealt out to the pixels in the order
/// of depth.
pub(super) struct Gathered {
    strokes: Vec<Stroke>,
    streaks: Vec<Streak>,
    /// As many as streaks.
    rows: Vec<Row>,
    /// Covered shares of the rows' pixels; 0 where nothing is seen.
    shares: Vec<f32>,
    pixels: Vec<Fill>,
    /// Greatest limit in blocks of pixels, as it was a while ago: it only ever shrinks.
    block_m: [f32; BLOCKS * BLOCKS],
    /// Depth's bits and number of each row.
    order: Vec<u64>,
    piles: Vec<Pile>,
    fragments: Vec<Fragment>,
    /// First fragment of each pixel.
    starts: Vec<u32>,
    /// Transmittance of a pixel's fragments behind which nothing is kept.
    hidden: f32,
}

/// What all fragments of a piece have in common.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stroke {
    /// Direction of the hair.
    pub(super) tangent: Vec3,
    /// Colour that multiplies the profile's ramp.
    pub(super) tint: Vec3,
}

/// Pixels next to one another that a hair covers in part at one depth.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    /// Depth along the optical axis, m.
    pub(super) z_m: f32,
    /// Source index of the hair.
    pub(super) id: u32,
    /// The hair's own opacity, in [0, 1].
    pub(super) opacity: f32,
    /// First pixel of the tile.
    pub(super) pixel: u16,
    /// From one pixel to the next.
    pub(super) stride: u16,
    /// One past the last share.
    end: u32,
}

/// What a pixel has gathered so far.
#[derive(Clone, Copy, Debug)]
struct Fill {
    /// Depth from which on nothing is seen, m.
    limit_m: f32,
    /// Depth before which everything lies before the skin, m.
    clear_m: f32,
    /// Of what was gathered, at least.
    through: f32,
    /// Greatest depth gathered, m.
    last_m: f32,
    /// Fragments.
    count: u32,
}

impl Default for Gathered {
    fn default() -> Self {
        let fill = Fill { limit_m: 0.0, clear_m: 0.0, through: 1.0, last_m: 0.0, count: 0 };
        Self {
            strokes: Vec::new(),
            streaks: Vec::new(),
            rows: Vec::new(),
            shares: Vec::new(),
            pixels: vec![fill; PIXELS],
            block_m: [f32::INFINITY; BLOCKS * BLOCKS],
            order: Vec::new(),
            piles: vec![Pile::default(); PIXELS],
            fragments: Vec::new(),
            starts: vec![0; PIXELS],
            hidden: 0.0,
        }
    }
}

impl Gathered {
    /// Forgets the last tile. Of each pixel, `limits_m` gives the depth from which on nothing is seen, −∞ outside the picture, and
    /// that before which everything lies before the skin. A front that lets through less than `opaque` hides what is behind it.
    pub(super) fn begin(&mut self, opaque: f32, limits_m: impl Fn(usize) -> [f32; 2]) {
        self.hidden = HIDDEN * opaque;
        self.strokes.clear();
        self.streaks.clear();
        self.rows.clear();
        self.shares.clear();
        self.fragments.clear();
        self.piles.fill(Pile::default());
        for (at, fill) in self.pixels.iter_mut().enumerate() {
            let [limit_m, clear_m] = limits_m(at);
            *fill = Fill { limit_m, clear_m, through: 1.0, last_m: 0.0, count: 0 };
        }
        self.bound();
    }

    /// Brings the blocks' bounds up to date; returns the depth from which on nothing of the tile is seen, m.
    pub(super) fn bound(&mut self) -> f32 {
        self.block_m.fill(f32::NEG_INFINITY);
        for (row, fills) in self.pixels.chunks_exact(TILE).enumerate() {
            let blocks = &mut self.block_m[row / BLOCK * BLOCKS..][..BLOCKS];
            for (bound, fills) in blocks.iter_mut().zip(fills.chunks_exact(BLOCK)) {
                *bound = fills.iter().fold(*bound, |a, b| if a < b.limit_m { b.limit_m } else { a });
            }
        }
        self.block_m.iter().copied().fold(f32::NEG_INFINITY, f32::max)
    }

    /// Whether anything of what lies at `nearest_m` or behind, within these columns and rows of the tile, may be seen.
    pub(super) fn may_show(&self, nearest_m: f32, columns: [usize; 2], rows: [usize; 2]) -> bool {
        (rows[0] / BLOCK..=rows[1] / BLOCK).any(|row| {
            (columns[0] / BLOCK..=columns[1] / BLOCK).any(|column| nearest_m <= self.block_m[row * BLOCKS + column])
        })
    }

    /// Depth from which on nothing of a pixel is seen, m.
    #[inline(always)]
    pub(super) fn limit_m(&self, pixel: usize) -> f32 {
        self.pixels[pixel].limit_m
    }

    /// Adds the shares of a row's pixels, from `row.pixel` on, where they may be seen; `before_skin` is asked where the skin is
    /// near. Says whether there were any.
    #[inline(always)]
    pub(super) fn push(
        &mut self,
        row: Row,
        shares: impl Iterator<Item = f32>,
        before_skin: impl Fn(usize) -> bool,
    ) -> bool {
        let begin = self.shares.len();
        let mut at = usize::from(row.pixel);
        let mut any = false;
        for share in shares {
            let fill = &mut self.pixels[at];
            let shown = share > 0.0 && row.z_m <= fill.limit_m && (row.z_m < fill.clear_m || before_skin(at));
            if shown {
                fill.add(row.z_m, share * row.opacity, self.hidden);
            }
            self.shares.push(if shown { share } else { 0.0 });
            any |= shown;
            at += usize::from(row.stride);
        }
        if any {
            self.rows.push(Row { end: self.shares.len() as u32, ..row });
        } else {
            self.shares.truncate(begin);
        }
        any
    }

    /// Says what the rows that were added last show, one by one.
    #[inline(always)]
    pub(super) fn show(&mut self, streak: Streak) {
        self.streaks.push(streak);
    }

    /// The number that the next piece will have.
    #[inline(always)]
    pub(super) fn next_stroke(&self) -> u32 {
        self.strokes.len() as u32
    }

    /// Says what a piece is like of which rows were added.
    #[inline(always)]
    pub(super) fn keep_stroke(&mut self, stroke: Stroke) {
        self.strokes.push(stroke);
    }

    /// What a fragment shows.
    #[inline(always)]
    pub(super) fn streak(&self, fragment: &Fragment) -> &Streak {
        &self.streaks[fragment.streak as usize]
    }

    /// The piece that a streak belongs to.
    #[inline(always)]
    pub(super) fn stroke(&self, streak: &Streak) -> &Stroke {
        &self.strokes[streak.stroke as usize]
    }

    /// Puts every pixel's fragments in order, joins neighbouring pieces of one hair and leaves out what is hidden. `spare` is room.
    pub(super) fn settle(&mut self, spare: &mut Vec<u64>) {
        self.order.clear();
        let keyed = |(number, row): (usize, &Row)| u64::from(row.z_m.to_bits()) << 32 | number as u64;
        self.order.extend(self.rows.iter().enumerate().map(keyed));
        radix::sort(&mut self.order, spare);
        let rows = &self.rows;
        let by_id = |&key: &u64| (rows[key as u32 as usize].id, key);
        for equal in self.order.chunk_by_mut(|a, b| a >> 32 == b >> 32).filter(|equal| equal.len() > 1) {
            equal.sort_unstable_by_key(by_id);
        }
        let mut end = 0;
        for (start, fill) in self.starts.iter_mut().zip(&self.pixels) {
            *start = end;
            end += fill.count;
        }
        self.fragments.resize(end as usize, Fragment::default());
        for &key in &self.order {
            let number = key as u32 as usize;
            let row = &self.rows[number];
            let begin = if number == 0 { 0 } else { self.rows[number - 1].end as usize };
            let mut at = usize::from(row.pixel);
            for &coverage in &self.shares[begin..row.end as usize] {
                if coverage > 0.0 {
                    let touch =
                        Touch { z_m: row.z_m, id: row.id, coverage, opacity: row.opacity, streak: number as u32 };
                    self.piles[at].add(&touch, self.hidden, &mut self.fragments[self.starts[at] as usize..]);
                }
                at += usize::from(row.stride);
            }
        }
        for pixel in 0..PIXELS {
            if let Some(last) = self.of(pixel).last().filter(|last| last.veil < self.hidden).copied() {
                let limit_m = &mut self.pixels[pixel].limit_m;
                *limit_m = limit_m.min(last.z_m);
            }
        }
    }

    /// What a pixel has gathered, in order.
    pub(super) fn of(&self, pixel: usize) -> &[Fragment] {
        &self.fragments[self.starts[pixel] as usize..][..self.piles[pixel].len()]
    }

    /// How many rows were gathered.
    #[inline(always)]
    pub(super) fn count(&self) -> usize {
        self.rows.len()
    }

    /// How many fragments were gathered.
    pub(super) fn len(&self) -> u64 {
        self.pixels.iter().map(|fill| u64::from(fill.count)).sum()
    }
}

impl Row {
    /// Of hair `id` at depth `z_m`, m, as opaque as `opacity`, from a pixel of the tile on by strides.
    #[inline(always)]
    pub(super) fn new(z_m: f32, id: u32, opacity: f32, pixel: usize, stride: usize) -> Self {
        Self { z_m, id, opacity, pixel: pixel as u16, stride: stride as u16, end: 0 }
    }
}

impl Fill {
    #[inline(always)]
    fn add(&mut self, z_m: f32, alpha: f32, hidden: f32) {
        self.count += 1;
        self.last_m = self.last_m.max(z_m);
        // Pieces of one hair will be joined, which hides no less than one after the other.
        self.through *= 1.0 - alpha;
        if self.through < hidden {
            self.limit_m = self.limit_m.min(self.last_m);
        }
    }
}
