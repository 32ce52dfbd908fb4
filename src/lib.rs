//! Furrier bakes fur for games: a mesh and a preset in, the same asset with shells and fins out, and how far off it is.
//!
//! The folders are the pipeline, read top to bottom in `docs/architecture.md`; a file imports only from lower floors.

pub mod asset;
pub mod bake;
pub mod batch;
pub mod cache;
pub mod cast;
pub mod cli;
pub mod coat;
pub mod data;
pub mod error;
pub mod fur;
pub mod gpu;
pub mod hybrid;
pub mod math;
pub mod metrics;
pub mod preset;
pub mod reference;
pub mod report;
pub mod runtime;
pub mod shade;
pub mod stage;
pub mod viewer;
pub mod volume;
#[cfg(feature = "window")]
pub mod window;

pub use error::{Error, Result};
