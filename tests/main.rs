//! One test binary; one file per subject.

mod common;
mod hostile;
