//! Paths through fur against closed forms and against another path tracer's radiances.

mod chiang;
mod pelt;
#[path = "/tmp/probe.rs"]
mod probe;
