//! The hair of a tile.

use crate::cast::Geometry;
use crate::data::strands::Strands;
use crate::fur::groom::fibre::Fibre;
use crate::fur::grow;
use crate::fur::undercoat::Pattern;
use crate::math::hash::combine;
use crate::math::{Mat3, Vec3};
use crate::volume::medium::Medium;

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
    /// The map it is mapped by; identity for the tile itself.
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

    /// The same hair as a skin carries it: every point mapped by `skin_from_tile`, which must keep x and y.
    pub fn mapped(&self, skin_from_tile: Mat3) -> Self {
        let mut guard = self.guard.clone();
        guard.points_m.iter_mut().for_each(|p| *p = skin_from_tile * *p);
        Self {
            guard,
            undercoat: self.undercoat.as_ref().map(|medium| medium.mapped(skin_from_tile)),
            edge_m: self.edge_m,
            height_m: self.height_m * skin_from_tile.z_axis.z,
            skin_from_tile,
        }
    }

    /// As what rays meet, repeating.
    pub fn scene(&self) -> Geometry<'_> {
        Geometry {
            guard: Some(&self.guard),
            medium: self.undercoat.as_ref(),
            torus_m: Some(self.edge_m),
            upright_from_world: self.skin_from_tile.inverse(),
            ..Geometry::default()
        }
    }
}

/// The map from a tile to the skin's frame for hair that leans `degrees` along the comb, its length kept.
pub fn leaning(degrees: f32) -> Mat3 {
    let (sin, cos) = libm::sincosf(degrees.to_radians());
    Mat3::from_cols(Vec3::X, Vec3::Y, Vec3::new(sin, 0.0, cos))
}
