//! One triangle primitive as stored, in its own space.

use crate::math::{Vec2, Vec3, Vec4};

/// Joint influences of a vertex: joint and weight; weights sum to 1.
pub type Influences = [(u16, f32); 8];

/// What a morph target adds.
#[derive(Clone, Debug, Default)]
pub struct Morph {
    /// Position changes, one per vertex, or none.
    pub positions: Vec<Vec3>,
    /// Normal changes, one per vertex, or none.
    pub normals: Vec<Vec3>,
}

/// Vertex data in the primitive's own space and units, one entry per stored vertex, and its triangles.
#[derive(Clone, Debug, Default)]
pub struct Primitive {
    /// Positions.
    pub positions: Vec<Vec3>,
    /// Unit normals: stored ones, repaired where they were missing or not unit.
    pub normals: Vec<Vec3>,
    /// `TEXCOORD_n` in order.
    pub uv_sets: Vec<Vec<Vec2>>,
    /// `COLOR_0`, alpha 1 where it has none.
    pub colour: Option<Vec<Vec4>>,
    /// `_FUR_LENGTH`.
    pub fur_length: Option<Vec<f32>>,
    /// `_FUR_REGION`.
    pub fur_region: Option<Vec<f32>>,
    /// `_FUR_DIRECTION`.
    pub fur_direction: Option<Vec<Vec3>>,
    /// Joints and weights of skinned primitives.
    pub influences: Option<Vec<Influences>>,
    /// Morph targets.
    pub morphs: Vec<Morph>,
    /// Triangles that have an area, counter-clockwise from where the normals point.
    pub triangles: Vec<[u32; 3]>,
    /// Smallest index of a vertex at the same place, one per vertex.
    pub position_class: Vec<u32>,
}
