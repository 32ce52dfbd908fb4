//! The product: tiles of hair and the primitives that carry them (`docs/extension/`).

use super::image::Image8;
use super::patches::Patches;
use super::slabs::Slabs;
use super::texture::Texture;
use crate::math::{Vec2, Vec3, Vec4};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Angles between ray and normal for which a gain is stored, degrees.
pub const GAIN_ANGLES_DEG: [f32; 9] = [0.0, 10.0, 22.0, 35.0, 48.0, 60.0, 70.0, 79.0, 86.0];

/// A furry asset's coat.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Coat {
    /// How long a unit of the file is, m: hair is as thick as its tile says on an asset of that size.
    pub metres_per_unit: f64,
    /// Hair textures, shared by primitives.
    pub tiles: Vec<Tile>,
    /// One or more per furred primitive of the asset: what lies between them is another tile, or a passage between two.
    pub primitives: Vec<CoatPrimitive>,
}

/// Where the hair of a tile grew.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Sampled {
    /// On a flat toroidal square: textures repeat, and a coat's tint gives them colour and density.
    #[default]
    Square,
    /// On the skin itself: each place of the skin has texels of its own, which hold its colour and density; the coat's
    /// tint is for fins alone. Textures end at their borders.
    Skin,
}

/// Hair of a square with its mean lean removed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tile {
    /// Name of the preset it was grown from.
    pub preset: String,
    /// Where its hair grew.
    pub sampled: Sampled,
    /// Edge length that one unit of coat UV stands for, m in the world the coat was baked for.
    pub edge_m: f32,
    /// Height of the stack, m: the length of the longest hair's vertical reach at offset scale 1.
    pub height_m: f32,
    /// The shells.
    pub shells: ShellStack,
    /// The fin texture.
    pub fin: FinTexture,
    /// Coarser stacks of the same hair, each coarser than the one before, for pictures that show it small.
    pub levels: Vec<Level>,
    /// How its hair is lit; none in a file of an earlier version, whose hair is that of the default fibre.
    pub looks: Option<TileLooks>,
}

/// A coarser stack of a tile's hair.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Level {
    /// Its shells.
    pub shells: ShellStack,
    /// As [`TileLooks::undercoat_share`].
    pub undercoat_share: Vec<f32>,
    /// How high the longest hair is in a picture, pixels, up to which it suffices.
    pub most_px: f32,
}

impl Tile {
    /// This tile with the shells of a level alone, 0 being its own.
    pub fn at_level(&self, level: usize) -> Cow<'_, Self> {
        let Some(coarse) = level.checked_sub(1).and_then(|i| self.levels.get(i)) else { return Cow::Borrowed(self) };
        let undercoat_share = coarse.undercoat_share.clone();
        Cow::Owned(Self {
            preset: self.preset.clone(),
            sampled: self.sampled,
            edge_m: self.edge_m,
            height_m: self.height_m,
            shells: coarse.shells.clone(),
            levels: Vec::new(),
            fin: self.fin.clone(),
            looks: self.looks.as_ref().map(|looks| TileLooks {
                of: looks.of,
                crowding: looks.crowding,
                undercoat_share,
            }),
        })
    }
}

/// Quadruples of numbers of a look: `Look` of `shaders/shared/look.wgsl` says which is which.
pub const LOOK: usize = 53;

/// How a tile's hair is lit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TileLooks {
    /// Guard hair and undercoat.
    #[serde(with = "looks")]
    pub of: [[[f32; 4]; LOOK]; 2],
    /// Hair area per volume times diameter, of guard hair and undercoat.
    pub crowding: [f32; 2],
    /// Per layer: share of the hair that is undercoat.
    pub undercoat_share: Vec<f32>,
}

/// Looks as one list of numbers: serde's arrays end at 32.
mod looks {
    use super::LOOK;
    use serde::de::{Deserialize, Deserializer, Error};
    use serde::ser::{Serialize, Serializer};

    pub fn serialize<S: Serializer>(of: &[[[f32; 4]; LOOK]; 2], serializer: S) -> Result<S::Ok, S::Error> {
        of.as_flattened().as_flattened().serialize(serializer)
    }

    pub fn deserialize<'d, D: Deserializer<'d>>(deserializer: D) -> Result<[[[f32; 4]; LOOK]; 2], D::Error> {
        let numbers = Vec::<f32>::deserialize(deserializer)?;
        if numbers.len() != 2 * LOOK * 4 {
            return Err(D::Error::invalid_length(numbers.len(), &"the numbers of two looks"));
        }
        let number = |kind: usize, row: usize, i: usize| numbers[(kind * LOOK + row) * 4 + i];
        Ok(std::array::from_fn(|kind| std::array::from_fn(|row| std::array::from_fn(|i| number(kind, row, i)))))
    }
}

/// Shells over the opaque skin (layer 0): `layers − 1` slabs, of which that of layer i is drawn at its top.
///
/// The law that gives a slab's opacity (`docs/steps/shells.md`): τ = g(θ)·[A √(1 − (ω·m)²) Δh/|cos θ| + κ], α = 1 − e^−τ.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ShellStack {
    /// Layers with the skin: textures have this many array layers.
    pub layers: u32,
    /// Where they lie; `layers` − 1 of them.
    pub slabs: Slabs,
    /// Texels along an edge of mip 0; a power of two.
    pub size: u32,
    /// Per mip and layer (`[mip][layer]`): gains g at [`GAIN_ANGLES_DEG`]. The skin's mean nothing.
    pub gains: Vec<Vec<[f32; 9]>>,
    /// Per layer: mean slope (dx, dy)/dz of the hair in tile axes.
    pub slopes: Vec<Vec2>,
    /// Per mip: the extinction that a stored 1 stands for, 1/m. A mip's own, so that eight bits still tell directions
    /// where hair fills a hundredth of a texel.
    pub extinction_scales_per_m: Vec<f32>,
    /// RGBA8 per mip and layer (`[mip][layer]`): straight albedo in sRGB coding, and in alpha the hair area above
    /// ([`super::shell::above_of`]).
    pub albedo: Vec<Vec<Image8>>,
    /// RGBA8 per mip and layer: A/scale, then A·m/scale as (x, y, z)·127/255 + 128/255, linear.
    pub medium: Vec<Vec<Image8>>,
    /// R8 per mip and layer: 1 − e^−κ, linear.
    pub ends: Vec<Vec<Image8>>,
}

/// A slab of hair seen along the skin: x along the edge (toroidal), rows from the tips (0) to the roots.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FinTexture {
    /// Texels along the edge direction and along the hair, of mip 0.
    pub size: [u32; 2],
    /// How much edge one unit of u stands for, m.
    pub width_m: f32,
    /// Thickness of the slab that was composited, m; an edge's own thickness scales optical depth.
    pub thickness_m: f32,
    /// RGBA8 per mip: straight albedo in sRGB coding, opacity (linear).
    pub albedo: Vec<Image8>,
    /// RGBA8 per mip: mean tangent (along the edge, across it, up)·127/255 + 128/255, hair area above.
    pub tangent: Vec<Image8>,
}

/// What one primitive of the asset carries. Arrays have one entry per coat vertex.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CoatPrimitive {
    /// glTF mesh.
    pub mesh: usize,
    /// Primitive of that mesh.
    pub primitive: usize,
    /// Tile it carries.
    pub tile: usize,
    /// Vertex of the base primitive that carries position, skin and morph data.
    pub base_vertex: Vec<u32>,
    /// Texture coordinate in tiles.
    pub uv: Vec<Vec2>,
    /// Patch, chart or island the vertex belongs to.
    pub patch: Vec<u32>,
    /// Root to the top of the stack, in the base primitive's own space and units.
    pub offset: Vec<Vec3>,
    /// The tile's x axis along the skin, in the base primitive's own space: a metre of the world in the rest pose. It is the
    /// same on both sides of a seam, however patches lie there; zero where it is the texture's own.
    pub axis: Vec<Vec3>,
    /// Unit normal of the skin as hair stands on it, in the base primitive's own space: that of the surface across seams, not that
    /// of shading. Empty in files of versions 1 and 2, where it is the base vertex's.
    pub normal: Vec<Vec3>,
    /// Colour factor (linear RGB) and density factor.
    pub tint: Vec<Vec4>,
    /// Colour at the root, beside the tint's: a texture of the file, over texture coordinates of the base vertices.
    pub colour: Option<Texture>,
    /// What is painted at the root: density in red, length in green.
    pub painted: Option<Texture>,
    /// Longest length that is painted around each vertex, which its offset has; empty where none is painted.
    pub longest: Vec<f32>,
    /// Coat vertex indices, counter-clockwise from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Edges that may carry a fin.
    pub fins: Vec<FinEdge>,
    /// The tile that it passes into, where it does.
    pub blend: Option<Blend>,
    /// The same triangles cut so finely that vertices tell the colours, for programs that know vertex colours alone; it is in
    /// no file but as fallback shells.
    pub cut: Option<Cut>,
}

/// A coat primitive's triangles, cut.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cut {
    /// Per vertex: three coat vertices and their shares, which sum to 1.
    pub inside: Vec<([u32; 3], [f32; 3])>,
    /// Per vertex: colour of the hair (linear RGB) and density factor.
    pub tint: Vec<Vec4>,
    /// Vertex indices.
    pub triangles: Vec<[u32; 3]>,
    /// Whether there is more to see than could be cut out.
    pub coarse: bool,
}

/// A passage from a coat primitive's tile into another with equally many layers: both are there on the same shells, and with weight w
/// the optical depth is (1 − w) of the first's and w of the second's, colour premultiplied.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Blend {
    /// The second tile. Its texture coordinates are the primitive's times the first tile's edge over its own.
    pub tile: usize,
    /// Per coat vertex: w, in [0, 1].
    pub weight: Vec<f32>,
}

impl CoatPrimitive {
    /// Its triangles on the skin: vertices of the base primitive.
    pub fn skin_triangles(&self) -> Vec<[u32; 3]> {
        self.triangles.iter().map(|triangle| triangle.map(|v| self.base_vertex[v as usize])).collect()
    }

    /// Its texture coordinates alone; nothing is measured.
    pub fn patches(&self) -> Patches {
        Patches {
            base_vertex: self.base_vertex.clone(),
            uv: self.uv.clone(),
            patch: self.patch.clone(),
            triangles: self.triangles.clone(),
            ..Patches::default()
        }
    }

    /// The part of it that some of its triangles are, on the vertices that those need. Fins stay where both ends do.
    pub fn part(&self, keep: impl Fn(usize) -> bool) -> Self {
        let triangles: Vec<[u32; 3]> =
            self.triangles.iter().enumerate().filter(|(t, _)| keep(*t)).map(|(_, triangle)| *triangle).collect();
        let mut new = vec![u32::MAX; self.base_vertex.len()];
        let mut old = Vec::new();
        for &v in triangles.iter().flatten() {
            if new[v as usize] == u32::MAX {
                new[v as usize] = old.len() as u32;
                old.push(v as usize);
            }
        }
        let of = |v: u32| new[v as usize];
        let whole = |fin: &&FinEdge| fin.ends.iter().chain(&fin.opposite).all(|&v| of(v) != u32::MAX);
        let moved = |fin: &FinEdge| FinEdge { ends: fin.ends.map(of), opposite: fin.opposite.map(of), ..*fin };
        Self {
            base_vertex: old.iter().map(|&v| self.base_vertex[v]).collect(),
            uv: old.iter().map(|&v| self.uv[v]).collect(),
            patch: old.iter().map(|&v| self.patch[v]).collect(),
            offset: old.iter().map(|&v| self.offset[v]).collect(),
            axis: old.iter().map(|&v| self.axis[v]).collect(),
            normal: old.iter().filter_map(|&v| self.normal.get(v).copied()).collect(),
            longest: old.iter().filter_map(|&v| self.longest.get(v).copied()).collect(),
            colour: self.colour.clone(),
            painted: self.painted.clone(),
            cut: None,
            tint: old.iter().map(|&v| self.tint[v]).collect(),
            triangles: triangles.iter().map(|t| t.map(of)).collect(),
            fins: self.fins.iter().filter(whole).map(moved).collect(),
            blend: self
                .blend
                .as_ref()
                .map(|blend| Blend { tile: blend.tile, weight: old.iter().map(|&v| blend.weight[v]).collect() }),
            mesh: self.mesh,
            primitive: self.primitive,
            tile: self.tile,
        }
    }
}

/// An edge of the coat with the faces beside it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FinEdge {
    /// Coat vertices of its ends.
    pub ends: [u32; 2],
    /// Coat vertices opposite to the edge in its two faces, from which both face normals follow under any
    /// deformation; equal where the edge is a border.
    pub opposite: [u32; 2],
    /// Interval of the fin texture.
    pub u: [f32; 2],
    /// Thickness of hair that this fin stands for over the texture's, so that all fins together hold the coat once.
    pub thickness: f32,
}
