//! Floor 4: draws a coat as a game would, after skinning and morphing: skin, fins, shells inner to outer.
//!
//! [`Scene`] says what to draw, [`View`] from where and in which light; [`gpu::Renderer`] draws it. [`cpu`] is the law of
//! opacity at one pixel, in plain steps.

pub mod cpu;
pub mod gpu;
mod scene;

pub use scene::{Fur, MAX_LIGHTS, Picture, Scene, Show, Skin, View};
