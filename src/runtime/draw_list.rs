//! What to draw and from where: posed, in metres, world axes, relative to one origin.

use crate::data::coat::{FinEdge, Tile};
use crate::data::film::Film;
use crate::data::image::Image8;
use crate::data::light::Light;
use crate::data::texture::Wrap;
use crate::math::{Mat4, Vec2, Vec3, Vec4};
use std::borrow::Cow;

/// Lights that one picture can have.
pub const MAX_LIGHTS: usize = 16;

/// A posed asset with its coat.
#[derive(Clone, Debug, Default)]
pub struct DrawList<'a> {
    /// Opaque surfaces, furred or not.
    pub skins: Vec<SkinMesh<'a>>,
    /// What the furred ones carry.
    pub furs: Vec<CoatMesh<'a>>,
    /// Hair textures.
    pub tiles: &'a [Tile],
}

/// An opaque surface. Vertex arrays have one entry per vertex; `coat_uv` and `coat_density` only where it is furred.
#[derive(Clone, Debug, Default)]
pub struct SkinMesh<'a> {
    /// Vertex positions, m.
    pub positions_m: Vec<Vec3>,
    /// Unit vertex normals.
    pub normals: Vec<Vec3>,
    /// Base colour factor times vertex colour, linear RGB.
    pub colour: Vec<Vec3>,
    /// Texture coordinates of `texture`.
    pub uv: Vec<Vec2>,
    /// Base colour texture, sRGB coded RGBA, and what it shows beyond its borders.
    pub texture: Option<(&'a Image8, [Wrap; 2])>,
    /// What is painted: density in red, length in green, and what it shows beyond its borders.
    pub painted: Option<(&'a Image8, [Wrap; 2])>,
    /// Texture coordinates of `painted`.
    pub painted_uv: Vec<Vec2>,
    /// Tile whose innermost transmittance shades this skin.
    pub tile: Option<usize>,
    /// Texture coordinates in that tile.
    pub coat_uv: Vec<Vec2>,
    /// Density factor of the coat.
    pub coat_density: Vec<f32>,
    /// How high hair stands over it, m; empty where there is none.
    pub hair_m: Vec<f32>,
    /// Whether it is no part of the asset, so that the shadow map need not hold it.
    pub guest: bool,
    /// Vertex indices.
    pub triangles: Vec<[u32; 3]>,
}

/// Shells and fins. Vertex arrays have one entry per coat vertex.
#[derive(Clone, Debug, Default)]
pub struct CoatMesh<'a> {
    /// Index into [`DrawList::tiles`].
    pub tile: usize,
    /// Positions on the skin, m.
    pub positions_m: Vec<Vec3>,
    /// Unit skin normals.
    pub normals: Vec<Vec3>,
    /// Root to the top of the stack, m.
    pub offsets_m: Vec<Vec3>,
    /// The tile's x axis along the skin, of any length; none where it is the texture's own.
    pub axes: Vec<Vec3>,
    /// Texture coordinates in tiles.
    pub uv: Cow<'a, [Vec2]>,
    /// Colour factor (linear RGB) and density factor.
    pub tint: Cow<'a, [Vec4]>,
    /// Colour at the root, sRGB coded RGBA, and what it shows beyond its borders.
    pub colour: Option<(&'a Image8, [Wrap; 2])>,
    /// What is painted at the root: density in red, length in green.
    pub painted: Option<(&'a Image8, [Wrap; 2])>,
    /// Texture coordinates of `colour` (xy) and `painted` (zw); empty where there is neither.
    pub root: Cow<'a, [Vec4]>,
    /// Longest length painted around each vertex; empty where none is.
    pub longest: Cow<'a, [f32]>,
    /// Coat vertex indices; the outside is where the offsets point.
    pub triangles: &'a [[u32; 3]],
    /// Edges that may carry a fin.
    pub fins: Cow<'a, [FinEdge]>,
    /// Whether it lies where the one before it does, in a passage between two tiles. They take turns in which of their shells
    /// is drawn over the other's, so that neither colour prevails.
    pub over_last: bool,
}

/// Which of the three kinds of geometry to draw.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Show {
    /// Opaque skin. Where it is left out it still hides what lies behind it.
    pub skin: bool,
    /// Shells.
    pub shells: bool,
    /// Fins.
    pub fins: bool,
}

impl Default for Show {
    fn default() -> Self {
        Self { skin: true, shells: true, fins: true }
    }
}

/// How what is half transparent comes together in a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Blending {
    /// From front to back.
    #[default]
    Sorted,
    /// In any order, by weights (McGuire and Bavoil 2013).
    Weighted,
    /// There or not, by chance, for engines that average pictures over time (Wyman and McGuire 2017).
    Hashed,
}

impl Blending {
    /// All of them, by name.
    pub const ALL: [(&'static str, Self); 3] =
        [("sorted", Self::Sorted), ("weighted", Self::Weighted), ("hashed", Self::Hashed)];
}

/// Camera and light.
#[derive(Clone, Debug)]
pub struct Frame {
    /// World to clip space: x right, y up, depth 0 (near) to 1 (far).
    pub clip_from_world: Mat4,
    /// Perspective: the eye, m, and 1. Orthographic: the unit vector towards the viewer, and 0.
    pub eye: Vec4,
    /// Pixels: width, height.
    pub size: [u32; 2],
    /// At most [`MAX_LIGHTS`]; positions relative to the same origin as all others.
    pub lights: Vec<Light>,
    /// Radiance that comes from everywhere, linear RGB.
    pub ambient: Vec3,
    /// Whether the key light, the first, casts the shadow of one limb on another.
    pub shadow_map: bool,
    /// Level of detail of all coats, 0 being the finest, or the coarsest there is; none to choose by size.
    pub level: Option<usize>,
    /// Whether the picture's depths are those of the nearest hair too, which takes a further pass; else of the skin alone.
    pub depths: bool,
}

impl Frame {
    /// Distances along each pixel's ray, m, from depths in [0, 1] at the pixels' middles, rows from the top: 0 where nothing is
    /// before the far plane. In an orthographic picture they begin at the near plane.
    ///
    /// Of a point (p, 1), the matrix gives z = row₂ and w = row₃; both vary along the line of sight alone, z = a w + b, so a depth
    /// d = z/w lies at w = b/(d − a).
    pub fn distances_m(&self, depths: &[f32]) -> Vec<f32> {
        let rows = [0, 1, 2, 3].map(|i| self.clip_from_world.row(i));
        let [across, upward, inward, forward] = rows.map(|row| row.truncate());
        let along = forward.length_squared();
        let [width, height] = self.size.map(|n| n as f32);
        let distance = |(i, &depth): (usize, &f32)| {
            if depth >= 1.0 {
                return 0.0;
            }
            if along == 0.0 {
                return depth / inward.length();
            }
            let slope = inward.dot(forward) / along;
            let offset = rows[2].w - slope * rows[3].w;
            let (x, y) = ((i as u32 % self.size[0]) as f32 + 0.5, (i as u32 / self.size[0]) as f32 + 0.5);
            let sideways =
                Vec2::new(2.0 * x / width - 1.0, 1.0 - 2.0 * y / height) / Vec2::new(across.length(), upward.length());
            offset / (depth - slope) * (1.0 + sideways.length_squared()).sqrt()
        };
        depths.iter().enumerate().map(distance).collect()
    }
}

/// A drawn picture: linear light, premultiplied by alpha.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels: width, height.
    pub size: [u32; 2],
    /// Radiance and coverage, rows from the top.
    pub pixels: Vec<[f32; 4]>,
    /// Distance along the ray to the nearest skin or, where [`Frame::depths`] asked for it, hair of a shell, m; 0 where there is none.
    pub depth_m: Vec<f32>,
}

impl Picture {
    /// As a film of light and depth.
    pub fn film(&self) -> Film {
        Film {
            width: self.size[0] as usize,
            height: self.size[1] as usize,
            radiance: self.pixels.iter().map(|&[r, g, b, _]| Vec3::new(r, g, b)).collect(),
            alpha: self.pixels.iter().map(|pixel| pixel[3]).collect(),
            depth_m: self.depth_m.clone(),
            ..Film::default()
        }
    }

    /// Mean alpha.
    pub fn coverage(&self) -> f64 {
        self.pixels.iter().map(|pixel| f64::from(pixel[3])).sum::<f64>() / self.pixels.len().max(1) as f64
    }
}
