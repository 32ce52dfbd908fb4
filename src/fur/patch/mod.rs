//! Texture coordinates for fur on any surface (Lengyel et al. 2001 §2.1; `docs/steps/patch.md`).
//!
//! The skin falls into patches that lie flat with little stretch, turned so that the comb runs along +u and scaled so
//! that one unit is one tile. Tiles are toroidal: patches need no room of their own, only an atlas gives them one.

mod align;
mod atlas;
mod face;
mod lapped;
mod measure;
mod pack;
mod seams;
mod uv;
mod xatlas;

use crate::data::mesh::Mesh;
use crate::data::patches::Patches;
use crate::error::{Error, Result};
use crate::math::Vec3;
use serde::Serialize;

pub use atlas::{fit as fit_atlas, xatlas_alone};
pub use measure::{of as measure, seam_edges, singular_values};
pub use seams::{PIXEL, SeamPoint, WINDOWS, compare_seams};
pub use uv::need as need_uv_set;

/// Where the texture coordinates come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Parameterisation {
    /// Irregular patches grown over the skin along the comb.
    Lapped {
        /// Chooses seeds, outlines and offsets.
        seed: u64,
    },
    /// The asset's own set; its islands are turned and scaled, mirrored ones turned over.
    Uv {
        /// Index into [`Mesh::uv_sets`].
        set: usize,
    },
    /// Charts by xatlas, each with texels of its own.
    Atlas {
        /// Texels along a tile's edge, 1 and more: charts start on whole texels.
        texels_per_tile: u32,
        /// Texels kept free around each chart: 2^m for m mip levels that must not bleed.
        padding_texels: u32,
    },
}

/// Texture coordinates of `mesh` for tiles of `tile_edge_m`, aligned to the comb `direction` (one per vertex, tangent
/// unit vectors, zero where the hair has none).
///
/// Every triangle is in the result exactly once, in the mesh's order; the result depends on nothing but the arguments.
///
/// # Errors
/// Names the argument that does not fit: an edge that is not positive and finite, directions that are not one per
/// vertex, a UV set that the mesh lacks or whose coordinates cannot carry a texture (less than 90 % of the area is mapped soundly).
pub fn parameterise(mesh: &Mesh, direction: &[Vec3], tile_edge_m: f32, method: Parameterisation) -> Result<Patches> {
    if !(tile_edge_m.is_finite() && tile_edge_m > 0.0) {
        return Err(Error::usage("the tile has no size")
            .with_field("tile.edge")
            .with_found(tile_edge_m)
            .with_expected("a positive number of metres"));
    }
    if direction.len() != mesh.positions_m.len() {
        return Err(Error::input("the direction field does not fit the mesh")
            .with_field("direction")
            .with_found(format!("{} entries", direction.len()))
            .with_expected(format!("{}, one per vertex", mesh.positions_m.len())));
    }
    match method {
        Parameterisation::Lapped { seed } => Ok(lapped::parameterise(mesh, direction, tile_edge_m, seed)),
        Parameterisation::Uv { set } => uv::parameterise(mesh, direction, tile_edge_m, set),
        Parameterisation::Atlas { texels_per_tile, padding_texels } => {
            atlas::parameterise(mesh, direction, tile_edge_m, texels_per_tile.max(1), padding_texels)
        }
    }
}
