//! The coat on a graphics device (`docs/steps/runtime.md`; shaders in `shaders/runtime/`).
//!
//! Order: the key light's shadow map; the skin's depth; the near side of the shells, outer to inner; fins; the far side, inner to outer; the
//! skin. Along any ray through a convex body that is front to back, each under what was drawn before. It is done in pieces: what is opaque
//! after one of them hides whatever is drawn from then on, before it is shaded.
//!
//! Made once and kept: passes and tiles in a [`Renderer`], the geometry of a pose in a [`Prepared`]. A view costs its
//! uniforms, the passes and the way back.

mod bindings;
mod blending;
mod constants;
pub mod layout;
mod measured;
mod measuring;
pub mod pipelines;
mod prepared;
mod resources;
mod shadow_map;
mod targets;
mod tile;
mod unsorted;

pub use prepared::Prepared;

use crate::data::coat::Tile;
use crate::error::{Error, Result};
use crate::gpu::Gpu;
use crate::runtime::draw_list::{DrawList, Picture};
use pipelines::Pipelines;
use shadow_map::ShadowMap;
use std::sync::Arc;
use tile::GpuTile;

/// Time and memory of one pass.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PassCost {
    /// `shadow map`, `coat`, `skin`.
    pub name: &'static str,
    /// Device time, ms; `None` where the adapter has no clock.
    pub ms: Option<f64>,
    /// What the pass reads: geometry and textures.
    pub bytes: u64,
    /// Draw calls.
    pub draw_calls: u64,
    /// Triangles sent.
    pub triangles: u64,
}

/// A picture and what it cost.
#[derive(Clone, Debug)]
pub struct Drawn {
    /// The picture.
    pub picture: Picture,
    /// One row per pass.
    pub passes: Vec<PassCost>,
    /// Memory of the targets drawn into.
    pub target_bytes: u64,
    /// Level of detail that is drawn, the mean of all coats; 0 is the finest.
    pub level: f32,
    /// Height of the longest hair, pixels.
    pub height_px: f32,
    /// What came of the key light's shadow.
    pub shadow: KeyShadow,
}

/// Whether the key light cast a shadow by a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeyShadow {
    /// It was not asked to, or there is no light.
    Off,
    /// It did.
    Cast {
        /// Whether what is no part of the asset can cast its shadow on it.
        guests_reach: bool,
    },
    /// The light stands within the asset or close beside it, so that no map holds what it sees.
    TooNear,
}

/// What all coats are drawn with: compiled once for a device.
#[derive(Clone)]
pub struct Passes {
    pipelines: Arc<Pipelines>,
    shadow_map: Arc<ShadowMap>,
    samples: u32,
}

impl Passes {
    /// Compiles them. `samples` are those along a pixel's edge, 1 to 8.
    ///
    /// # Errors
    /// [`crate::error::Kind::Usage`] for a bad number of samples; [`crate::error::Kind::Device`] from the device.
    pub fn new(gpu: &Gpu, samples: u32) -> Result<Self> {
        if !(1..=8).contains(&samples) {
            return Err(Error::usage("the number of samples is out of range")
                .with_field("samples along a pixel's edge")
                .with_found(samples)
                .with_expected("1 to 8"));
        }
        let (pipelines, shadow_map) = (Pipelines::new(gpu, samples)?, ShadowMap::new(gpu)?);
        Ok(Self { pipelines: Arc::new(pipelines), shadow_map: Arc::new(shadow_map), samples })
    }
}

/// A device with what all coats of the same tiles are drawn with, whatever their pose.
pub struct Renderer<'a> {
    gpu: &'a Gpu,
    pipelines: Arc<Pipelines>,
    shadow_map: Arc<ShadowMap>,
    samples: u32,
    /// Per tile, its levels.
    tiles: Vec<Vec<GpuTile>>,
    /// Stands in for a tile where skin has none.
    bare: GpuTile,
}

impl<'a> Renderer<'a> {
    /// Compiles the passes and uploads `tiles`. `samples` are those along a pixel's edge, 1 to 8.
    ///
    /// # Errors
    /// As [`Passes::new`] and [`Self::with`].
    pub fn new(gpu: &'a Gpu, tiles: &[Tile], samples: u32) -> Result<Self> {
        Self::with(gpu, &Passes::new(gpu, samples)?, tiles)
    }

    /// Uploads `tiles`, to be drawn with passes that were compiled for this device.
    ///
    /// # Errors
    /// [`crate::error::Kind::Input`] for a tile whose mips do not fit together; [`crate::error::Kind::Device`] from the device.
    pub fn with(gpu: &'a Gpu, passes: &Passes, tiles: &[Tile]) -> Result<Self> {
        let Passes { pipelines, shadow_map, samples } = passes.clone();
        let bare = GpuTile::new(gpu, &pipelines.layouts, &tile::bare_tile(), f32::INFINITY)?;
        let tiles = tiles.iter().map(|tile| GpuTile::levels(gpu, &pipelines.layouts, tile)).collect::<Result<_>>()?;
        Ok(Self { gpu, pipelines, shadow_map, samples, tiles, bare })
    }

    /// Memory of the tiles' textures, bytes.
    pub fn tile_bytes(&self) -> u64 {
        self.tiles.iter().flatten().map(|tile| tile.bytes).sum()
    }

    /// Uploads a pose: everything that is drawn but for camera and light. `scene` carries the tiles that this was made with.
    ///
    /// # Errors
    /// [`crate::error::Kind::Input`] for broken textures; [`crate::error::Kind::Device`] where one is too large.
    pub fn prepare(&self, scene: &DrawList<'_>) -> Result<Prepared<'_>> {
        Prepared::new(self, scene)
    }
}
