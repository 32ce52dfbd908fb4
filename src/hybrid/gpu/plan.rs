//! How much of a picture is drawn at once: bands of rows whose buffers fit a budget.

use super::items::VirtualFragmentItem;
use super::layout::Totals;
use crate::error::{Error, Kind, Result};

/// Pixels of a band that the 64 threads of a triangle look at, at most: a software driver ends loops after 65,535 rounds.
const MOST_PIXELS: usize = 64 * 60_000;

/// Bytes of each pixel: film, skin, what hides, first virtual_fragment, span and cursor.
pub(super) const PIXEL_BYTES: usize = FILM_BYTES + 7 * 4;
/// Bytes of a pixel's film.
pub(super) const FILM_BYTES: usize = 64;
/// Bytes of a point where a ray enters the shell.
pub(super) const START_BYTES: usize = 8;
/// Bytes of a fragment of guard hair, in five buffers of four.
pub(super) const FRAGMENT_BYTES: usize = 20;
/// Bytes of a virtual fragment.
pub(super) const VIRTUAL_FRAGMENT_BYTES: usize = size_of::<VirtualFragmentItem>();

/// What a band's buffers hold at most.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Room {
    /// Pixels.
    pub pixels: usize,
    /// Places where rays enter the shell.
    pub starts: usize,
    /// Fragments of guard hair.
    pub fragments: usize,
    /// Virtual fragments of undercoat.
    pub virtual_fragments: usize,
}

/// Rows per band, and room for them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Plan {
    /// Rows per band.
    pub rows: usize,
    /// Room that is made.
    pub room: Room,
    /// Room that can be made.
    most: Room,
    width: usize,
}

impl Plan {
    /// For a picture of `size`, buffers of `budget_bytes` together and `largest_bytes` each.
    pub fn new(size: [usize; 2], budget_bytes: usize, largest_bytes: usize) -> Self {
        let [width, height] = size;
        let share = |percent: usize| budget_bytes / 100 * percent;
        let fit = |percent, bytes: usize, largest: usize| {
            (share(percent) / bytes).min(largest_bytes / largest).clamp(1, u32::MAX as usize / 2)
        };
        let most = Room {
            pixels: fit(25, PIXEL_BYTES, FILM_BYTES).min(MOST_PIXELS).max(width),
            starts: fit(5, START_BYTES, START_BYTES),
            fragments: fit(35, FRAGMENT_BYTES, 4),
            virtual_fragments: fit(35, VIRTUAL_FRAGMENT_BYTES, VIRTUAL_FRAGMENT_BYTES),
        };
        let rows = (most.pixels / width).clamp(1, height);
        let pixels = rows * width;
        // Little at first: a band that needs more says so.
        let room = Room {
            pixels,
            starts: most.starts.min(2 * pixels),
            fragments: most.fragments.min(16 * pixels),
            virtual_fragments: most.virtual_fragments.min(6 * pixels),
        };
        Self { rows, room, most, width }
    }

    /// A plan with more room where a band came to `totals` and some did not fit.
    ///
    /// # Errors
    /// [`Kind::Device`] where a single row does not fit.
    pub fn grown(self, totals: &Totals) -> Result<Self> {
        let needs = [totals.starts, totals.fragments, totals.virtual_fragments].map(|n| n as usize);
        let most = [self.most.starts, self.most.fragments, self.most.virtual_fragments];
        let room = [self.room.starts, self.room.fragments, self.room.virtual_fragments];
        let short = (0..3).any(|i| needs[i] > room[i]);
        let mut next = self;
        // By how much the neediest list passes what can be made.
        let excess = (0..3).map(|i| needs[i] as f64 / most[i] as f64).fold(0.0, f64::max);
        if !short || excess > 1.0 {
            // A list that was too short without saying so has counted past 32 bits.
            let factor = if short { 0.8 / excess } else { 0.5 };
            if self.rows == 1 {
                return Err(Error::new(Kind::Device, "a row of the picture does not fit the graphics device")
                    .with_found(format!("{} fragments and {} virtual fragments", needs[1], needs[2]))
                    .with_expected(format!("at most {} and {}", most[1], most[2])));
            }
            next.rows = ((self.rows as f64 * factor) as usize).clamp(1, self.rows - 1);
            next.room.pixels = next.rows * self.width;
        }
        let roomier = |i: usize| (needs[i] + needs[i] / 4).clamp(room[i].min(most[i]), most[i]);
        next.room.starts = roomier(0);
        next.room.fragments = roomier(1);
        next.room.virtual_fragments = roomier(2);
        Ok(next)
    }
}
