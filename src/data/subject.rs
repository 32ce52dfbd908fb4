//! What a picture is taken of, as far as camera and lights need to know it.

use super::camera::Camera;
use super::light::InWorld;
use crate::error::Result;
use crate::math::{DVec3, Vec3};

/// The extent of an asset, and the cameras and lights that it brings along.
#[derive(Clone, Debug, Default)]
pub struct Subject {
    /// Where the origin of `points_m` lies in the world, m.
    pub origin_m: DVec3,
    /// Points of the skin in the rest pose, m, relative to `origin_m`.
    pub points_m: Vec<Vec3>,
    /// How far hair reaches from the skin at each of these points, m.
    pub hair_m: Vec<f32>,
    /// The asset's own cameras, in world coordinates; an error says why one of them takes no picture.
    pub cameras: Vec<Named<Camera>>,
    /// The asset's own lights.
    pub lights: Vec<Named<InWorld>>,
}

/// Something that goes by one or more names.
#[derive(Clone, Debug)]
pub struct Named<T> {
    /// Its names, at least one.
    pub names: Vec<String>,
    /// What it is, or why it cannot be used.
    pub value: Result<T>,
}
