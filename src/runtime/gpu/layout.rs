//! Structs as the shaders read them; `tests/shaders.rs` compares names, offsets and sizes with the WGSL.

use crate::data::coat::{FinEdge, LOOK, Sampled, ShellStack, Tile};
use crate::data::image::Image8;
use crate::data::shell::unorm;
use crate::error::Result;
use crate::gpu::light::LightItem;
use crate::math::Vec2;
use crate::runtime::casters::Casters;
use crate::runtime::draw_list::{CoatMesh, Frame, MAX_LIGHTS, SkinMesh};
use crate::runtime::outer_normals;
use crate::runtime::shadow_view::ShadowView;
use crate::shade::fibre::{FibreModel, FibreParameters};
use crate::shade::law::known;
use bytemuck::{Pod, Zeroable};

/// `Frame` of `shared/view.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct ViewUniform {
    /// Columns of the matrix.
    pub clip_from_world: [[f32; 4]; 4],
    /// Eye or direction to it.
    pub eye: [f32; 4],
    /// Radiance from everywhere.
    pub ambient: [f32; 3],
    /// How many of `lights` count.
    pub light_count: u32,
    /// The lights.
    pub lights: [LightItem; MAX_LIGHTS],
    /// Columns of the matrix to the shadow map.
    pub shadow_from_world: [[f32; 4]; 4],
    /// How far what is compared with it is moved, m; 0 without a map.
    pub shadow_bias_m: f32,
    pub(super) _pad: [f32; 3],
}

impl ViewUniform {
    /// The view's numbers, and those of its shadow map where there is one; lights past [`MAX_LIGHTS`] were refused before.
    pub fn new(view: &Frame, shadow: Option<&ShadowView>) -> Self {
        let mut lights = [LightItem::default(); MAX_LIGHTS];
        for (slot, light) in lights.iter_mut().zip(&view.lights) {
            *slot = light.into();
        }
        Self {
            clip_from_world: view.clip_from_world.to_cols_array_2d(),
            eye: view.eye.to_array(),
            ambient: view.ambient.to_array(),
            light_count: view.lights.len().min(MAX_LIGHTS) as u32,
            lights,
            shadow_from_world: shadow.map_or([[0.0; 4]; 4], |shadow| shadow.clip_from_world.to_cols_array_2d()),
            shadow_bias_m: shadow.map_or(0.0, |shadow| shadow.bias_m),
            _pad: [0.0; 3],
        }
    }
}

/// `Tile` of `shared/coat.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct TileUniform {
    /// Length that one unit of UV stands for, m.
    pub edge_m: f32,
    /// Height of the stack, m.
    pub height_m: f32,
    /// Texels along an edge.
    pub size: f32,
    /// Layers, the skin counted.
    pub layers: u32,
    /// Mips.
    pub mips: u32,
    /// 1 where the coat's tint gives shells colour and density, 0 where the texels hold them.
    pub tinted: f32,
    /// Extinction that a number of 1 in the medium's texture stands for, 1/m: see [`medium_unit_per_m`].
    pub medium_unit_per_m: f32,
}

/// `Slab` of `shared/coat.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct SlabItem {
    /// Mean slope of the hair.
    pub slope: [f32; 2],
    /// Heights over the stack's.
    pub bottom: f32,
    /// Of its top.
    pub top: f32,
}

impl SlabItem {
    /// The layers of `shells`; the skin's is flat.
    pub fn of(shells: &ShellStack) -> Vec<Self> {
        let of = |(layer, slope): (usize, &Vec2)| {
            let [bottom, top] = if layer == 0 { [0.0; 2] } else { shells.slabs.span(layer - 1) };
            Self { slope: slope.to_array(), bottom, top }
        };
        shells.slopes.iter().enumerate().map(of).collect()
    }
}

/// `Mip` of `shared/coat.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Mip {
    /// Gains at the stored angles.
    pub gains: [f32; 9],
}

impl Mip {
    /// The mips of `tile`.
    pub fn of(tile: &Tile) -> Vec<Self> {
        tile.shells.gains.iter().flatten().map(|&gains| Self { gains }).collect()
    }
}

/// Unit of the decoded medium on the device, 1/m: the largest number of all mips is 1024 of it. Half floats then hold those of
/// mips with a thousandth of that scale as exactly.
pub fn medium_unit_per_m(shells: &ShellStack) -> f32 {
    shells.extinction_scales_per_m.iter().fold(f32::MIN_POSITIVE, |most, &scale| most.max(scale)) / 1024.0
}

/// `LayerLook` of `runtime/looks.wgsl`: how the hair of a layer is lit.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct LayerLook {
    /// Hair area per volume times diameter.
    pub crowding: f32,
    /// Hair area of the layer per skin area, in the mean.
    pub area: f32,
    /// Hair area above the layer's top over that above its middle.
    pub top_share: f32,
    /// Height over which the hair area above falls to 1/e, over the stack's.
    pub scale: f32,
}

/// Looks of a tile's hair, and which of them each layer has.
pub struct LitLayers {
    /// `Look` of `shared/look.wgsl`.
    pub looks: [[[f32; 4]; LOOK]; 2],
    /// Which of them each layer has: 0 guard hair, 1 undercoat.
    pub kinds: Vec<usize>,
    /// One per layer.
    pub layers: Vec<LayerLook>,
}

impl LayerLook {
    /// Those of a tile: a layer is lit as the kind of hair of which it has more. Tiles of earlier versions say nothing of theirs;
    /// their hair is that of the default fibre.
    ///
    /// # Errors
    /// As [`known::scattering`].
    pub fn of(tile: &Tile) -> Result<LitLayers> {
        let layers = tile.shells.layers as usize;
        let of = match &tile.looks {
            Some(looks) => looks.of,
            None => [known::scattering(FibreModel::default(), &FibreParameters::default())?.packed(); 2],
        };
        let kind = |layer: usize| match &tile.looks {
            Some(looks) => {
                let look = usize::from(looks.undercoat_share[layer] > 0.5);
                (look, looks.crowding[look])
            }
            None => (0, 0.0),
        };
        // The coarsest mip says how much hair each layer holds in the mean.
        let coarsest = tile.shells.medium.last().zip(tile.shells.extinction_scales_per_m.last());
        let thickness = |layer: usize| tile.shells.slabs.thickness(layer.max(1) - 1);
        let area = |layer: usize| {
            let extinction = |(mip, scale): (&Vec<Image8>, &f32)| Some(unorm(*mip.get(layer)?.pixels.first()?) * scale);
            if layer == 0 {
                0.0
            } else {
                coarsest.and_then(extinction).unwrap_or(0.0) * thickness(layer) * tile.height_m
            }
        };
        let mut above_top = 0.0;
        let mut of_layers: Vec<Self> = (0..layers)
            .rev()
            .map(|layer| {
                let area = area(layer);
                let middle = above_top + 0.5 * area;
                let top_share = if middle > 0.0 { above_top / middle } else { 1.0 };
                let scale =
                    (thickness(layer) * middle / area.max(f32::MIN_POSITIVE)).clamp(0.5 * thickness(layer), 1.0);
                above_top += area;
                Self { crowding: kind(layer).1, area, top_share, scale }
            })
            .collect();
        of_layers.reverse();
        Ok(LitLayers { looks: of, kinds: (0..layers).map(|layer| kind(layer).0).collect(), layers: of_layers })
    }
}

impl TileUniform {
    /// The tile's numbers.
    pub fn new(tile: &Tile) -> Self {
        Self {
            edge_m: tile.edge_m,
            height_m: tile.height_m,
            size: tile.shells.size as f32,
            layers: tile.shells.layers,
            mips: tile.shells.albedo.len() as u32,
            tinted: if tile.sampled == Sampled::Square { 1.0 } else { 0.0 },
            medium_unit_per_m: medium_unit_per_m(&tile.shells),
        }
    }
}

/// `CoatVertex` of `shared/coat.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct CoatVertex {
    /// Position on the skin, m.
    pub position_m: [f32; 3],
    /// First texture coordinate.
    pub u: f32,
    /// Root to the top of the stack, m.
    pub offset_m: [f32; 3],
    /// Second texture coordinate.
    pub v: f32,
    /// Normal of the skin.
    pub normal: [f32; 3],
    /// Longest length painted around it.
    pub longest: f32,
    /// The tile's x axis on the skin.
    pub axis: [f32; 3],
    /// Sum of the skin's principal curvatures, 1/m; outwards positive.
    pub bend_per_m: f32,
    /// Colour and density factors.
    pub tint: [f32; 4],
    /// Where textures of the root are read: of colour, of what is painted.
    pub root: [f32; 4],
    /// Normal of the coat's outer side.
    pub outer_normal: [f32; 3],
    /// How far it is from where the coat ends, m; [`FAR_AWAY_M`] where it nowhere does.
    pub away_m: f32,
}

/// `Paint` of `shared/coat.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct PaintUniform {
    /// 1 where there is a texture of colour.
    pub has_colour: u32,
    /// 1 where density and length are painted.
    pub has_painted: u32,
    /// Share of the optical depth that the level which is drawn has.
    pub share: f32,
    /// Share of the fins that is drawn.
    pub fins: f32,
}

impl PaintUniform {
    /// What `fur` has, all of it drawn.
    pub fn new(fur: &CoatMesh<'_>) -> Self {
        Self {
            has_colour: u32::from(fur.colour.is_some()),
            has_painted: u32::from(fur.painted.is_some()),
            share: 1.0,
            fins: 1.0,
        }
    }
}

/// Stands for a coat that ends nowhere, m.
pub const FAR_AWAY_M: f32 = 1e3;

impl CoatVertex {
    /// The vertices of `fur`, which are so far from where it ends, m, and whose skin bends so, 1/m.
    pub fn of(fur: &CoatMesh<'_>, away_m: &[f32], bends_per_m: &[f32]) -> Vec<Self> {
        let outer_normals = outer_normals(fur);
        (0..fur.positions_m.len())
            .map(|i| Self {
                position_m: fur.positions_m[i].to_array(),
                u: fur.uv[i].x,
                offset_m: fur.offsets_m[i].to_array(),
                v: fur.uv[i].y,
                normal: fur.normals[i].to_array(),
                longest: fur.longest.get(i).copied().unwrap_or(1.0),
                axis: fur.axes.get(i).map_or([0.0; 3], |axis| axis.to_array()),
                bend_per_m: bends_per_m[i],
                tint: fur.tint[i].to_array(),
                root: fur.root.get(i).map_or([0.0; 4], |root| root.to_array()),
                outer_normal: outer_normals[i].to_array(),
                away_m: away_m[i].min(FAR_AWAY_M),
            })
            .collect()
    }
}

/// `FinEdge` of `runtime/fin.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct FinInstance {
    /// Coat vertices of its ends.
    pub ends: [u32; 2],
    /// Interval of the fin texture.
    pub u: [f32; 2],
    /// Thickness over the texture's.
    pub thickness: f32,
    /// Thickness of hair that it stands for, m.
    pub spacing_m: f32,
}

impl FinInstance {
    /// A fin whose texture holds hair `texture_m` thick.
    pub fn new(edge: &FinEdge, texture_m: f32) -> Self {
        let spacing_m = edge.thickness * texture_m;
        Self { ends: edge.ends, u: edge.u, thickness: edge.thickness, spacing_m }
    }
}

/// A vertex of `runtime/skin.wgsl`, attributes in the order of their locations.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct SkinVertex {
    /// Position, m.
    pub position_m: [f32; 3],
    /// Unit normal.
    pub normal: [f32; 3],
    /// Linear RGB.
    pub colour: [f32; 3],
    /// Base colour texture coordinate.
    pub uv: [f32; 2],
    /// Tile texture coordinate.
    pub coat_uv: [f32; 2],
    /// Density factor of the coat; 0 where there is none.
    pub coat_density: f32,
    /// Texture coordinate of what is painted.
    pub painted_uv: [f32; 2],
}

impl SkinVertex {
    /// Attribute formats, by location.
    pub const ATTRIBUTES: [wgpu::VertexAttribute; 7] = wgpu::vertex_attr_array![
        0 => Float32x3, 1 => Float32x3, 2 => Float32x3, 3 => Float32x2, 4 => Float32x2, 5 => Float32,
        6 => Float32x2
    ];

    /// The vertices of `skin`.
    pub fn of(skin: &SkinMesh<'_>) -> Vec<Self> {
        (0..skin.positions_m.len())
            .map(|i| Self {
                position_m: skin.positions_m[i].to_array(),
                normal: skin.normals[i].to_array(),
                colour: skin.colour[i].to_array(),
                uv: skin.uv.get(i).map_or([0.0; 2], |uv| uv.to_array()),
                coat_uv: skin.coat_uv.get(i).map_or([0.0; 2], |uv| uv.to_array()),
                coat_density: skin.coat_density.get(i).copied().unwrap_or(0.0),
                painted_uv: skin.painted_uv.get(i).map_or([0.0; 2], |uv| uv.to_array()),
            })
            .collect()
    }
}

/// A vertex of `runtime/caster.wgsl`, attributes in the order of their locations.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct CasterVertex {
    /// Position, m.
    pub position_m: [f32; 3],
    /// How far it moves across the light, m.
    pub swell_m: [f32; 3],
}

impl CasterVertex {
    /// Attribute formats, by location.
    pub const ATTRIBUTES: [wgpu::VertexAttribute; 2] = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3];

    /// The vertices of `casters`.
    pub fn of(casters: &Casters) -> Vec<Self> {
        let vertices = casters.positions_m.iter().zip(&casters.swell_m);
        vertices.map(|(p, s)| Self { position_m: p.to_array(), swell_m: s.to_array() }).collect()
    }
}
