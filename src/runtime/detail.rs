//! How coarse a coat may be drawn: by how many pixels its stack is high.

/// How much larger than it need be a level's coat is where the finer one begins to give way to it.
const EARLY: f32 = 1.25;

/// Which of a tile's levels are drawn, 0 being the finest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Detail {
    /// The finer of two.
    finer: usize,
    /// Share of the optical depth that the next coarser one has, in [0, 1).
    coarser: f32,
}

impl Detail {
    /// One level alone.
    pub fn fixed(level: usize) -> Self {
        Self { finer: level, coarser: 0.0 }
    }

    /// Of a stack that is `height_px` high, whose levels past the finest suffice up to `most_px` each.
    pub fn of(height_px: f32, mut most_px: impl Iterator<Item = f32> + Clone) -> Self {
        let finer = most_px.clone().take_while(|most| height_px <= *most).count();
        let next = most_px.nth(finer);
        let coarser = next.map_or(0.0, |most| (EARLY * most / height_px).max(1.0).ln() / EARLY.ln());
        Self { finer, coarser: coarser.min(0.999) }
    }

    /// The levels that are drawn, each with its share of the optical depth.
    pub fn levels(self) -> impl Iterator<Item = (usize, f32)> {
        [(self.finer, 1.0 - self.coarser), (self.finer + 1, self.coarser)].into_iter().filter(|(_, share)| *share > 0.0)
    }

    /// The level, between two where one gives way to the other.
    pub fn level(self) -> f32 {
        self.finer as f32 + self.coarser
    }

    /// Which of the two a level is: 0 the finer.
    pub fn turn(self, level: usize) -> usize {
        level - self.finer
    }

    /// Share of the fins. They stand for single hairs, and the coarser levels show none.
    pub fn fins(self) -> f32 {
        if self.finer == 0 { 1.0 - self.coarser } else { 0.0 }
    }
}
