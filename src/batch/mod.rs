//! Floor 9: many assets (`docs/batch.md`). In: a library, which says what is baked how and where to ([`library`]). Out: an outcome per
//! asset ([`outcome`]).
//!
//! A [`plan::Plan`] is a numbered list; [`run::run`] bakes what of it is out of date, several assets at once. Whether an output is up
//! to date is told by the [`record`] of it: hashes of all that it was made from and of the output. Outputs are those of single bakes,
//! to the byte; they are whole or absent, and a run that was killed goes on where it was.

pub mod content;
pub mod estimate;
pub mod event;
pub mod fragments;
mod item;
pub mod journal;
pub mod junit;
pub mod key;
pub mod library;
pub mod outcome;
pub mod page;
pub mod plan;
pub mod range;
pub mod record;
pub mod results;
pub mod run;
pub mod schedule;
pub mod standing;

/// Raised whenever a bake gives other bytes from the same input, so that no output of an earlier program is taken for current.
/// `tests/batch/epoch.rs` compares the bytes.
pub const EPOCH: u32 = 3;
