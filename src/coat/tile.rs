//! A tile from hair to textures.

use super::fins::{FinParameters, texture};
use super::shells::deposit::{Layout, Voxels, mean_slopes};
use super::shells::encode::{Raw, encode};
use super::shells::{ShellParameters, ends, gains, shadow, undercoat};
use crate::data::coat::{Sampled, Tile};
use crate::data::strands::Strands;
use crate::fur::groom::fibre::Fibre;
use crate::fur::grow;
use crate::fur::undercoat::Pattern;
use crate::math::hash::combine;
use crate::math::{Mat3, Vec3};
use crate::render::Scene;
use crate::render::medium::Medium;

/// The hair of a tile.
#[derive(Clone, Debug)]
pub struct TileHair {
    /// Guard hair.
    pub guard: Strands,
    /// Undercoat.
    pub undercoat: Option<Medium>,
    /// Edge of the tile, m.
    pub edge_m: f32,
    /// Height that no hair exceeds, m.
    pub height_m: f32,
    /// The map it is worn under; identity for the tile itself.
    pub skin_from_tile: Mat3,
}

impl TileHair {
    /// Grows both kinds on a tile with edge `edge_m`.
    pub fn grow(guard: &Fibre, undercoat: &Fibre, edge_m: f32, seed: u64) -> Self {
        let guard = grow::tile::grow(guard, edge_m, combine(seed, 1));
        let undercoat = Medium::new(undercoat, Some(Pattern::default()), edge_m);
        let highest_m = guard.points_m.iter().map(|p| p.z).fold(0.0, f32::max);
        let top_m = undercoat.as_ref().map_or(0.0, |medium| medium.undercoat().height_m);
        // A little above the highest tip, so that no tip ends exactly on the top.
        let height_m = highest_m.max(top_m).max(1e-6) * 1.001;
        Self { guard, undercoat, edge_m, height_m, skin_from_tile: Mat3::IDENTITY }
    }

    /// The same hair as a skin wears it: every point mapped by `skin_from_tile`, which must keep x and y.
    pub fn worn(&self, skin_from_tile: Mat3) -> Self {
        let mut guard = self.guard.clone();
        guard.points_m.iter_mut().for_each(|p| *p = skin_from_tile * *p);
        Self {
            guard,
            undercoat: self.undercoat.as_ref().map(|medium| medium.worn(skin_from_tile)),
            edge_m: self.edge_m,
            height_m: self.height_m * skin_from_tile.z_axis.z,
            skin_from_tile,
        }
    }

    /// As a scene that repeats.
    pub fn scene(&self) -> Scene<'_> {
        Scene {
            guard: Some(&self.guard),
            medium: self.undercoat.as_ref(),
            torus_m: Some(self.edge_m),
            upright_from_world: self.skin_from_tile.inverse(),
            ..Scene::default()
        }
    }
}

/// The map from a tile to the skin's frame for hair that leans `degrees` along the comb, its length kept.
pub fn leaning(degrees: f32) -> Mat3 {
    let (sin, cos) = libm::sincosf(degrees.to_radians());
    Mat3::from_cols(Vec3::X, Vec3::Y, Vec3::new(sin, 0.0, cos))
}

/// What is baked from a tile's hair.
#[derive(Clone, Debug)]
pub struct TileRecipe {
    /// Name of the preset.
    pub preset: String,
    /// Shells.
    pub shells: ShellParameters,
    /// Fins.
    pub fins: FinParameters,
    /// Skin colour factor, linear RGB.
    pub skin: Vec3,
    /// Mean lean of the hair as worn, degrees: the gains are fitted there.
    pub lean_deg: f32,
}

/// Bakes the textures of a tile.
pub fn bake(hair: &TileHair, recipe: &TileRecipe) -> Tile {
    let size = recipe.shells.texture_size as usize;
    let slabs = recipe.shells.layers as usize - 1;
    let lean = leaning(recipe.lean_deg);
    // The textures, the fin and the truth that gains are fitted to need nothing of each other.
    let shells = || {
        let slopes = mean_slopes(&hair.guard, slabs, hair.height_m);
        let layout = Layout::tile(size, slabs, hair.edge_m, hair.height_m);
        let mut voxels = Voxels::deposited(layout, &hair.guard, &slopes);
        let mut kappa = ends::guard_ends(&hair.guard, &voxels, &slopes);
        if let Some(medium) = &hair.undercoat {
            undercoat::add(medium, &slopes, &mut voxels, &mut kappa);
        }
        let (transmittance, skin_transmittance) = shadow::transmittance(&voxels, &kappa);
        let shells = encode(&Raw {
            voxels: &voxels,
            ends: &kappa,
            transmittance: &transmittance,
            skin_transmittance: &skin_transmittance,
            skin: recipe.skin,
            slopes: &slopes,
            skin_share: &[],
        });
        (shells, slab_means(&transmittance, slabs))
    };
    let truth = || {
        let worn = hair.worn(lean);
        gains::strand_transmittance(worn.scene(), worn.edge_m, worn.height_m, lean)
    };
    let fin = || texture::composite(hair, &recipe.fins);
    let ((shells, slab_transmittance), (truth, fin)) = rayon::join(shells, || rayon::join(truth, fin));
    let mut tile = Tile {
        preset: recipe.preset.clone(),
        sampled: Sampled::Square,
        edge_m: hair.edge_m,
        height_m: hair.height_m,
        shells,
        fin: texture::encode(&fin, hair, &recipe.fins, &slab_transmittance),
    };
    tile.shells.gains = gains::fit(&tile, &truth, lean);
    tile
}

/// Mean of the values of each slab.
pub(super) fn slab_means(values: &[f32], slabs: usize) -> Vec<f32> {
    let per_slab = values.len() / slabs;
    values.chunks(per_slab).map(|slab| slab.iter().sum::<f32>() / per_slab as f32).collect()
}
