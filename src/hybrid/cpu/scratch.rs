//! One tile of the picture, and what its pixels hold while it is drawn.

use super::gather::Gathered;
use super::undercoat::PixelRay;
use crate::hybrid::resolve::VirtualFragment;
use crate::hybrid::skin::SkinTile;
use crate::volume::bins::TILE;
use crate::volume::march::Start;

/// A tile of the picture.
#[derive(Clone, Copy)]
pub(super) struct TileView<'t> {
    /// Index in the band's grid.
    pub(super) in_band: usize,
    /// Index in the whole picture's grid.
    pub(super) in_picture: usize,
    /// Its first pixel.
    pub(super) from: [usize; 2],
    /// One past its last pixel.
    pub(super) to: [usize; 2],
    pub(super) skin: &'t SkinTile,
}

impl TileView<'_> {
    /// Where a pixel of the picture lies in the tile.
    #[inline(always)]
    pub(super) fn at(&self, x: usize, y: usize) -> usize {
        (y - self.from[1]) * TILE + x - self.from[0]
    }

    /// Column and row of the picture of a pixel of the tile.
    #[inline(always)]
    pub(super) fn pixel(&self, at: usize) -> [i32; 2] {
        [(self.from[0] + at % TILE) as i32, (self.from[1] + at / TILE) as i32]
    }

    pub(super) fn pixels(self) -> impl Iterator<Item = (usize, usize, usize)> {
        let columns = self.from[0]..self.to[0];
        (self.from[1]..self.to[1]).flat_map(move |y| columns.clone().map(move |x| (self.at(x, y), x, y)))
    }
}

/// What a tile's pixels hold, kept between tiles for its memory.
pub(super) struct Scratch {
    pub(super) guard: Gathered,
    /// Depth's bits and index of each segment in the tile.
    pub(super) segments: Vec<u64>,
    pub(super) spare: Vec<u64>,
    pub(super) starts: Vec<Vec<Start>>,
    pub(super) rays: Vec<PixelRay>,
    pub(super) virtual_fragments: Vec<Vec<VirtualFragment>>,
    /// Depth from which on no undercoat is seen, m.
    pub(super) opaque_m: Vec<f32>,
    pub(super) fragment_count: u64,
    pub(super) step_count: u64,
    /// Time spent on ribbons, marching and compositing, ns.
    pub(super) spent_ns: [u64; 3],
}

impl Scratch {
    /// Forgets the last tile.
    pub(super) fn clear(&mut self) {
        self.starts.iter_mut().for_each(Vec::clear);
        self.virtual_fragments.iter_mut().for_each(Vec::clear);
        self.opaque_m.fill(f32::INFINITY);
    }
}

impl Default for Scratch {
    fn default() -> Self {
        const SIZE: usize = TILE * TILE;
        Self {
            guard: Gathered::default(),
            segments: Vec::new(),
            spare: Vec::new(),
            starts: vec![Vec::new(); SIZE],
            rays: Vec::new(),
            virtual_fragments: vec![Vec::new(); SIZE],
            opaque_m: vec![f32::INFINITY; SIZE],
            fragment_count: 0,
            step_count: 0,
            spent_ns: [0; 3],
        }
    }
}
