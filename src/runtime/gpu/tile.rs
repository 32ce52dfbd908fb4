//! Tiles on the device.

use super::bindings::{bind, sampler, view};
use super::layout::{LayerLook, Mip, SlabItem, TileUniform, medium_unit_per_m};
use super::pipelines::Layouts;
use crate::data::coat::{FinEdge, FinTexture, LOOK, Sampled, ShellStack, Tile};
use crate::data::image::Image8;
use crate::data::shell::{Slabs, signed, unorm};
use crate::data::texture::Wrap;
use crate::error::Result;
use crate::gpu::{Coding, Gpu};
use crate::math::Vec2;
use crate::runtime::draw_list::CoatMesh;
use crate::runtime::outer_edge_m;
use crate::runtime::sight::{Before, LevelSight, Point, Sighted};

/// A tile's textures and tables.
pub struct GpuTile {
    /// Group 1, with each of its looks.
    pub groups: [wgpu::BindGroup; 2],
    /// Group 3 of fins.
    pub fin: wgpu::BindGroup,
    /// Thickness of the hair that its fin texture holds, m.
    pub fin_thickness_m: f32,
    /// Height of the stack, m.
    height_m: f32,
    /// Its stack as far as sight goes.
    sight: LevelSight,
    /// Texture memory.
    pub bytes: u64,
}

impl GpuTile {
    /// Uploads the finest level of `tile`, which suffices up to `most_px`.
    ///
    /// # Errors
    /// As [`Gpu::texture_array`].
    pub fn new(gpu: &Gpu, layouts: &Layouts, tile: &Tile, most_px: f32) -> Result<Self> {
        let shells = &tile.shells;
        let albedo = gpu.texture_array("shell albedo", &shells.albedo, Coding::Srgb)?;
        let (unit_per_m, scales_per_m) = (medium_unit_per_m(shells), &shells.extinction_scales_per_m);
        let medium = gpu.half_array("shell medium", &shells.medium, &|mip, channel, byte| {
            let scale = scales_per_m.get(mip).copied().unwrap_or(0.0) / unit_per_m;
            scale * if channel == 0 { unorm(byte) } else { signed(byte) }
        })?;
        let ends = gpu.half_array("shell ends", &shells.ends, &|_, _, byte| unorm(byte))?;
        let single = |images: &[Image8]| images.iter().map(|image| vec![image.clone()]).collect::<Vec<_>>();
        let fin_albedo = gpu.texture_array("fin albedo", &single(&tile.fin.albedo), Coding::Srgb)?;
        let fin_tangent = gpu.texture_array("fin tangent", &single(&tile.fin.tangent), Coding::Linear)?;
        let uniform = gpu.buffer("tile", &[TileUniform::new(tile)], wgpu::BufferUsages::UNIFORM);
        let slabs = gpu.buffer("slabs", &SlabItem::of(shells), wgpu::BufferUsages::STORAGE);
        let mips = gpu.buffer("mips", &Mip::of(tile), wgpu::BufferUsages::STORAGE);
        let lit = LayerLook::of(tile)?;
        let layer_looks = gpu.buffer("layer looks", &lit.layers, wgpu::BufferUsages::STORAGE);
        let wrap = if tile.sampled == Sampled::Square { Wrap::Repeat } else { Wrap::Clamp };
        let hair_sampler = sampler(gpu, [wrap; 2], 1);
        let group = |look: &[[f32; 4]; LOOK]| {
            let look = gpu.buffer("look", look, wgpu::BufferUsages::STORAGE);
            let resources = [
                uniform.as_entire_binding(),
                slabs.as_entire_binding(),
                mips.as_entire_binding(),
                wgpu::BindingResource::Sampler(&hair_sampler),
                view(&albedo),
                view(&medium),
                view(&ends),
                look.as_entire_binding(),
                layer_looks.as_entire_binding(),
            ];
            bind(gpu, &layouts.tile, &resources)
        };
        let groups = lit.looks.each_ref().map(group);
        let fin_sampler = sampler(gpu, [Wrap::Repeat, Wrap::Clamp], 4);
        let fin = bind(
            gpu,
            &layouts.fin,
            &[wgpu::BindingResource::Sampler(&fin_sampler), view(&fin_albedo), view(&fin_tangent)],
        );
        let bytes = [&albedo, &medium, &ends, &fin_albedo, &fin_tangent].iter().map(|texture| texture.bytes).sum();
        let before = if tile.sampled == Sampled::Square { before(tile, &lit.layers) } else { vec![] };
        let fin_thickness_m = tile.fin.thickness_m;
        Ok(Self {
            groups,
            fin,
            fin_thickness_m,
            height_m: tile.height_m,
            sight: LevelSight { tops: shells.slabs.tops().to_vec(), before, looks: lit.kinds, most_px },
            bytes,
        })
    }

    /// All levels of `tile`, the finest first.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn levels(gpu: &Gpu, layouts: &Layouts, tile: &Tile) -> Result<Vec<Self>> {
        let finest = std::iter::once(Self::new(gpu, layouts, tile, f32::INFINITY));
        let coarser = (1..).zip(&tile.levels);
        finest.chain(coarser.map(|(i, level)| Self::new(gpu, layouts, &tile.at_level(i), level.most_px))).collect()
    }

    /// A coat on a tile of these levels as far as sight goes, whose vertices are so far from where it ends, m, and whose skin bends so, 1/m.
    pub(super) fn sighted(levels: &[Self], fur: &CoatMesh<'_>, away_m: &[f32], bends_per_m: &[f32]) -> Sighted {
        let point = |i: usize| Point {
            position_m: fur.positions_m[i],
            offset_m: fur.offsets_m[i],
            normal: fur.normals[i],
            density: fur.tint[i].w,
            bend_per_m: bends_per_m[i],
            away_m: away_m[i],
        };
        let fin = |fin: &FinEdge| {
            let [start, end] = fin.ends.map(|v| fur.positions_m[v as usize]);
            (fin.ends, (fin.u[1] - fin.u[0]).abs() / start.distance(end).max(f32::MIN_POSITIVE))
        };
        let sight = |level: &Self| {
            let before = if fur.painted.is_some() { vec![] } else { level.sight.before.clone() };
            LevelSight { before, ..level.sight.clone() }
        };
        Sighted {
            points: (0..fur.positions_m.len()).map(point).collect(),
            triangles: fur.triangles.to_vec(),
            fins: fur.fins.iter().map(fin).collect(),
            height_m: levels[0].height_m,
            levels: levels.iter().map(sight).collect(),
            edge_m: outer_edge_m(fur),
            over_last: fur.over_last,
        }
    }
}

/// The hair before each layer of a tile, seen by pixels that span all of it.
fn before(tile: &Tile, layers: &[LayerLook]) -> Vec<Before> {
    let mut above_top = [0.0; 9];
    let mut before: Vec<Before> = Vec::with_capacity(layers.len());
    let gains = tile.shells.gains.last().map_or(&[][..], |gains| &gains[..]);
    for (layer, gains) in layers.iter().zip(gains).rev() {
        before.push(Before { above_top, scale: layer.scale });
        above_top.iter_mut().zip(gains).for_each(|(sum, gain)| *sum += layer.area * gain);
    }
    before.reverse();
    before
}

/// A tile of nothing: transmittance 1 everywhere.
pub fn bare_tile() -> Tile {
    let texel =
        |channels: u32| vec![vec![Image8 { width: 1, height: 1, channels, pixels: vec![255; channels as usize] }]];
    let fin = texel(4).remove(0);
    Tile {
        preset: String::new(),
        sampled: Sampled::Square,
        edge_m: 1.0,
        height_m: 1.0,
        shells: ShellStack {
            layers: 2,
            slabs: Slabs::even(1),
            size: 1,
            gains: vec![vec![[1.0; 9]; 2]],
            slopes: vec![Vec2::ZERO; 2],
            extinction_scales_per_m: vec![1.0],
            albedo: texel(4),
            medium: texel(4),
            ends: texel(1),
        },
        levels: vec![],
        looks: None,
        fin: FinTexture { size: [1, 1], width_m: 1.0, thickness_m: 1.0, albedo: fin.clone(), tangent: fin },
    }
}
