//! How an image is laid on a surface, and what it shows there.

use super::image::{Image8, linear_from_srgb8};
use crate::math::{Vec2, Vec4};
use serde::Serialize;

/// A texture of a glTF file, as a material or a coat names it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Texture {
    /// glTF texture.
    pub index: usize,
    /// Its glTF image.
    pub image: usize,
    /// Which of the mesh's `uv_sets`.
    pub uv_set: usize,
    /// KHR_texture_transform: offset, rotation (rad) and scale.
    pub offset: Vec2,
    /// Counter-clockwise rotation, rad.
    pub rotation_rad: f32,
    /// Scale.
    pub scale: Vec2,
    /// What lies outside [0, 1] along u and v.
    pub wrap: [Wrap; 2],
}

/// What a texture shows outside [0, 1].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Wrap {
    /// The same again.
    Repeat,
    /// The same, mirrored at each whole number.
    Mirror,
    /// The border texel.
    Clamp,
}

impl Texture {
    /// A texture that repeats over the mesh's `uv_set` as it is.
    pub fn plain(index: usize, image: usize, uv_set: usize) -> Self {
        let wrap = [Wrap::Repeat; 2];
        Self { index, image, uv_set, offset: Vec2::ZERO, rotation_rad: 0.0, scale: Vec2::ONE, wrap }
    }

    /// Where the texture is read for the mesh's texture coordinate `uv` (KHR_texture_transform: T·R·S).
    pub fn transformed(&self, uv: Vec2) -> Vec2 {
        let (sin, cos) = (libm::sinf(self.rotation_rad), libm::cosf(self.rotation_rad));
        let scaled = uv * self.scale;
        Vec2::new(cos * scaled.x + sin * scaled.y, cos * scaled.y - sin * scaled.x) + self.offset
    }

    /// The texture at the mesh's texture coordinate `uv`, bilinear, linear RGBA; `image` is its decoded image in sRGB coding.
    pub fn sample(&self, image: &Image8, uv: Vec2) -> Vec4 {
        bilinear(image, self.transformed(uv), self.wrap, |p| {
            let c = |i: usize| linear_from_srgb8(p[i]);
            Vec4::new(c(0), c(1), c(2), f32::from(p[3]) / 255.0)
        })
    }
}

/// `image` between the middles of four texels around `at`, each decoded by `texel`.
pub(super) fn bilinear(image: &Image8, at: Vec2, wrap: [Wrap; 2], texel: impl Fn(&[u8]) -> Vec4) -> Vec4 {
    let axis = |coordinate: f32, size: u32, wrap: Wrap| {
        let texel = f64::from(coordinate) * f64::from(size) - 0.5;
        let low = texel.floor();
        let index = |i: f64| match wrap {
            Wrap::Repeat => i.rem_euclid(f64::from(size)),
            Wrap::Mirror => {
                let folded = i.rem_euclid(2.0 * f64::from(size));
                folded.min(2.0 * f64::from(size) - 1.0 - folded)
            }
            Wrap::Clamp => i.clamp(0.0, f64::from(size) - 1.0),
        };
        (index(low) as u32, index(low + 1.0) as u32, (texel - low) as f32)
    };
    let (x0, x1, fx) = axis(at.x, image.width, wrap[0]);
    let (y0, y1, fy) = axis(at.y, image.height, wrap[1]);
    let at = |x: u32, y: u32| texel(image.pixel(x.min(image.width - 1), y.min(image.height - 1)));
    at(x0, y0).lerp(at(x1, y0), fx).lerp(at(x0, y1).lerp(at(x1, y1), fx), fy)
}
