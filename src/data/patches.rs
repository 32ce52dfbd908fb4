//! Texture coordinates for fur: the skin cut into patches that lie flat, combed along +u.

use crate::math::Vec2;
use serde::{Deserialize, Serialize};

/// A coat's texture coordinates. Vertex arrays have one entry per coat vertex; every skin triangle appears once.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Patches {
    /// Skin mesh vertex that the coat vertex lies on.
    pub base_vertex: Vec<u32>,
    /// Texture coordinate in tiles: u runs along the comb, and u × v points out of the skin.
    pub uv: Vec<Vec2>,
    /// Patch, chart or island.
    pub patch: Vec<u32>,
    /// Coat vertices of each skin triangle, in the skin's order and winding.
    pub triangles: Vec<[u32; 3]>,
    /// Width and height that hold all charts without overlap, in tiles; zero where texels are not unique.
    pub extent: Vec2,
    /// Coordinates before anything was done against seams, every patch where chance put it in its tile; empty where nothing
    /// was done.
    pub chance_uv: Vec<Vec2>,
    /// How good they are.
    pub stats: Stats,
}

/// A square of texels that holds charts, each in a rectangle of its own.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Square {
    /// Texels along its edge.
    pub texels: u32,
    /// Length that the edge stands for, m.
    pub edge_m: f32,
    /// Texels around each chart that are no other's.
    pub padding: u32,
    /// Per set of patches and chart: first column and row, columns and rows of its rectangle, padding included.
    pub charts: Vec<Vec<[u32; 4]>>,
}

impl Patches {
    /// The same patches where chance put them, before anything was done against seams.
    pub fn by_chance(&self) -> Self {
        let uv = if self.chance_uv.is_empty() { &self.uv } else { &self.chance_uv };
        Self { uv: uv.clone(), ..self.clone() }
    }
}

/// Mean and the 5th and 95th percentile, weighted by skin area.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Mean.
    pub mean: f64,
    /// 5th percentile.
    pub p5: f64,
    /// 95th percentile.
    pub p95: f64,
}

/// How much seams show (`docs/steps/patch.md`). Ratios are means over three views, 1 where there is nothing to compare.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Seams {
    /// Borders between patches and cuts within them: edges whose sides have coordinates of their own.
    pub edges: usize,
    /// Mean squared difference across seams over that across fake borders: 1 is as random as the tile, less is better.
    pub difference: f64,
    /// Variance within windows along seams over that inside patches: 1 is as sharp as the rest.
    pub variance: f64,
    /// Both, view by view.
    pub by_view: [[f64; 2]; 3],
}

/// What a parameterisation does to the skin (`docs/steps/patch.md`). Triangles without area have no part in it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Stats {
    /// Patches, charts or islands.
    pub patches: usize,
    /// Triangles with texture coordinates.
    pub faces: usize,
    /// Skin area, m².
    pub area_m2: f64,
    /// Length of the edges inside the skin across which the texture does not go on, m: borders between patches and
    /// cuts within them.
    pub seams_m: f64,
    /// Singular values of the map from skin to texture over the tile scale: 1 is neither stretched nor squeezed.
    pub singular_values: Spread,
    /// Share of the area whose singular values both lie in [0.7, 1.4].
    pub within: f64,
    /// Mean angle between +u and the comb, rad; 0 where there is no comb.
    pub field_angle_rad: f64,
    /// Square root of texture area over skin area, in tiles per metre; times a tile's texels it is the texel density.
    pub tiles_per_m: Spread,
    /// Area that the texture shows mirrored, m².
    pub mirrored_m2: f64,
    /// Area whose texture another place uses too, m²; measured for an asset's own coordinates.
    pub overlapped_m2: f64,
    /// What an artist should know, one sentence each.
    pub warnings: Vec<String>,
}
