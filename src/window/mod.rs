//! Floor 10: a window to turn a coat in (`docs/window.md`).
//!
//! In: what to look at and how ([`Begin`]). The picture is the runtime's, drawn on a thread of its own (`drawing`); another reads
//! and bakes (`loading`); what the person decides is in `state`. The contents ([`App`]) do not know the system's window
//! (`shell`), so that tests show them without one.

pub mod app;
mod canvas;
pub mod comparison;
mod drawing;
pub mod edits;
mod eye;
pub mod keys;
pub mod lighting;
pub mod loading;
mod look;
mod mailbox;
mod model;
mod painter;
mod panel;
mod parameters;
pub mod remember;
pub mod script;
pub mod sections;
mod set;
mod shell;
mod state;
mod told;
mod truth;
mod watch;

pub use app::{App, Begin, Wish};
pub use shell::open;
