//! Floor 5: single rays cast at hair by hair, as slow and as plain as it gets. What shells, gains and fins are baked from.
//!
//! [`Geometry`] goes in, [`Caster::new`] makes it ready for rays, and [`Caster::render`] fills a film along the rays of
//! [`Rays`] within a [`DepthRange`](crate::data::ray::DepthRange): every crossing is found, ordered by (depth, id) and
//! composited exactly. It has no resolution of its own, and knows nothing of light.

pub mod bvh;
mod caster;
pub mod cone;
mod geometry;
mod rays;
mod seen;
mod segments;

pub use caster::Caster;
pub use geometry::Geometry;
pub use rays::Rays;
