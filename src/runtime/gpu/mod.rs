//! The coat on a graphics device (`docs/steps/runtime.md`; shaders in `shaders/runtime/`).
//!
//! Order: skin (writes depth); the far side of the shells, outer to inner; fins; the near side, inner to outer. Along any
//! ray through a convex body that is back to front.

pub mod layout;
pub mod pipelines;
mod resources;

use crate::data::coat::{FinTexture, Sampled, ShellStack, Tile};
use crate::data::image::Image8;
use crate::error::{Error, Result};
use crate::gpu::{Gpu, Timer};
use crate::math::Vec2;
use crate::runtime::draw_list::{DrawList, Frame, MAX_LIGHTS, Picture, Show};
use layout::ViewUniform;
use pipelines::{COLOUR, DEPTH, EDGE_SAMPLES, Pipelines, RESOLVED, RESOLVED_DEPTH};
use resources::{GpuFur, GpuSkin, GpuTile, bind};

/// What the picture holds before it is written, so that a pixel that never is shows.
const POISON: wgpu::Color = wgpu::Color { r: f64::NAN, g: f64::NAN, b: f64::NAN, a: f64::NAN };

/// Time and memory of one pass.
#[derive(Clone, Debug, PartialEq)]
pub struct PassCost {
    /// `skin`, `far shells`, `fins`, `near shells`.
    pub name: &'static str,
    /// Device time, ms; `None` where the adapter has no clock.
    pub ms: Option<f64>,
    /// What the pass reads: geometry and textures.
    pub bytes: u64,
    /// Draw calls.
    pub draw_calls: u64,
    /// Triangles sent.
    pub triangles: u64,
}

/// A picture and what it cost.
#[derive(Clone, Debug)]
pub struct Drawn {
    /// The picture.
    pub picture: Picture,
    /// One row per pass.
    pub passes: Vec<PassCost>,
    /// Memory of the targets drawn into.
    pub target_bytes: u64,
}

/// Draws coats made of the same tiles, frame after frame.
pub struct Renderer<'a> {
    gpu: &'a Gpu,
    pipelines: Pipelines,
    samples: u32,
    tiles: Vec<GpuTile>,
    /// Stands in for a tile where skin has none.
    bare: GpuTile,
}

impl<'a> Renderer<'a> {
    /// Compiles the passes and uploads `tiles`. `samples` are those along a pixel's edge, 1 to 8.
    ///
    /// # Errors
    /// [`crate::error::Kind::Usage`] for a bad number of samples; [`crate::error::Kind::Input`] for a tile whose mips do not
    /// fit together; [`crate::error::Kind::Device`] from the device.
    pub fn new(gpu: &'a Gpu, tiles: &[Tile], samples: u32) -> Result<Self> {
        if !(1..=8).contains(&samples) {
            return Err(Error::usage("the number of samples is out of range")
                .with_field("samples along a pixel's edge")
                .with_found(samples)
                .with_expected("1 to 8"));
        }
        let pipelines = Pipelines::new(gpu, samples)?;
        let bare = GpuTile::new(gpu, &pipelines.layouts, &bare_tile())?;
        let tiles = tiles.iter().map(|tile| GpuTile::new(gpu, &pipelines.layouts, tile)).collect::<Result<_>>()?;
        Ok(Self { gpu, pipelines, samples, tiles, bare })
    }

    /// Memory of the tiles' textures, bytes.
    pub fn tile_bytes(&self) -> u64 {
        self.tiles.iter().map(|tile| tile.bytes).sum()
    }

    /// Draws one frame. The targets are cleared to transparent black.
    ///
    /// # Errors
    /// [`crate::error::Kind::Usage`] for a size the adapter cannot hold or too many lights; [`crate::error::Kind::Device`]
    /// from the device.
    pub fn draw(&self, scene: &DrawList<'_>, view: &Frame, show: Show) -> Result<Drawn> {
        if view.lights.len() > MAX_LIGHTS {
            return Err(Error::usage("too many lights")
                .with_field("--light")
                .with_found(view.lights.len())
                .with_expected(format!("at most {MAX_LIGHTS}")));
        }
        let gpu = self.gpu;
        let layouts = &self.pipelines.layouts;
        let skins = scene.skins.iter().map(|skin| GpuSkin::new(gpu, layouts, skin)).collect::<Result<Vec<_>>>()?;
        let furs: Vec<_> = scene.furs.iter().map(|fur| GpuFur::new(gpu, layouts, fur)).collect();

        let samples_size = view.size.map(|edge| edge.saturating_mul(self.samples));
        let edges = gpu.target("edge samples", samples_size, EDGE_SAMPLES, COLOUR)?;
        let depth = gpu.target("depth", samples_size, EDGE_SAMPLES, DEPTH)?;
        let colour = gpu.target("samples", samples_size, 1, COLOUR)?;
        let resolved = gpu.target("picture", view.size, 1, RESOLVED)?;
        let nearest = gpu.target("nearest", view.size, 1, RESOLVED_DEPTH)?;
        let [edges_view, depth_view, colour_view, resolved_view, nearest_view] =
            [&edges, &depth, &colour, &resolved, &nearest].map(|t| t.create_view(&Default::default()));
        let uniform = gpu.buffer("view", &[ViewUniform::new(view)], wgpu::BufferUsages::UNIFORM);
        let view_group = bind(gpu, &layouts.view, &[uniform.as_entire_binding()]);
        let samples_group =
            bind(gpu, &layouts.samples, &[&colour_view, &depth_view].map(wgpu::BindingResource::TextureView));

        let timer = Timer::new(gpu, 4);
        let mut encoder = gpu.encoder("frame");
        let mut passes = Vec::with_capacity(4);
        for (index, name) in ["skin", "far shells", "fins", "near shells"].into_iter().enumerate() {
            let clear = index == 0;
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some(name),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &edges_view,
                    depth_slice: None,
                    resolve_target: (index == 3).then_some(&colour_view),
                    ops: wgpu::Operations {
                        load: if clear { wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT) } else { wgpu::LoadOp::Load },
                        store: wgpu::StoreOp::Store,
                    },
                })],
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: &depth_view,
                    depth_ops: Some(wgpu::Operations {
                        load: if clear { wgpu::LoadOp::Clear(1.0) } else { wgpu::LoadOp::Load },
                        store: wgpu::StoreOp::Store,
                    }),
                    stencil_ops: None,
                }),
                timestamp_writes: timer.writes(index as u32),
                ..Default::default()
            });
            pass.set_bind_group(0, &view_group, &[]);
            let mut cost = PassCost { name, ms: None, bytes: 0, draw_calls: 0, triangles: 0 };
            match index {
                0 => self.draw_skins(&mut pass, &skins, show.skin, &mut cost),
                1 if show.shells => self.draw_shells(&mut pass, &furs, show, false, &mut cost),
                2 if show.fins => self.draw_fins(&mut pass, &furs, &mut cost),
                3 if show.shells => self.draw_shells(&mut pass, &furs, show, true, &mut cost),
                _ => {}
            }
            passes.push(cost);
        }
        self.resolve(&mut encoder, [&resolved_view, &nearest_view], &samples_group);
        let pixels: Vec<[f32; 4]> = gpu.read_texels(encoder, &resolved)?;
        let depths: Vec<f32> = gpu.read_texels(gpu.encoder("depth"), &nearest)?;
        if let Some(times) = timer.read_ms(gpu)? {
            passes.iter_mut().zip(times).for_each(|(pass, ms)| pass.ms = Some(ms));
        }
        let samples = u64::from(samples_size[0]) * u64::from(samples_size[1]);
        let target_bytes = samples * (u64::from(EDGE_SAMPLES) * (8 + 4) + 8) + pixels.len() as u64 * 20;
        let picture = Picture { size: view.size, pixels, depth_m: view.distances_m(&depths) };
        Ok(Drawn { picture, passes, target_bytes })
    }

    fn draw_skins(&self, pass: &mut wgpu::RenderPass<'_>, skins: &[GpuSkin], visible: bool, cost: &mut PassCost) {
        pass.set_pipeline(if visible { &self.pipelines.skin } else { &self.pipelines.skin_depth });
        for skin in skins.iter().filter(|skin| skin.index_count > 0) {
            let tile = skin.tile.map_or(&self.bare, |tile| &self.tiles[tile]);
            pass.set_bind_group(1, &tile.group, &[]);
            pass.set_bind_group(2, &skin.material, &[]);
            pass.set_vertex_buffer(0, skin.vertices.slice(..));
            pass.set_index_buffer(skin.indices.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..skin.index_count, 0, 0..1);
            cost.bytes += skin.bytes;
            cost.draw_calls += 1;
            cost.triangles += u64::from(skin.index_count / 3);
        }
    }

    /// One side of all shells, slab after slab over all furs, so that slabs of neighbouring parts interleave.
    fn draw_shells(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        furs: &[GpuFur],
        show: Show,
        near: bool,
        cost: &mut PassCost,
    ) {
        let pipelines = if near { &self.pipelines.near_shells } else { &self.pipelines.far_shells };
        pass.set_pipeline(&pipelines[usize::from(show.fins)]);
        let most = self.tiles.iter().map(|tile| tile.layers).max().unwrap_or(0);
        let inner_to_outer: Vec<u32> = (1..most).collect();
        let order: Vec<u32> = if near { inner_to_outer } else { inner_to_outer.into_iter().rev().collect() };
        let mut turn: Vec<&GpuFur> = furs.iter().collect();
        for layer in order {
            for i in (1..furs.len()).filter(|&i| furs[i].over_last) {
                let pair = [&furs[i - 1], &furs[i]];
                (turn[i - 1], turn[i]) = if layer % 2 == 0 { pair.into() } else { (pair[1], pair[0]) };
            }
            for fur in turn.iter().filter(|fur| layer < self.tiles[fur.tile].layers && fur.shell_vertices > 0) {
                pass.set_bind_group(1, &self.tiles[fur.tile].group, &[]);
                pass.set_bind_group(2, &fur.shells, &[]);
                pass.draw(0..fur.shell_vertices, layer..layer + 1);
                cost.draw_calls += 1;
                cost.triangles += u64::from(fur.shell_vertices / 3);
            }
        }
        cost.bytes = self.bytes_read(furs);
    }

    fn draw_fins(&self, pass: &mut wgpu::RenderPass<'_>, furs: &[GpuFur], cost: &mut PassCost) {
        pass.set_pipeline(&self.pipelines.fins);
        for fur in furs.iter().filter(|fur| fur.fin_vertices > 0) {
            pass.set_bind_group(1, &self.tiles[fur.tile].group, &[]);
            pass.set_bind_group(2, &fur.fins, &[]);
            pass.set_bind_group(3, &self.tiles[fur.tile].fin, &[]);
            pass.draw(0..fur.fin_vertices, 0..1);
            cost.draw_calls += 1;
            cost.triangles += u64::from(fur.fin_vertices / 3);
        }
        cost.bytes = self.bytes_read(furs);
    }

    fn bytes_read(&self, furs: &[GpuFur]) -> u64 {
        furs.iter().map(|fur| fur.bytes).chain(self.tiles.iter().map(|tile| tile.bytes)).sum()
    }

    fn resolve(&self, encoder: &mut wgpu::CommandEncoder, to: [&wgpu::TextureView; 2], samples: &wgpu::BindGroup) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("resolve"),
            color_attachments: &to.map(|view| {
                Some(wgpu::RenderPassColorAttachment {
                    view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations { load: wgpu::LoadOp::Clear(POISON), store: wgpu::StoreOp::Store },
                })
            }),
            ..Default::default()
        });
        pass.set_pipeline(&self.pipelines.resolve);
        pass.set_bind_group(0, samples, &[]);
        pass.draw(0..3, 0..1);
    }
}

/// A tile of nothing: transmittance 1 everywhere.
fn bare_tile() -> Tile {
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
            size: 1,
            gains: vec![[1.0; 9]],
            slopes: vec![Vec2::ZERO; 2],
            extinction_scales_per_m: vec![1.0],
            albedo: texel(4),
            medium: texel(4),
            ends: texel(1),
        },
        fin: FinTexture { size: [1, 1], width_m: 1.0, thickness_m: 1.0, albedo: fin.clone(), tangent: fin },
    }
}
