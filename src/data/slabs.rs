//! How a stack is cut into slabs.

use serde::{Deserialize, Serialize};

/// Slabs over one another, from the skin on. Heights are over the stack's, 0 at the skin.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Slabs {
    /// Height of the skin, 0, and of the top of each slab.
    tops: Vec<f32>,
}

impl Slabs {
    /// So many of equal height, 1 at least.
    pub fn even(count: usize) -> Self {
        let count = count.max(1);
        Self { tops: (0..=count).map(|slab| slab as f32 / count as f32).collect() }
    }

    /// With these tops, 0 first: that of the skin. None unless each lies above the one before and none above 1.
    pub fn with_tops(tops: Vec<f32>) -> Option<Self> {
        let rising = tops.windows(2).all(|pair| pair[0] < pair[1]);
        let within = tops.len() > 1 && tops[0] == 0.0 && tops.iter().all(|top| *top <= 1.0);
        (rising && within).then_some(Self { tops })
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.tops.len() - 1
    }

    /// Height of the skin, 0, and of the top of each slab.
    pub fn tops(&self) -> &[f32] {
        &self.tops
    }

    /// Bottom and top of slab 0 … count − 1.
    pub fn span(&self, slab: usize) -> [f32; 2] {
        [self.tops[slab], self.tops[slab + 1]]
    }

    /// Height of the middle of a slab.
    pub fn middle(&self, slab: usize) -> f32 {
        0.5 * (self.tops[slab] + self.tops[slab + 1])
    }

    /// How high a slab is.
    pub fn thickness(&self, slab: usize) -> f32 {
        self.tops[slab + 1] - self.tops[slab]
    }

    /// The slab at a height. What stands out above the last belongs to it.
    pub fn at(&self, height: f32) -> usize {
        (self.tops.partition_point(|top| *top <= height).max(1) - 1).min(self.count() - 1)
    }
}
