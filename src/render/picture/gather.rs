//! The fragments of guard hair in one tile, pixel by pixel, each in its order of depth.

use crate::render::bins::TILE;
use crate::render::resolve::{HIDDEN, settle};
use crate::render::strands::{Fragment, Streak};

/// Pixels of a tile.
const PIXELS: usize = TILE * TILE;
/// Edge of a block of pixels that share one bound, px.
const BLOCK: usize = 8;
/// Blocks along a tile's edge.
const BLOCKS: usize = TILE / BLOCK;

/// Fragments of a tile: first gathered as they come, nearest pieces first, then settled pixel by pixel.
pub(super) struct Gathered {
    loose: Vec<Fragment>,
    streaks: Vec<Streak>,
    pixels: Vec<Fill>,
    /// Greatest limit in blocks of pixels, as it was a while ago: it only ever shrinks.
    block_m: [f32; BLOCKS * BLOCKS],
    fragments: Vec<Fragment>,
    /// Transmittance of a pixel's fragments up to and with each.
    veil: Vec<f32>,
    /// First fragment of each pixel and one past the last.
    spans: Vec<[u32; 2]>,
    /// Transmittance of a pixel's fragments behind which nothing is kept.
    hidden: f32,
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
            loose: Vec::new(),
            streaks: Vec::new(),
            pixels: vec![fill; PIXELS],
            block_m: [f32::INFINITY; BLOCKS * BLOCKS],
            fragments: Vec::new(),
            veil: Vec::new(),
            spans: vec![[0; 2]; PIXELS],
            hidden: 0.0,
        }
    }
}

impl Gathered {
    /// Forgets the last tile. Of each pixel, `limits_m` gives the depth from which on nothing is seen, −∞ outside the picture, and
    /// that before which everything lies before the skin. A front that lets through less than `opaque` hides what is behind it.
    pub(super) fn begin(&mut self, opaque: f32, limits_m: impl Fn(usize) -> [f32; 2]) {
        self.hidden = HIDDEN * opaque;
        self.loose.clear();
        self.streaks.clear();
        self.fragments.clear();
        self.veil.clear();
        self.spans.fill([0; 2]);
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

    /// Depth before which everything of a pixel lies before its skin, m.
    #[inline(always)]
    pub(super) fn clear_m(&self, pixel: usize) -> f32 {
        self.pixels[pixel].clear_m
    }

    /// The number of the next streak.
    #[inline(always)]
    pub(super) fn next_streak(&self) -> u32 {
        self.streaks.len() as u32
    }

    /// Keeps the streak of the fragments that were added since the last one, if there are any.
    #[inline(always)]
    pub(super) fn keep_streak(&mut self, streak: impl FnOnce() -> Streak) {
        if self.loose.last().is_some_and(|last| last.streak == self.next_streak()) {
            self.streaks.push(streak());
        }
    }

    /// What a fragment shows.
    #[inline(always)]
    pub(super) fn streak(&self, fragment: &Fragment) -> &Streak {
        &self.streaks[fragment.streak as usize]
    }

    /// Adds a fragment.
    #[inline(always)]
    pub(super) fn push(&mut self, fragment: Fragment) {
        let z_m = fragment.z_m();
        let fill = &mut self.pixels[fragment.pixel as usize];
        fill.count += 1;
        fill.last_m = fill.last_m.max(z_m);
        // Pieces of one hair will be joined, which hides no less than one after the other.
        fill.through *= 1.0 - fragment.alpha();
        if fill.through < self.hidden {
            fill.limit_m = fill.limit_m.min(fill.last_m);
        }
        self.loose.push(fragment);
    }

    /// Puts every pixel's fragments in order, joins neighbouring pieces of one hair and leaves out what is hidden.
    pub(super) fn settle(&mut self) {
        let mut end = 0;
        for (span, fill) in self.spans.iter_mut().zip(&self.pixels) {
            *span = [end; 2];
            end += fill.count;
        }
        self.fragments.resize(end as usize, Fragment::default());
        self.veil.resize(end as usize, 0.0);
        for fragment in &self.loose {
            let next = &mut self.spans[fragment.pixel as usize][1];
            self.fragments[*next as usize] = *fragment;
            *next += 1;
        }
        for (pixel, span) in self.spans.iter_mut().enumerate() {
            let [from, to] = span.map(|at| at as usize);
            if from == to {
                continue;
            }
            let (fragments, veil) = (&mut self.fragments[from..to], &mut self.veil[from..to]);
            let count = settle(fragments, veil, self.hidden);
            if veil[count - 1] < self.hidden {
                let limit_m = &mut self.pixels[pixel].limit_m;
                *limit_m = limit_m.min(fragments[count - 1].z_m());
            }
            span[1] = (from + count) as u32;
        }
    }

    /// What a pixel has gathered, in order.
    pub(super) fn of(&self, pixel: usize) -> &[Fragment] {
        let [from, to] = self.spans[pixel];
        &self.fragments[from as usize..to as usize]
    }

    /// Transmittance of a pixel's fragments up to and with each.
    pub(super) fn veil(&self, pixel: usize) -> &[f32] {
        let [from, to] = self.spans[pixel];
        &self.veil[from as usize..to as usize]
    }

    /// How many were gathered.
    pub(super) fn len(&self) -> usize {
        self.loose.len()
    }
}
