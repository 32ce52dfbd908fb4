//! What rays can meet.

use crate::data::mesh::Mesh;
use crate::data::strands::Strands;
use crate::math::Mat3;
use crate::volume::medium::Medium;

/// What rays can meet. Nothing of what is left out.
#[derive(Clone, Copy, Debug, Default)]
pub struct Geometry<'a> {
    /// Guard hair.
    pub guard: Option<&'a Strands>,
    /// Undercoat as single hairs.
    pub undercoat: Option<&'a Strands>,
    /// Undercoat as a volume.
    pub medium: Option<&'a Medium>,
    /// The opaque skin.
    pub skin: Option<&'a Mesh>,
    /// Edge of a tile that repeats along x and y, m; none for hair that does not repeat.
    pub torus_m: Option<f32>,
    /// A linear map to a space where hair stands upright, so that boxes around it are thin. Changes how long it takes,
    /// never what is seen. On a torus it must keep x and y.
    pub upright_from_world: Mat3,
}
