//! The fragments of guard hair in one tile, pixel by pixel, each in its order of depth.

use crate::render::bins::TILE;
use crate::render::resolve::{HIDDEN, settle};
use crate::render::strands::Fragment;

/// Pixels of a tile.
const PIXELS: usize = TILE * TILE;
/// Edge of a block of pixels that share one bound, px.
const BLOCK: usize = 8;
/// Blocks along a tile's edge.
const BLOCKS: usize = TILE / BLOCK;

/// Fragments of a tile: first gathered as they come, nearest pieces first, then settled pixel by pixel.
pub(super) struct Gathered {
    loose: Vec<Loose>,
    counts: Vec<u32>,
    /// Of what was gathered, at least.
    through: Vec<f32>,
    /// Greatest depth gathered, m.
    last_m: Vec<f32>,
    /// Depth from which on nothing of a pixel is seen, m.
    limit_m: Vec<f32>,
    /// Greatest of `limit_m` in blocks of pixels, as it was a while ago: it only ever shrinks.
    block_m: [f32; BLOCKS * BLOCKS],
    fragments: Vec<Fragment>,
    /// Transmittance of a pixel's fragments up to and with each.
    veil: Vec<f32>,
    /// First fragment of each pixel and one past the last.
    spans: Vec<[u32; 2]>,
}

#[derive(Clone, Copy)]
struct Loose {
    fragment: Fragment,
    pixel: u32,
}

impl Default for Gathered {
    fn default() -> Self {
        Self {
            loose: Vec::new(),
            counts: vec![0; PIXELS],
            through: vec![1.0; PIXELS],
            last_m: vec![0.0; PIXELS],
            limit_m: vec![f32::INFINITY; PIXELS],
            block_m: [f32::INFINITY; BLOCKS * BLOCKS],
            fragments: Vec::new(),
            veil: Vec::new(),
            spans: vec![[0; 2]; PIXELS],
        }
    }
}

impl Gathered {
    /// Forgets the last tile. Behind `limit_m`, by pixel, nothing is seen; −∞ outside the picture.
    pub(super) fn begin(&mut self, limit_m: impl Fn(usize) -> f32) {
        self.loose.clear();
        self.fragments.clear();
        self.veil.clear();
        self.counts.fill(0);
        self.through.fill(1.0);
        self.last_m.fill(0.0);
        self.spans.fill([0; 2]);
        self.limit_m.iter_mut().enumerate().for_each(|(at, limit)| *limit = limit_m(at));
        self.bound();
    }

    /// Brings the blocks' bounds up to date; returns the depth from which on nothing of the tile is seen, m.
    pub(super) fn bound(&mut self) -> f32 {
        self.block_m.fill(f32::NEG_INFINITY);
        for (row, limits) in self.limit_m.chunks_exact(TILE).enumerate() {
            let blocks = &mut self.block_m[row / BLOCK * BLOCKS..][..BLOCKS];
            for (bound, limits) in blocks.iter_mut().zip(limits.chunks_exact(BLOCK)) {
                *bound = limits.iter().fold(*bound, |a, &b| if a < b { b } else { a });
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
        self.limit_m[pixel]
    }

    /// Adds a fragment.
    #[inline(always)]
    pub(super) fn push(&mut self, pixel: usize, fragment: Fragment) {
        let z_m = fragment.z_m();
        self.counts[pixel] += 1;
        let last_m = self.last_m[pixel].max(z_m);
        self.last_m[pixel] = last_m;
        // Pieces of one hair will be joined, which hides no less than one after the other.
        let through = self.through[pixel] * (1.0 - fragment.alpha());
        self.through[pixel] = through;
        if through < HIDDEN {
            self.limit_m[pixel] = self.limit_m[pixel].min(last_m);
        }
        self.loose.push(Loose { fragment, pixel: pixel as u32 });
    }

    /// Puts every pixel's fragments in order, joins neighbouring pieces of one hair and leaves out what is hidden.
    pub(super) fn settle(&mut self) {
        let mut end = 0;
        for (span, &count) in self.spans.iter_mut().zip(&self.counts) {
            *span = [end; 2];
            end += count;
        }
        self.fragments.resize(end as usize, Fragment::default());
        self.veil.resize(end as usize, 0.0);
        for loose in &self.loose {
            let next = &mut self.spans[loose.pixel as usize][1];
            self.fragments[*next as usize] = loose.fragment;
            *next += 1;
        }
        for (pixel, span) in self.spans.iter_mut().enumerate() {
            let [from, to] = span.map(|at| at as usize);
            if from == to {
                continue;
            }
            let (fragments, veil) = (&mut self.fragments[from..to], &mut self.veil[from..to]);
            let count = settle(fragments, veil);
            if veil[count - 1] < HIDDEN {
                self.limit_m[pixel] = self.limit_m[pixel].min(fragments[count - 1].z_m());
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
