//! A picture and what it took.

use crate::data::film::Film;
use crate::metrics::timing::Steps;

/// A picture and what it took.
#[derive(Clone, Debug, Default)]
pub struct Picture {
    /// The film.
    pub film: Film,
    /// Time and memory per step: the rows of Andersen et al. 2016, Table 1. Steps that run tile by tile are given by their share of
    /// the threads' time; bytes are what they hold at most.
    pub steps: Steps,
    /// Strands drawn, segments and fragments of them, summed over bands.
    pub counts: Counts,
}

/// How much was drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Strands that were not hidden.
    pub strands: u64,
    /// Their segments.
    pub segments: u64,
    /// Fragments of guard hair composited.
    pub fragments: u64,
    /// Steps through undercoat.
    pub steps: u64,
    /// Sub-elements filled.
    pub subelements: u64,
}
