//! Items of the arrays that shaders read; `tests/shaders.rs` compares names, offsets and sizes with the WGSL.

use crate::data::strands::Strands;
use crate::math::Vec3;
use crate::volume::scene::Scene;
use bytemuck::{Pod, Zeroable};

/// No triangle, no item.
pub const NOTHING: u32 = u32::MAX;

/// Traits of triangles: reaches an open edge; depths of the mean shadow of the hair around go linearly from column to column.
pub const AT_BORDER: u32 = 1;
/// As above.
pub const LINEAR: u32 = 2;

/// `Triangle` of `shared/scene.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct TriangleItem {
    /// Vertices.
    pub corners: [u32; 3],
    /// Subdivisions of the stored density.
    pub density_splits: u32,
    /// Across the edges opposite to each corner: triangle · 4 + its opposite corner, or [`NOTHING`].
    pub beyond: [u32; 3],
    /// Subdivisions of the stored shadow.
    pub shadow_splits: u32,
    /// First column of the stored density, or [`NOTHING`].
    pub density_at: u32,
    /// First column of the stored shadow, or [`NOTHING`].
    pub shadow_at: u32,
    /// Of the skin at rest, m².
    pub rest_area: f32,
    /// [`AT_BORDER`], [`LINEAR`].
    pub traits: u32,
    /// Subdivisions of the mean shadow, and where its columns begin.
    pub mean_splits: u32,
    /// As above.
    pub mean_at: u32,
    pub(super) _pad: [u32; 2],
}

/// `Vertex` of `shared/scene.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct VertexItem {
    /// Position, m.
    pub position_m: [f32; 3],
    /// Density over the preset's.
    pub density: f32,
    /// Skin to the top of the shell, m.
    pub offset_m: [f32; 3],
    /// Length over the preset's.
    pub length: f32,
    /// Smooth unit normal.
    pub normal: [f32; 3],
    /// Clump strength over the preset's.
    pub clump: f32,
    /// Unit vector along the mean hair.
    pub lean: [f32; 3],
    pub(super) _pad0: f32,
    /// Hair colour, linear RGB.
    pub tint: [f32; 3],
    pub(super) _pad1: f32,
    /// Position at rest, m.
    pub rest_m: [f32; 3],
    pub(super) _pad2: f32,
    /// Smooth unit normal at rest.
    pub rest_normal: [f32; 3],
    pub(super) _pad3: f32,
}

impl VertexItem {
    /// The vertices of a scene; `offsets_m` may be empty where there is no undercoat.
    pub fn of(scene: &Scene<'_>, normals: &[Vec3], offsets_m: &[Vec3]) -> Vec<Self> {
        let fields = scene.fields;
        let posed = scene.skin.rest_m.as_ref().map(|rest_m| (rest_m, scene.skin.at_rest().smooth_normals()));
        let (rest_m, rest_normals) = match &posed {
            Some((rest_m, rest_normals)) => (&rest_m[..], &rest_normals[..]),
            None => (&scene.skin.positions_m[..], normals),
        };
        (0..scene.skin.positions_m.len())
            .map(|v| Self {
                position_m: scene.skin.positions_m[v].to_array(),
                density: fields.density[v],
                offset_m: offsets_m.get(v).map_or([0.0; 3], |o| o.to_array()),
                length: fields.length[v],
                normal: normals[v].to_array(),
                clump: fields.clump[v],
                lean: fields.lean[v].to_array(),
                _pad0: 0.0,
                tint: fields.tint[v].to_array(),
                _pad1: 0.0,
                rest_m: rest_m[v].to_array(),
                _pad2: 0.0,
                rest_normal: rest_normals[v].to_array(),
                _pad3: 0.0,
            })
            .collect()
    }
}

/// `Strand` of `shared/scene.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct StrandItem {
    /// Linear RGB.
    pub tint: [f32; 3],
    /// Source index.
    pub id: u32,
    /// Of the root, corners 0 and 1.
    pub b: [f32; 2],
    /// Of the root.
    pub triangle: u32,
    /// Radius at the root, m.
    pub root_radius_m: f32,
}

impl StrandItem {
    /// One per hair.
    pub fn of(strands: &Strands) -> Vec<Self> {
        (0..strands.len())
            .map(|i| Self {
                tint: strands.tint[i].to_array(),
                id: strands.id[i],
                b: strands.roots[i].barycentric,
                triangle: strands.roots[i].triangle,
                root_radius_m: strands.root_radius_m[i],
            })
            .collect()
    }
}

/// `Inside` of `hybrid/march.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct InsideItem {
    /// Barycentric coordinates of corners 1 and 2.
    pub b: [f32; 2],
    /// Height in the shell.
    pub t: f32,
    /// Prism.
    pub triangle: u32,
}

/// `VirtualFragment` of `shared/virtual_fragment.wgsl`, which only shaders read and write.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[expect(missing_docs, reason = "each field is described where the shader declares it")]
pub struct VirtualFragmentItem {
    pub radiance: [f32; 3],
    pub from_m: f32,
    pub to_m: f32,
    pub depth: f32,
    pub(super) _pad0: [u32; 2],
    pub faces: [u32; 3],
    pub next: u32,
}
