//! Physical laws that hold whatever the numbers are.

pub mod colour;
pub mod fibre;
pub mod shading;
pub mod way;
pub mod wet;
