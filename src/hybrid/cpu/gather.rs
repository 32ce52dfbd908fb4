//! The fragments of guard hair in one tile, pixel by pixel, each in its order of depth.

use crate::hybrid::resolve::{HIDDEN, settle};
use crate::hybrid::strands::{Fragment, RibbonRow};
use crate::math::Vec3;
use crate::math::lanes::{self, MOST, Row, Vec3Row};
use crate::volume::bins::TILE;

/// Pixels of a tile.
const PIXELS: usize = TILE * TILE;
/// Edge of a block of pixels that share one bound, px.
const BLOCK: usize = 8;
/// Blocks along a tile's edge.
const BLOCKS: usize = TILE / BLOCK;

/// Fragments of a tile: first gathered as they come, nearest segments first, then settled pixel by pixel.
pub(super) struct Gathered {
    /// Segments of which something may be seen.
    segments: Vec<u32>,
    surfaces: Vec<SegmentSurface>,
    /// What fragments show, and where along the hair each ribbon row lies, in [0, 1]; longer than `ribbon row_count` says.
    ribbon_rows: Vec<RibbonRow>,
    along: Vec<f32>,
    ribbon_row_count: usize,
    /// Fragments as they came; longer than `count` says.
    loose: Vec<Fragment>,
    /// Where each of them falls.
    places: Vec<u16>,
    count: usize,
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

/// What all fragments of a segment have in common.
#[derive(Clone, Copy, Debug)]
pub(super) struct SegmentSurface {
    /// Direction of the hair.
    pub(super) tangent: Vec3,
    /// Colour that multiplies the profile's ramp.
    pub(super) tint: Vec3,
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
            segments: Vec::new(),
            surfaces: Vec::new(),
            ribbon_rows: Vec::new(),
            along: Vec::new(),
            ribbon_row_count: 0,
            loose: Vec::new(),
            places: Vec::new(),
            count: 0,
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
        self.segments.clear();
        self.surfaces.clear();
        (self.count, self.ribbon_row_count) = (0, 0);
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

    /// How many fragments were gathered.
    #[inline(always)]
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// Makes room for so many more fragments.
    #[inline(always)]
    pub(super) fn make_room(&mut self, more: usize) {
        if self.loose.len() < self.count + more {
            self.loose.resize(2 * (self.count + more), Fragment::default());
            self.places.resize(self.loose.len(), 0);
        }
    }

    /// Adds a fragment to a pixel where it may be seen; there must be room. `before_skin` is asked where the skin is near.
    #[inline(always)]
    pub(super) fn add(&mut self, pixel: usize, fragment: Fragment, before_skin: impl FnOnce() -> bool) {
        let z_m = fragment.z_m();
        let fill = &mut self.pixels[pixel];
        if z_m <= fill.limit_m && (z_m < fill.clear_m || before_skin()) {
            self.loose[self.count] = fragment;
            self.places[self.count] = pixel as u16;
            self.count += 1;
            fill.count += 1;
            fill.last_m = if z_m > fill.last_m { z_m } else { fill.last_m };
            // Segments of one hair will be joined, which hides no less than one after the other.
            fill.through *= 1.0 - fragment.alpha();
            if fill.through < self.hidden {
                fill.limit_m = if fill.last_m < fill.limit_m { fill.last_m } else { fill.limit_m };
            }
        }
    }

    /// The number of the next ribbon row.
    #[inline(always)]
    pub(super) fn next_ribbon_row(&self) -> u32 {
        self.ribbon_row_count as u32
    }

    /// Says what the fragments of the next `count` ribbon rows of `surface` show, at most [`MOST`], and where along the hair they lie.
    #[inline(always)]
    pub(super) fn show(&mut self, radiance: &Vec3Row, s: &Row, surface: u32, count: usize) {
        let at = self.ribbon_row_count;
        if self.ribbon_rows.len() < at + MOST {
            self.ribbon_rows.resize(2 * (at + MOST), RibbonRow::default());
            self.along.resize(self.ribbon_rows.len(), 0.0);
        }
        // All lanes are written, which is quicker than to count.
        for (lane, ribbon_row) in self.ribbon_rows[at..at + MOST].iter_mut().enumerate() {
            *ribbon_row = RibbonRow { radiance: radiance.lane(lane), surface };
        }
        self.along[at..at + MOST].copy_from_slice(&s.0);
        self.ribbon_row_count = at + count;
    }

    /// The number of the next surface.
    #[inline(always)]
    pub(super) fn next_surface(&self) -> u32 {
        self.segments.len() as u32
    }

    /// Says of which segment the fragments of the next surface are.
    #[inline(always)]
    pub(super) fn keep_surface(&mut self, segment: u32) {
        self.segments.push(segment);
    }

    /// Notes what the segments look like.
    pub(super) fn face(&mut self, surface: impl Fn(u32) -> SegmentSurface) {
        self.surfaces.extend(self.segments.iter().map(|&segment| surface(segment)));
    }

    /// What a fragment shows.
    #[inline(always)]
    pub(super) fn ribbon_row(&self, fragment: &Fragment) -> &RibbonRow {
        &self.ribbon_rows[fragment.ribbon_row as usize]
    }

    /// Lets memory bring what a pixel's fragments show.
    #[inline(always)]
    pub(super) fn call(&self, pixel: usize) {
        self.of(pixel).iter().for_each(|fragment| lanes::prefetch(self.ribbon_row(fragment)));
    }

    /// Where along its hair a fragment lies, in [0, 1].
    #[inline(always)]
    pub(super) fn along(&self, fragment: &Fragment) -> f32 {
        self.along[fragment.ribbon_row as usize]
    }

    /// The segment that a ribbon row belongs to.
    #[inline(always)]
    pub(super) fn surface(&self, ribbon_row: &RibbonRow) -> &SegmentSurface {
        &self.surfaces[ribbon_row.surface as usize]
    }

    /// Puts every pixel's fragments in order, joins neighbouring segments of one hair and leaves out what is hidden.
    pub(super) fn settle(&mut self) {
        let mut end = 0;
        for (span, fill) in self.spans.iter_mut().zip(&self.pixels) {
            *span = [end; 2];
            end += fill.count;
        }
        self.fragments.resize(end as usize, Fragment::default());
        self.veil.resize(end as usize, 0.0);
        for (fragment, &pixel) in self.loose[..self.count].iter().zip(&self.places) {
            let next = &mut self.spans[usize::from(pixel)][1];
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
}
