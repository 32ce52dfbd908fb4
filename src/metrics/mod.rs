//! Floor 2: how far off, how long, how much: picture differences ([`compare`]) and rows of time and memory ([`timing`]).

pub mod compare;
pub mod timing;
