//! What the window tells of itself: how quickly it answers, and how long changes take to be seen.

use super::model::Model;
use crate::metrics::timing;
use serde::Serialize;
use std::sync::{Arc, Weak};
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

/// A coat of the last change of the preset: what it took to come.
#[derive(Debug, Default, Serialize)]
pub struct Coming {
    /// From the change until it was baked, ms.
    pub baked_ms: Option<f64>,
    /// From the change until it was seen, ms.
    pub seen_ms: Option<f64>,
    /// What the steps of its bake took.
    steps: timing::Steps,
    #[serde(skip)]
    model: Weak<Model>,
}

impl Coming {
    /// Takes note that it is baked.
    pub fn baked(&mut self, began: Option<Instant>, model: &Arc<Model>, steps: timing::Steps) {
        (self.baked_ms, self.steps, self.model) = (ms_since(began), steps, Arc::downgrade(model));
    }

    /// Takes note of a picture of `model`, where it is the first of this coat.
    pub fn seen(&mut self, began: Option<Instant>, model: &Arc<Model>) {
        if std::ptr::eq(self.model.as_ptr(), Arc::as_ptr(model)) {
            self.seen_ms = self.seen_ms.or(ms_since(began));
        }
    }
}

fn ms_since(began: Option<Instant>) -> Option<f64> {
    began.map(|began| began.elapsed().as_secs_f64() * 1e3)
}
