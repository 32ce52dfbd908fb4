//! Floor 4: draws a coat as a game would.

pub mod cpu;
