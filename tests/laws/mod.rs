//! Physical laws that hold whatever the numbers are.

pub mod shading;
