//! A tile from hair to textures.

use super::fins::{FinParameters, texture};
use super::hair::{TileHair, leaning};
use super::shells::above::Above;
use super::shells::deposit::{VoxelLayout, Voxels, mean_slopes};
use super::shells::encode::{Raw, encode};
use super::shells::{ShellParameters, ends, gains, undercoat};
use crate::data::coat::{Sampled, Tile, TileLooks};
use crate::math::Vec3;
use serde::Serialize;

/// What is baked from a tile's hair.
#[derive(Clone, Debug, Serialize)]
pub struct TileRecipe {
    /// Name of the preset.
    pub preset: String,
    /// Shells.
    pub shells: ShellParameters,
    /// Fins.
    pub fins: FinParameters,
    /// Skin colour factor, linear RGB.
    pub skin: Vec3,
    /// Mean lean of the hair on the skin, degrees: the gains are fitted there.
    pub lean_deg: f32,
    /// How its hair is lit; `undercoat_share` is filled in by the bake.
    pub looks: Option<TileLooks>,
}

impl TileRecipe {
    /// How the hair is lit, by the share of undercoat in each slab.
    pub(super) fn looks(&self, slab_shares: &[f32]) -> Option<TileLooks> {
        let undercoat_share = std::iter::once(0.0).chain(slab_shares.iter().copied()).collect();
        self.looks.clone().map(|looks| TileLooks { undercoat_share, ..looks })
    }
}

/// Shares of undercoat per slab, where `guard` is the hair area of guard hair alone.
pub(super) fn undercoat_shares(guard: &[f32], all: &[f32]) -> Vec<f32> {
    guard
        .iter()
        .zip(all)
        .map(|(guard, all)| if *all > 0.0 { (1.0 - guard / all).clamp(0.0, 1.0) } else { 0.0 })
        .collect()
}

/// What casting rays tells of a tile: most of the work. Colours do not matter to it, so all hair that grows alike has the same.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RaysTold {
    /// κ of guard hair per voxel ([`ends::guard_ends`]).
    pub ends: Option<Vec<f32>>,
    /// Gains per mip and layer ([`gains::fit`]).
    pub gains: Option<Vec<Vec<[f32; 9]>>>,
}

/// Bakes the textures of a tile.
pub fn bake(hair: &TileHair, recipe: &TileRecipe) -> Tile {
    bake_with(hair, recipe, &mut RaysTold::default())
}

/// The same with what rays `told` of hair that grows as this does; what they have not told yet they then have.
pub fn bake_with(hair: &TileHair, recipe: &TileRecipe, told: &mut RaysTold) -> Tile {
    let size = recipe.shells.texture_size as usize;
    let slabs = recipe.shells.layers as usize - 1;
    let lean = leaning(recipe.lean_deg);
    // The textures, the fin and the truth that gains are fitted to need nothing of each other.
    let shells = || {
        let slopes = mean_slopes(&hair.guard, slabs, hair.height_m);
        let layout = VoxelLayout::tile(size, slabs, hair.edge_m, hair.height_m);
        let mut voxels = Voxels::deposited(layout, &hair.guard, &slopes);
        let guard_ends = told.ends.clone().unwrap_or_else(|| ends::guard_ends(&hair.guard, &voxels, &slopes));
        let mut kappa = guard_ends.clone();
        let guard = slab_means(&voxels.extinction, slabs);
        if let Some(medium) = &hair.undercoat {
            undercoat::add(medium, &slopes, &mut voxels, &mut kappa);
        }
        let above = Above::new(&layout, &voxels.extinction, 0, &[]);
        let shells = encode(&Raw {
            voxels: &voxels,
            ends: &kappa,
            above: &above,
            skin: recipe.skin,
            slopes: &slopes,
            skin_share: &[],
        });
        let shares = undercoat_shares(&guard, &slab_means(&voxels.extinction, slabs));
        (shells, slab_means(&above.voxels, slabs), shares, guard_ends)
    };
    let truth = || {
        let mapped = told.gains.is_none().then(|| hair.mapped(lean))?;
        Some(gains::seen_through(mapped.scene(), mapped.edge_m, mapped.height_m, slabs, lean))
    };
    let fin = || texture::composite(hair, &recipe.fins);
    let ((shells, slab_above, shares, guard_ends), (truth, fin)) = rayon::join(shells, || rayon::join(truth, fin));
    let mut tile = Tile {
        preset: recipe.preset.clone(),
        sampled: Sampled::Square,
        edge_m: hair.edge_m,
        height_m: hair.height_m,
        shells,
        fin: texture::encode(&fin, hair, &recipe.fins, &slab_above),
        looks: recipe.looks(&shares),
    };
    if let Some(truth) = truth {
        told.gains = Some(gains::fit(&tile, &truth, lean));
    }
    if let Some(gains) = &told.gains {
        tile.shells.gains.clone_from(gains);
    }
    told.ends = Some(guard_ends);
    tile
}

/// Mean of the values of each slab.
pub(super) fn slab_means(values: &[f32], slabs: usize) -> Vec<f32> {
    let per_slab = values.len() / slabs;
    values.chunks(per_slab).map(|slab| slab.iter().sum::<f32>() / per_slab as f32).collect()
}
