//! A plan as a job of a farm's own engine.

mod openjd;
mod slurm;

pub use openjd::openjd;
pub use slurm::slurm;

/// How a plan is cut.
#[derive(Clone, Copy, Debug)]
pub struct Cut {
    /// Items of the plan.
    pub items: usize,
    /// Items that one machine takes at once.
    pub chunk: usize,
    /// What a chunk costs on one thread, s.
    pub chunk_seconds: f64,
}

impl Cut {
    /// Of a plan whose items cost so much together; about two minutes each where nothing is said.
    pub fn new(items: usize, seconds: f64, chunk: Option<usize>) -> Self {
        let each = seconds / items.max(1) as f64;
        let chunk = chunk.unwrap_or(((CHUNK_S / each.max(1e-3)) as usize).clamp(1, 1000));
        Self { items, chunk, chunk_seconds: each * chunk as f64 }
    }
}

/// What a chunk costs where nothing is said, s: far more than a process needs to start, far less than one likes to lose.
const CHUNK_S: f64 = 120.0;
