//! The one test binary; each module says what it holds.

mod accuracy;
mod harness;
mod laws;
mod pelts;
mod ribbons;
