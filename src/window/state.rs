//! What the person at the window decides.

use super::comparison::Comparison;
use super::eye::Eye;
use super::lighting::Lighting;
use super::look::{Look, Moment};
use super::model::{Animation, Model};
use crate::runtime::{Blending, Spring, Wind};
use crate::stage::tone::Development;
use crate::viewer::{Combing, Shown};

/// Everything that controls change and pictures depend on.
pub struct State {
    /// Where the eye is.
    pub eye: Eye,
    /// Light and sky.
    pub lighting: Lighting,
    /// Exposure, tones, background.
    pub development: Development,
    /// What is drawn.
    pub shown: Shown,
    /// Level of detail; none to choose by size.
    pub level: Option<usize>,
    /// How shells and fins come together in a pixel.
    pub blend: Blending,
    /// Time in an animation.
    pub clock: Clock,
    /// The coat against its hair.
    pub comparison: Comparison,
    /// How the coat is combed anew.
    pub combing: Combing,
    /// What moves hair.
    pub wind: Wind,
    /// How it swings; none where it follows the skin alone.
    pub spring: Option<Spring>,
    /// What of the window is open.
    pub open: Open,
}

/// What of the window is open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Open {
    /// The panel with all controls.
    pub panel: bool,
    /// The list of keys.
    pub help: bool,
    /// Whether the statistics are counted, which takes a further pass at rest.
    pub counting: bool,
}

impl State {
    /// How the model is looked at in a picture of `size`.
    pub fn look(&self, size: [u32; 2]) -> Look {
        Look {
            camera: self.eye.camera(),
            size,
            lighting: self.lighting.clone(),
            development: self.development,
            shown: self.shown,
            level: self.level,
            combing: self.combing,
            blend: self.blend,
            moment: self.clock.moment(),
        }
    }

    /// How many levels of detail the model has.
    pub fn levels(model: &Model) -> usize {
        model.coat.tiles.iter().map(|tile| 1 + tile.levels.len()).max().unwrap_or(0)
    }
}

/// Time in an animation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock {
    /// Which; none in the rest pose.
    pub animation: Option<usize>,
    /// Seconds into it.
    pub seconds: f64,
    /// Whether time passes.
    pub playing: bool,
    /// How quickly it passes, 1 being as it should.
    pub speed: f64,
}

impl Default for Clock {
    fn default() -> Self {
        Self { animation: None, seconds: 0.0, playing: false, speed: 1.0 }
    }
}

impl Clock {
    /// Where it stands.
    pub fn moment(&self) -> Option<Moment> {
        self.animation.map(|animation| Moment { animation, seconds: self.seconds })
    }

    /// Lets `elapsed_s` pass; at its end the animation begins again.
    pub fn pass(&mut self, elapsed_s: f64, animations: &[Animation]) {
        let Some(animation) = self.animation.and_then(|index| animations.get(index)) else {
            self.playing = false;
            return;
        };
        if self.playing && animation.seconds > 0.0 {
            self.seconds = (self.seconds + elapsed_s * self.speed).rem_euclid(animation.seconds);
        }
    }

    /// Plays or stops; the first animation where none is chosen yet.
    pub fn toggle(&mut self, animations: &[Animation]) {
        if self.animation.is_none() && !animations.is_empty() {
            self.animation = Some(0);
        }
        self.playing = !self.playing && self.animation.is_some();
    }
}
