//! Groom maps: images over a mesh's first UV set.

use super::image::Image8;
use super::texture::{Wrap, bilinear};
use crate::math::{Vec2, Vec3, Vec4};
use serde::Serialize;

/// Decoded maps; each is RGBA.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Maps {
    /// Red: factor on density.
    pub density: Option<Image8>,
    /// Red: factor on length.
    pub length: Option<Image8>,
    /// Red along +u, green along −v (up in the image), 128 for zero; alpha: factor on length.
    pub comb: Option<Image8>,
    /// Hair colour in sRGB coding.
    pub colour: Option<Image8>,
    /// Red: factor on clump strength.
    pub clump: Option<Image8>,
}

impl Maps {
    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        [&self.density, &self.length, &self.comb, &self.colour, &self.clump].iter().all(|map| map.is_none())
    }
}

/// Bilinear sample at `uv` (v down, repeating), each channel in [0, 1].
pub fn sample(image: &Image8, uv: Vec2) -> Vec4 {
    let plain = |p: &[u8]| Vec4::new(f32::from(p[0]), f32::from(p[1]), f32::from(p[2]), f32::from(p[3])) / 255.0;
    bilinear(image, uv, [Wrap::Repeat; 2], plain)
}

/// What a comb map paints at `uv`, to the right and up in the image; zero where it paints none.
pub fn painted_comb(map: &Image8, uv: Vec2) -> [f32; 2] {
    let painted = sample(map, uv);
    let (right, up) = (painted.x * 255.0 - 128.0, painted.y * 255.0 - 128.0);
    if right.abs().max(up.abs()) < 1.5 { [0.0; 2] } else { [right, up] }
}

/// Which way u and v run over a triangle, longer where it is larger; slivers stay finite.
pub fn uv_axes([a, b, c]: [Vec3; 3], [ua, ub, uc]: [Vec2; 3]) -> [Vec3; 2] {
    let (e1, e2, d1, d2) = (b - a, c - a, ub - ua, uc - ua);
    // Times the determinant's sign instead of divided by it: weights by area.
    let sign = if d1.perp_dot(d2) < 0.0 { -1.0 } else { 1.0 };
    [(e1 * d2.y - e2 * d1.y) * sign, (e2 * d1.x - e1 * d2.x) * sign]
}
