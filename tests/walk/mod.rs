//! Paths through fur against closed forms and against another path tracer's radiances.

mod chiang;
pub mod forms;
mod pelt;
pub mod truth;
