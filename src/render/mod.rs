//! Floor 4: the hybrid renderer. One entry: a scene, rays, a depth range, a film.

pub mod bins;
pub mod bvh;
pub mod cast;
pub mod cone;
pub mod defocus;
pub mod develop;
pub mod device;
pub mod exr;
pub mod flat;
pub mod gpu;
pub mod march;
pub mod mean;
pub mod medium;
pub mod pelt;
pub mod picture;
pub mod pieces;
pub mod rays;
pub mod reference;
pub mod resolve;
pub mod seen;
pub mod shell;
pub mod skin;
pub mod strands;
pub mod table;
pub mod view;

use crate::data::mesh::Mesh;
use crate::data::strands::Strands;
use crate::math::Mat3;
use medium::Medium;

/// What is rendered.
#[derive(Clone, Copy, Debug, Default)]
pub struct Scene<'a> {
    /// Guard hair.
    pub guard: Option<&'a Strands>,
    /// Undercoat as single hairs.
    pub undercoat: Option<&'a Strands>,
    /// Undercoat as a volume.
    pub medium: Option<&'a Medium>,
    /// The opaque skin.
    pub skin: Option<&'a Mesh>,
    /// Edge of a tile that repeats along x and y, m; none for a scene that does not repeat.
    pub torus_m: Option<f32>,
    /// A linear map to a space where hair stands upright, so that boxes around it are thin. Changes how long it takes,
    /// never what is seen. On a torus it must keep x and y.
    pub upright_from_world: Mat3,
}

/// The part of each ray that counts, m from its origin. Hair is cut at its ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthRange {
    /// Begin.
    pub near_m: f32,
    /// End.
    pub far_m: f32,
}

impl DepthRange {
    /// All of the ray.
    pub const ALL: Self = Self { near_m: 0.0, far_m: f32::INFINITY };
}
