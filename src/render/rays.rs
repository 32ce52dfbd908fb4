//! The three ways to look at hair: through a camera, at a tile, from given texels.

use crate::math::Vec3;

/// A half line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts, m.
    pub origin_m: Vec3,
    /// Unit vector.
    pub direction: Vec3,
}

/// A pinhole camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Position, m.
    pub eye_m: Vec3,
    /// A point in the middle of the picture, m.
    pub target_m: Vec3,
    /// Roughly upwards.
    pub up: Vec3,
    /// Vertical field of view, radians.
    pub vfov_rad: f32,
}

/// The rays of a film, `supersampling²` per pixel, stratified.
#[derive(Clone, Copy, Debug)]
pub enum Rays<'a> {
    /// Through a camera.
    Perspective {
        /// The camera.
        camera: Camera,
        /// Pixels per row and rows.
        size: [usize; 2],
        /// Rays per pixel edge.
        supersampling: usize,
    },
    /// Parallel rays that pass evenly through a toroidal tile's square at height `top_m`; pixel (0, 0) at x = y = 0,
    /// rows along +y.
    Tile {
        /// Edge of the tile, m.
        edge_m: f32,
        /// Height at which every ray starts, m.
        top_m: f32,
        /// Direction, pointing down, unit.
        direction: Vec3,
        /// Pixels per row and rows.
        size: [usize; 2],
        /// Rays per pixel edge.
        supersampling: usize,
    },
    /// One given ray per texel.
    Texels {
        /// Row by row.
        rays: &'a [Ray],
        /// Texels per row and rows.
        size: [usize; 2],
    },
}

impl Rays<'_> {
    /// Pixels per row and rows of the film.
    pub fn size(&self) -> [usize; 2] {
        match self {
            Self::Perspective { size, .. } | Self::Tile { size, .. } | Self::Texels { size, .. } => *size,
        }
    }

    /// Rays per pixel.
    pub fn per_pixel(&self) -> usize {
        match self {
            Self::Perspective { supersampling, .. } | Self::Tile { supersampling, .. } => supersampling * supersampling,
            Self::Texels { .. } => 1,
        }
    }

    /// Ray `sample` of pixel (x, y).
    pub fn ray(&self, x: usize, y: usize, sample: usize) -> Ray {
        let within = |supersampling: usize| {
            let (sx, sy) = (sample % supersampling, sample / supersampling);
            let at = |pixel: usize, sub: usize| pixel as f32 + (sub as f32 + 0.5) / supersampling as f32;
            (at(x, sx), at(y, sy))
        };
        match *self {
            Self::Perspective { camera, size, supersampling } => {
                let (px, py) = within(supersampling);
                let forward = (camera.target_m - camera.eye_m).normalize();
                let right = forward.cross(camera.up).normalize();
                let up = right.cross(forward);
                let half = libm::tanf(0.5 * camera.vfov_rad);
                let sx = (2.0 * px / size[0] as f32 - 1.0) * half * size[0] as f32 / size[1] as f32;
                let sy = (1.0 - 2.0 * py / size[1] as f32) * half;
                Ray { origin_m: camera.eye_m, direction: (forward + right * sx + up * sy).normalize() }
            }
            Self::Tile { edge_m, top_m, direction, size, supersampling } => {
                let (px, py) = within(supersampling);
                let origin_m = Vec3::new(px / size[0] as f32 * edge_m, py / size[1] as f32 * edge_m, top_m);
                Ray { origin_m, direction }
            }
            Self::Texels { rays, size } => rays[y * size[0] + x],
        }
    }
}
