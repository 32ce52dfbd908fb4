//! The one test binary; each module says what it holds.

mod accuracy;
mod coats;
mod runtime;
mod silhouette;
mod twins;
