//! The three ways to look at hair: through a camera, at a tile, from given texels.

use crate::data::ray::Ray;
use crate::math::{Vec2, Vec3};
use crate::stage::projection::Projection;

/// The rays of a film, `supersampling²` per pixel, stratified.
#[derive(Clone, Copy, Debug)]
pub enum Rays<'a> {
    /// Through a camera.
    Perspective {
        /// The camera, and how large its picture is.
        view: Projection,
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
            Self::Perspective { view, .. } => view.size,
            Self::Tile { size, .. } | Self::Texels { size, .. } => *size,
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
            Self::Perspective { view, supersampling } => {
                let (px, py) = within(supersampling);
                Ray { origin_m: view.eye_m, direction: view.direction(Vec2::new(px, py)).normalize() }
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
