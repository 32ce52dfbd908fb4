//! What a window begins with, and what it wishes of whoever shows it.

use crate::bake::recipe::Choices;
use crate::gpu::Choice;
use crate::runtime::Blending;
use crate::stage::options::Options;
use crate::viewer::{Combing, Shown};
use crate::window::loading::Subject;
use crate::window::script::Script;
use std::path::PathBuf;

/// What the window is opened with.
pub struct Begin {
    /// What to look at.
    pub subject: Subject,
    /// Camera, light, development.
    pub stage: Options,
    /// What to draw.
    pub shown: Shown,
    /// Level of detail; none to choose by size.
    pub level: Option<usize>,
    /// How the coat is combed anew.
    pub combing: Combing,
    /// How shells and fins come together in a pixel.
    pub blend: Blending,
    /// Animation by name or number, and seconds into it.
    pub moment: Option<(String, f64)>,
    /// Whether the key light casts a shadow.
    pub shadow: bool,
    /// Which adapter draws.
    pub device: Choice,
    /// The bake of an input with these choices, as a command line.
    pub in_words: fn(&str, &Choices) -> String,
    /// What to do, if somebody else does it than a person.
    pub script: Script,
}

/// What the window itself is asked to do.
#[derive(Clone, Debug, PartialEq)]
pub enum Wish {
    /// To be of this size, pixels.
    Resize([u32; 2]),
    /// To write a picture of itself.
    Picture(PathBuf),
    /// To close.
    Close,
}
