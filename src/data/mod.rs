//! Floor 1: the plain data that one step hands to the next. Checked once, at construction.

pub mod camera;
pub mod coat;
pub mod distance;
pub mod fields;
pub mod film;
pub mod image;
pub mod light;
pub mod maps;
pub mod mesh;
pub mod paint;
pub mod parting;
pub mod patches;
pub mod ray;
pub mod shell;
pub mod slabs;
pub mod spread;
pub mod strands;
pub mod subject;
pub mod texture;
pub mod topology;
