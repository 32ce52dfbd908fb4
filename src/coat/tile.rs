//! A tile from hair to textures.

use super::fins::{FinParameters, texture};
use super::hair::{TileHair, leaning};
use super::shells::above::Above;
use super::shells::deposit::{VoxelLayout, Voxels, mean_slopes};
use super::shells::encode::{Raw, encode};
use super::shells::heights::ByHeight;
use super::shells::{ShellParameters, ends, gains, undercoat};
use crate::data::coat::{Level, Sampled, ShellStack, Tile, TileLooks};
use crate::data::shell::Slabs;
use crate::math::Vec3;
use rayon::prelude::*;
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
    /// Whether it is to look at until a better one is there: its opacity is measured by few rays, and it has no coarser levels.
    pub draft: bool,
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

/// Height of a level's stack in a picture, over its number of slabs, up to which they suffice, pixels.
const PX_PER_SLAB: f32 = 3.0;
/// Texels of a level for each pixel's edge of the largest picture that it suffices for.
const TEXELS_PER_PX: f32 = 3.0;

/// Slabs of a level up to which the skin below looks like its coat.
const LIKE_SKIN: usize = 2;

/// What casting rays tells of a tile: most of the work. Colours do not matter to it, so all hair that grows alike has the same.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RaysTold {
    /// κ of guard hair per voxel of each level ([`ends::guard_ends`]).
    pub ends: Option<Vec<Vec<f32>>>,
    /// Gains of each level per mip and layer ([`gains::fit`]).
    pub gains: Option<Vec<Vec<Vec<[f32; 9]>>>>,
}

/// Bakes the textures of a tile and of its levels, each with half as many slabs as the one before, down to one.
pub fn bake(hair: &TileHair, recipe: &TileRecipe) -> Tile {
    bake_with(hair, recipe, &mut RaysTold::default())
}

/// The same with what rays `told` of hair that grows as this does; what they have not told yet they then have.
pub fn bake_with(hair: &TileHair, recipe: &TileRecipe, told: &mut RaysTold) -> Tile {
    let lean = leaning(recipe.lean_deg);
    let counts = std::iter::successors(Some(recipe.shells.layers as usize - 1), |&n| (n > 1).then_some(n / 2));
    // A draft is gone before anybody looks at it from afar.
    let counts = counts.take(if recipe.draft { 1 } else { usize::MAX });
    let by_height = ByHeight::new(hair);
    let cut = |(level, count)| if level == 0 { Slabs::even(count) } else { by_height.cut(count) };
    let cuts: Vec<Slabs> = counts.enumerate().map(cut).collect();
    // The textures, the fin and the truth that gains are fitted to need nothing of each other.
    let ends = told.ends.take().filter(|ends| ends.len() == cuts.len());
    let known = |level: usize| ends.as_ref().map(|ends| ends[level].clone());
    let stacks = || {
        cuts.par_iter()
            .enumerate()
            .map(|(level, cut)| stack(hair, &by_height, recipe, (level, cut), known(level)))
            .collect::<Vec<_>>()
    };
    let truth = || {
        let mapped = told.gains.is_none().then(|| hair.mapped(lean))?;
        Some(gains::Truth::new(mapped.scene(), (mapped.edge_m, mapped.height_m), &cuts, lean, recipe.draft))
    };
    let fin = || texture::composite(hair, &recipe.fins);
    let (mut stacks, (truth, fin)) = rayon::join(stacks, || rayon::join(truth, fin));
    told.ends = Some(stacks.iter_mut().map(|stack| std::mem::take(&mut stack.guard_ends)).collect());
    let own = stacks.remove(0);
    let mut tile = Tile {
        preset: recipe.preset.clone(),
        sampled: Sampled::Square,
        edge_m: hair.edge_m,
        height_m: hair.height_m,
        fin: texture::encode(&fin, hair, &recipe.fins, (&own.shells.slabs, &own.slab_above)),
        shells: own.shells,
        levels: stacks.into_iter().map(Stacked::level).collect(),
        looks: recipe.looks(&own.shares),
    };
    if let Some(truth) = truth {
        let fit = |level| gains::fit(&tile.at_level(level), &truth.of(&cuts[level]), lean);
        told.gains = Some((0..=tile.levels.len()).into_par_iter().map(fit).collect());
    }
    let stacks = std::iter::once(&mut tile.shells).chain(tile.levels.iter_mut().map(|level| &mut level.shells));
    for (shells, gains) in stacks.zip(told.gains.iter().flatten()) {
        shells.gains.clone_from(gains);
    }
    tile
}

/// A stack without gains, with its means per slab.
struct Stacked {
    shells: ShellStack,
    /// Hair area above the middle.
    slab_above: Vec<f32>,
    /// Share of undercoat.
    shares: Vec<f32>,
    /// κ of guard hair per voxel.
    guard_ends: Vec<f32>,
}

impl Stacked {
    fn level(self) -> Level {
        Level {
            most_px: PX_PER_SLAB * self.shares.len() as f32,
            undercoat_share: std::iter::once(0.0).chain(self.shares).collect(),
            shells: self.shells,
        }
    }
}

/// The stack of a tile's hair in these slabs, with as many texels as its level needs; κ of guard hair may be known already.
fn stack(
    hair: &TileHair,
    by_height: &ByHeight,
    recipe: &TileRecipe,
    (level, cut): (usize, &Slabs),
    known: Option<Vec<f32>>,
) -> Stacked {
    let slabs = cut.count();
    let texels = TEXELS_PER_PX * PX_PER_SLAB * slabs as f32 * hair.edge_m / hair.height_m;
    let finest = recipe.shells.texture_size as usize;
    let size = if level == 0 { finest } else { (texels.ceil() as usize).next_power_of_two().clamp(4, finest) };
    let slopes = mean_slopes(&hair.guard, cut, hair.height_m);
    let layout = VoxelLayout::tile(size, cut.clone(), hair.edge_m, hair.height_m);
    let mut voxels = Voxels::deposited(&layout, &hair.guard, &slopes);
    let guard_ends = known.unwrap_or_else(|| ends::guard_ends(&hair.guard, &voxels, &slopes));
    let mut kappa = guard_ends.clone();
    let guard = slab_means(&voxels.extinction, slabs);
    if let Some(medium) = &hair.undercoat {
        undercoat::add(medium, &slopes, &mut voxels, &mut kappa);
    }
    for (colours, seen) in voxels.colour.chunks_mut(layout.texels()).zip(by_height.seen_over_mean(cut)) {
        colours.iter_mut().for_each(|colour| *colour *= seen);
    }
    let mut above = Above::new(&layout, &voxels.extinction, 0, &[]);
    let mut skin = recipe.skin;
    if slabs <= LIKE_SKIN {
        // What is seen of the skin between so few shells is as bright as they are: a thick coat, seen from afar.
        above.skin.fill(0.0);
        let top = (slabs - 1) * layout.texels()..;
        let extinction = voxels.extinction[top.clone()].iter().sum::<f32>().max(f32::MIN_POSITIVE);
        skin = voxels.colour[top].iter().sum::<Vec3>() / extinction;
    }
    let raw = Raw { voxels: &voxels, ends: &kappa, above: &above, skin, slopes: &slopes, skin_share: &[] };
    Stacked {
        shells: encode(&raw),
        slab_above: slab_means(&above.voxels, slabs),
        shares: undercoat_shares(&guard, &slab_means(&voxels.extinction, slabs)),
        guard_ends,
    }
}

/// Mean of the values of each slab.
pub(super) fn slab_means(values: &[f32], slabs: usize) -> Vec<f32> {
    let per_slab = values.len() / slabs;
    values.chunks(per_slab).map(|slab| slab.iter().sum::<f32>() / per_slab as f32).collect()
}
