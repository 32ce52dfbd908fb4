//! The prismatic shell: every triangle extruded along its hair (Andersen et al. 2016 §3.2, `docs/steps/march.md`).

pub mod block;
pub mod lattice;
pub mod locate;
pub mod neighbours;
pub mod outer;
pub mod prism;
pub mod prisms;
pub mod sides;
pub mod subelement;

use crate::data::fields::Fields;
use crate::data::mesh::Mesh;
use crate::fur::undercoat::Undercoat;
use crate::math::Vec3;
use neighbours::Neighbours;
use prism::Prism;

/// Least height of the shell over its greatest, so that bare skin still has prisms that can be told apart.
const LEAST_HEIGHT: f32 = 1e-3;

/// The shell over a skin.
#[derive(Clone, Debug)]
pub struct Shell<'a> {
    /// The skin.
    pub skin: &'a Mesh,
    /// What varies over it.
    pub fields: &'a Fields,
    /// What fills the shell.
    pub undercoat: Undercoat,
    /// Skin to the top of the shell, per vertex, m: the height of the tallest hair along the lean.
    pub offsets_m: Vec<Vec3>,
    /// Which prism lies beyond each side.
    pub neighbours: Neighbours,
}

impl<'a> Shell<'a> {
    /// Extrudes `skin`; vertices of one position class share their offset, so prisms meet without cracks.
    pub fn new(skin: &'a Mesh, fields: &'a Fields, undercoat: Undercoat) -> Self {
        let offset = |v: usize| fields.lean[v] * (undercoat.height_m * fields.length[v].max(LEAST_HEIGHT));
        let offsets_m = skin.position_class.iter().map(|&class| offset(class as usize)).collect();
        Self { skin, fields, undercoat, offsets_m, neighbours: Neighbours::new(skin) }
    }

    /// The prism over triangle `t`.
    pub fn prism(&self, t: u32) -> Prism {
        let corners = self.skin.triangles[t as usize].map(|v| v as usize);
        Prism { foot_m: corners.map(|v| self.skin.positions_m[v]), offset_m: corners.map(|v| self.offsets_m[v]) }
    }

    /// Bytes held beyond the skin's own.
    pub fn bytes(&self) -> usize {
        self.offsets_m.len() * size_of::<Vec3>() + self.neighbours.bytes()
    }
}
