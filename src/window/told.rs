//! What the window tells of itself: how quickly it answers, and how long changes take to be seen.

use serde::Serialize;
use std::time::{Duration, Instant};

/// How long input waited until the controls had taken note of it, drawing apart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Answers {
    /// How many there were.
    pub count: u64,
    /// Mean, ms.
    pub mean_ms: f64,
    /// The longest, ms.
    pub longest_ms: f64,
}

impl Answers {
    /// Takes note of one.
    pub fn add(&mut self, waited: Duration) {
        let ms = waited.as_secs_f64() * 1e3;
        self.count += 1;
        self.mean_ms += (ms - self.mean_ms) / self.count as f64;
        self.longest_ms = self.longest_ms.max(ms);
    }
}

/// From a change of the preset to a coat of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Took {
    /// Until it was baked, ms.
    pub baked_ms: Option<f64>,
    /// Until it was seen, ms.
    pub seen_ms: Option<f64>,
}

impl Took {
    /// Now it is baked.
    pub fn baked(&mut self, began: Option<Instant>) {
        self.baked_ms = began.map(|began| began.elapsed().as_secs_f64() * 1e3);
    }

    /// Now it is seen, where that is the first time.
    pub fn seen(&mut self, began: Option<Instant>) {
        self.seen_ms = self.seen_ms.or(began.map(|began| began.elapsed().as_secs_f64() * 1e3));
    }
}
