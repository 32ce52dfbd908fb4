//! Which tiles of the picture things fall into.

use crate::math::split::cut;
use rayon::prelude::*;

/// Edge of a tile, px.
pub const TILE: usize = 32;

/// What a thing may touch on the picture, px; nothing where `from` is past `to`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reach {
    /// Lowest x and y.
    pub from: [f32; 2],
    /// Highest x and y.
    pub to: [f32; 2],
}

impl Reach {
    /// Touches nothing.
    pub const NOTHING: Self = Self { from: [f32::INFINITY; 2], to: [f32::NEG_INFINITY; 2] };
    /// May touch every pixel.
    pub const EVERYTHING: Self = Self { from: [f32::NEG_INFINITY; 2], to: [f32::INFINITY; 2] };

    /// Grows to hold the square of half width `pad` around a point.
    pub fn add(&mut self, x: f32, y: f32, pad: f32) {
        self.from = [self.from[0].min(x - pad), self.from[1].min(y - pad)];
        self.to = [self.to[0].max(x + pad), self.to[1].max(y + pad)];
    }
}

/// The tiles of a picture, or of a band of its rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TileGrid {
    /// Tiles per row.
    pub columns: usize,
    /// First row of tiles.
    pub first_row: usize,
    /// Rows of tiles.
    pub rows: usize,
}

impl TileGrid {
    /// The tiles of a whole picture of this size.
    pub fn whole(size: [usize; 2]) -> Self {
        Self { columns: size[0].div_ceil(TILE), first_row: 0, rows: size[1].div_ceil(TILE) }
    }

    /// Columns and rows of tiles, counted in this grid, that `reach` touches.
    pub fn touched(&self, reach: &Reach) -> (std::ops::Range<usize>, std::ops::Range<usize>) {
        let span = |axis: usize, first: usize, count: usize| {
            let at = |v: f32| v / TILE as f32 - first as f32;
            if reach.from[axis] > reach.to[axis] {
                return 0..0;
            }
            // Casts to an integer cut off, and saturate; NaN becomes 0.
            let from = at(reach.from[axis]).max(0.0) as i32 as usize;
            let last = at(reach.to[axis]);
            let to = if last >= 0.0 { (last as i32 as usize) + 1 } else { 0 };
            from.min(count)..to.min(count)
        };
        (span(0, 0, self.columns), span(1, self.first_row, self.rows))
    }
}

/// Items by tile.
#[derive(Clone, Debug, Default)]
pub struct Bins {
    starts: Vec<u32>,
    items: Vec<u32>,
}

impl Bins {
    /// Sorts the items 0 … count−1 into the tiles of `grid` that `reach` of each touches, in their order.
    pub fn new(grid: &TileGrid, count: usize, reach: impl Fn(usize) -> Reach + Sync) -> Self {
        // By chunk of items and row of tiles: columns and items.
        const CHUNK: usize = 1 << 15;
        let chunks: Vec<Vec<Vec<(u32, u32)>>> = (0..count.div_ceil(CHUNK))
            .into_par_iter()
            .map(|chunk| {
                let mut by_row = vec![Vec::new(); grid.rows];
                for item in chunk * CHUNK..((chunk + 1) * CHUNK).min(count) {
                    let (columns, rows) = grid.touched(&reach(item));
                    for pairs in &mut by_row[rows] {
                        pairs.extend(columns.clone().map(|column| (column as u32, item as u32)));
                    }
                }
                by_row
            })
            .collect();
        let of_row = |row: usize| chunks.iter().flat_map(move |by_row| &by_row[row]);
        let ends: Vec<u32> = (0..grid.rows)
            .scan(0, |end, row| {
                *end += chunks.iter().map(|by_row| by_row[row].len() as u32).sum::<u32>();
                Some(*end)
            })
            .collect();
        let mut starts = vec![0_u32; grid.columns * grid.rows + 1];
        let mut items = vec![0; ends.last().map_or(0, |&end| end as usize)];
        let (mut starts_left, mut items_left) = (&mut starts[1..], &mut items[..]);
        let rows: Vec<_> = (0..grid.rows)
            .map(|row| {
                let begin = if row == 0 { 0 } else { ends[row - 1] };
                (row, begin, cut(&mut starts_left, grid.columns), cut(&mut items_left, (ends[row] - begin) as usize))
            })
            .collect();
        rows.into_par_iter().for_each(|(row, begin, ends, items)| {
            let mut next = vec![0_u32; grid.columns];
            of_row(row).for_each(|&(column, _)| next[column as usize] += 1);
            let mut at = 0;
            for (next, end) in next.iter_mut().zip(ends) {
                (*next, at) = (at, at + *next);
                *end = begin + at;
            }
            for &(column, item) in of_row(row) {
                let next = &mut next[column as usize];
                items[*next as usize] = item;
                *next += 1;
            }
        });
        Self { starts, items }
    }

    /// The items of a tile.
    pub fn of(&self, tile: usize) -> &[u32] {
        &self.items[self.starts[tile] as usize..self.starts[tile + 1] as usize]
    }

    /// Items in some tiles from `first` on.
    pub fn items_of(&self, first: usize, tiles: usize) -> usize {
        (self.starts[first + tiles] - self.starts[first]) as usize
    }

    /// Items in all tiles, each counted once per tile.
    pub fn items(&self) -> usize {
        self.items.len()
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        4 * (self.starts.len() + self.items.len())
    }
}
