//! How a tile is seen at one point of the skin.

use super::guards::{LEAST_BULK, LEAST_COSINE, LEAST_VOLUME};
use crate::math::{Mat2, Mat3, Vec2, Vec3};

/// How a tile is seen at one point of the skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Incidence {
    /// Of the ray in the skin's frame, unit.
    pub(super) direction: Vec3,
    /// M: columns X, Y, O.
    pub(super) skin_from_tile: Mat3,
    texture_from_tile: Mat2,
    /// Edge of the pixel on the skin, in tile edges.
    pub(super) pixel: f32,
    volume: f32,
    in_tile: Vec3,
    fall: f32,
}

impl Incidence {
    /// Along the unit vector `direction` in the skin's frame (x and y along the tile's axes, z the normal), which points in:
    /// z < 0. `skin_from_tile` is M, columns X, Y, O; `pixel` the edge of the pixel on the skin, in tile edges. The texture lies
    /// as the hair does.
    pub fn new(direction: Vec3, skin_from_tile: Mat3, pixel: f32) -> Self {
        let Mat3 { x_axis, y_axis, z_axis } = skin_from_tile;
        let rows = [y_axis.cross(z_axis), z_axis.cross(x_axis), x_axis.cross(y_axis)];
        let determinant = skin_from_tile.determinant();
        let volume = determinant.abs().max(LEAST_VOLUME * rows[2].length() * z_axis.length()).max(LEAST_BULK);
        let scale = if determinant >= 0.0 { 1.0 } else { -1.0 } / volume;
        let [x, y, z] = rows.map(|row| row * scale);
        let d = Mat3::from_cols(x, y, z).transpose() * direction;
        let fall = d.z.abs();
        let steep = fall.max(LEAST_COSINE * d.length());
        let in_tile = Vec3::new(d.x, d.y, if d.z > 0.0 { steep } else { -steep });
        Self { direction, skin_from_tile, texture_from_tile: Mat2::IDENTITY, pixel, volume, in_tile, fall }
    }

    /// On a texture that is stretched or turned: what a step along X and Y is in it.
    #[must_use]
    pub fn on_texture(self, texture_from_tile: Mat2) -> Self {
        Self { texture_from_tile, ..self }
    }

    /// What 1 m³ of the tile becomes, |det M|, guarded.
    pub fn volume(&self) -> f32 {
        self.volume
    }

    /// The ray's direction in tile space, at least as steep as the law allows; not unit: its z counts path per height.
    pub fn in_tile(&self) -> Vec3 {
        self.in_tile
    }

    /// The share of a slab's height that the ray meets, and so of the ends of hair in it.
    pub fn share_of_ends(&self) -> f32 {
        self.fall / self.in_tile.z.abs()
    }

    /// The ray's slope in the texture: sideways run per height.
    pub fn slope(&self) -> Vec2 {
        let d = self.in_tile;
        self.texture_from_tile * Vec2::new(d.x, d.y) / d.z
    }

    /// Angle between ray and tile normal, degrees.
    pub fn theta_deg(&self) -> f32 {
        let d = self.in_tile;
        libm::acosf((d.z.abs() / d.length()).min(1.0)).to_degrees()
    }
}
