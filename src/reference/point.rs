//! Points of the prismatic shell in f64.

use crate::math::DVec3;

/// A point in a prism.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DShellPoint {
    /// Triangle of the skin.
    pub triangle: u32,
    /// Barycentric coordinates.
    pub b: DVec3,
    /// Height, 0 on the skin.
    pub t: f64,
}

/// A point and the shell around it.
#[derive(Clone, Copy, Debug)]
pub struct DShellSpot {
    /// The point.
    pub point: DShellPoint,
    /// From skin to t = 1 there, m.
    pub height_m: f64,
    /// Cosine between that way and the ray.
    pub cosine: f64,
    /// |∂x/∂(b₁, b₂, t)|, m³.
    pub volume_m3: f64,
}

/// Places at one distance: one, or more where the prism folds over itself.
pub type Spots = [Option<DShellSpot>; 3];
