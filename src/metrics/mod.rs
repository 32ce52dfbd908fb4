//! Floor 2: how far off, how long, how much: picture differences ([`compare`]), a coat's from its fur ([`likeness`]), and rows of
//! time and memory ([`timing`]).

pub mod compare;
pub mod likeness;
pub mod timing;
