//! The one test binary; each module says what it holds.

mod accuracy;
mod common;
mod field;
mod meshes;
mod patch;
