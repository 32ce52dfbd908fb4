//! A pose on the device, ready to be drawn from anywhere in any light.

use super::layout::ViewUniform;
use super::pipelines::DepthPipelines;
use super::resources::{self, GpuFur, GpuSkin, Textures};
use super::shadow_map::{GpuCasters, MAP_BYTES};
use super::targets::Targets;
use super::{Drawn, KeyShadow, PassCost, Renderer};
use crate::error::{Error, Result};
use crate::gpu::Timer;
use crate::runtime::away_from_borders;
use crate::runtime::draw_list::{DrawList, Frame, MAX_LIGHTS, Picture, Show};
use crate::runtime::shadow_view::ShadowView;
use bytemuck::Zeroable;

/// The passes in the order drawn, after that of the shadow map.
const PASSES: [&str; 4] = ["skin", "far shells", "fins", "near shells"];

/// A posed asset on the device, and what each picture of it is drawn with.
pub struct Prepared<'a> {
    renderer: &'a Renderer<'a>,
    skins: Vec<GpuSkin>,
    furs: Vec<GpuFur>,
    casters: GpuCasters,
    /// Of geometry and the skin's textures.
    bytes: u64,
    /// Camera and lights, written anew for each picture.
    view: wgpu::Buffer,
    view_group: wgpu::BindGroup,
    timer: Timer,
    /// Those of the last picture, kept for the next of the same size.
    targets: Option<Targets>,
    /// Made when first asked for.
    depths: Option<DepthPipelines>,
}

impl<'a> Prepared<'a> {
    pub(super) fn new(renderer: &'a Renderer<'a>, scene: &DrawList<'_>) -> Result<Self> {
        let (gpu, layouts) = (renderer.gpu, &renderer.pipelines.layouts);
        let view = gpu.buffer("view", &[ViewUniform::zeroed()], wgpu::BufferUsages::UNIFORM);
        let mut textures = Textures::new();
        for skin in scene.skins.iter().filter(|skin| !skin.triangles.is_empty()) {
            textures.add(gpu, skin.texture, true)?;
            textures.add(gpu, skin.painted, false)?;
        }
        for fur in &scene.furs {
            textures.add(gpu, fur.colour, true)?;
            textures.add(gpu, fur.painted, false)?;
        }
        let skins = resources::skins(gpu, layouts, &scene.skins, &textures);
        let furs: Vec<_> = scene
            .furs
            .iter()
            .zip(away_from_borders(&scene.furs))
            .filter_map(|(fur, away_m)| {
                GpuFur::new(gpu, layouts, (fur, &away_m), renderer.tiles[fur.tile].fin_thickness_m, &textures)
            })
            .collect();
        let geometry =
            skins.iter().map(|skin| skin.geometry_bytes).chain(furs.iter().map(|fur| fur.bytes)).sum::<u64>();
        let map = &renderer.shadow_map;
        let casters = GpuCasters::new(gpu, map, scene, &view);
        let of_view = [
            view.as_entire_binding(),
            wgpu::BindingResource::Sampler(&map.sampler),
            wgpu::BindingResource::TextureView(&map.view),
        ];
        let view_group = resources::bind(gpu, &layouts.view, &of_view);
        Ok(Self {
            renderer,
            bytes: geometry + textures.bytes + casters.bytes,
            skins,
            furs,
            casters,
            view_group,
            view,
            timer: Timer::new(gpu, 1 + PASSES.len() as u32),
            targets: None,
            depths: None,
        })
    }

    /// Memory of geometry and the skin's textures, bytes.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Draws one picture. It is cleared to transparent black.
    ///
    /// # Errors
    /// [`crate::error::Kind::Usage`] for a size the adapter cannot hold or too many lights; [`crate::error::Kind::Device`]
    /// from the device.
    pub fn draw(&mut self, view: &Frame, show: Show) -> Result<Drawn> {
        if view.lights.len() > MAX_LIGHTS {
            return Err(Error::usage("too many lights")
                .with_parameter("light")
                .with_found(view.lights.len())
                .with_expected(format!("at most {MAX_LIGHTS}")));
        }
        let Renderer { gpu, pipelines, samples, .. } = self.renderer;
        let targets = match self.targets.take().filter(|targets| targets.size == view.size) {
            Some(targets) => targets,
            None => Targets::new(gpu, pipelines, view.size, *samples)?,
        };
        let key = view.lights.first().filter(|_| view.shadow_map);
        let shadow = key.and_then(|light| ShadowView::of(light, &self.casters.extent));
        let uniform = ViewUniform::new(view, shadow.as_ref());
        gpu.queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&uniform));
        let mut encoder = gpu.encoder("frame");
        let casters = shadow.is_some().then_some(&self.casters);
        let mut passes = vec![self.renderer.shadow_map.draw(&mut encoder, casters, self.timer.writes(0))];
        for (index, name) in PASSES.into_iter().enumerate() {
            let mut pass = targets.pass(&mut encoder, name, index, self.timer.writes(1 + index as u32));
            pass.set_bind_group(0, &self.view_group, &[]);
            let mut cost = PassCost { name, ms: None, bytes: 0, draw_calls: 0, triangles: 0 };
            match index {
                0 => self.draw_skins(&mut pass, show.skin, &mut cost),
                1 if show.shells => self.draw_shells(&mut pass, show, false, &mut cost),
                2 if show.fins => self.draw_fins(&mut pass, &mut cost),
                3 if show.shells => self.draw_shells(&mut pass, show, true, &mut cost),
                _ => {}
            }
            passes.push(cost);
        }
        targets.resolve(&mut encoder, pipelines);
        self.timer.stop(&mut encoder);
        gpu.finish(encoder)?;
        let picture = targets.picture(gpu, view)?;
        if let Some(times) = self.timer.read_ms(gpu)? {
            passes.iter_mut().zip(times).for_each(|(pass, ms)| pass.ms = Some(ms));
        }
        let target_bytes = targets.bytes + MAP_BYTES;
        self.targets = Some(targets);
        let shadow = match (key, shadow) {
            (None, _) => KeyShadow::Off,
            (Some(_), Some(ShadowView { guests_reach, .. })) => KeyShadow::Cast { guests_reach },
            (Some(_), None) => KeyShadow::TooNear,
        };
        Ok(Drawn { picture, passes, target_bytes, shadow })
    }

    /// How much hair lies over the skin, as a picture: red is the mean optical depth that all near shells have at a pixel, green
    /// what they would have on a plane there, at most 4 (red: 4 each slab); blue is 1 where furred skin is seen and nothing before it.
    ///
    /// # Errors
    /// As [`Self::draw`].
    pub fn hair_over_skin(&mut self, view: &Frame) -> Result<Picture> {
        let Renderer { gpu, pipelines, samples, .. } = self.renderer;
        let targets = Targets::new(gpu, pipelines, view.size, *samples)?;
        let depths = self.depths.take().unwrap_or_else(|| DepthPipelines::new(gpu, pipelines));
        gpu.queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&ViewUniform::new(view, None)));
        let mut encoder = gpu.encoder("hair over skin");
        for (index, name) in PASSES.into_iter().enumerate() {
            let mut pass = targets.pass(&mut encoder, name, index, None);
            pass.set_bind_group(0, &self.view_group, &[]);
            let layers = |fur: &GpuFur| match index {
                1 => 0..1,
                _ => 1..self.renderer.tiles[fur.tile].layers,
            };
            match index {
                0 => {
                    let mut cost = PassCost { name, ms: None, bytes: 0, draw_calls: 0, triangles: 0 };
                    self.draw_skins(&mut pass, false, &mut cost);
                    continue;
                }
                1 => pass.set_pipeline(&depths.expected),
                3 => pass.set_pipeline(&depths.slabs),
                _ => continue,
            }
            for fur in self.furs.iter().filter(|fur| fur.shell_vertices > 0) {
                pass.set_bind_group(1, &self.renderer.tiles[fur.tile].group, &[]);
                pass.set_bind_group(2, &fur.shells, &[]);
                pass.draw(0..fur.shell_vertices, layers(fur));
            }
        }
        targets.resolve(&mut encoder, pipelines);
        self.depths = Some(depths);
        gpu.finish(encoder)?;
        targets.picture(gpu, view)
    }

    fn draw_skins(&self, pass: &mut wgpu::RenderPass<'_>, visible: bool, cost: &mut PassCost) {
        pass.set_pipeline(if visible { &self.renderer.pipelines.skin } else { &self.renderer.pipelines.skin_depth });
        for skin in &self.skins {
            let tile = skin.tile.map_or(&self.renderer.bare, |tile| &self.renderer.tiles[tile]);
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
    fn draw_shells(&self, pass: &mut wgpu::RenderPass<'_>, show: Show, near: bool, cost: &mut PassCost) {
        let furs = &self.furs;
        let pipelines = if near { &self.renderer.pipelines.near_shells } else { &self.renderer.pipelines.far_shells };
        let pipelines = &pipelines[usize::from(show.fins)];
        let mut set = None;
        let most = self.renderer.tiles.iter().map(|tile| tile.layers).max().unwrap_or(0);
        let inner_to_outer: Vec<u32> = (1..most).collect();
        let order: Vec<u32> = if near { inner_to_outer } else { inner_to_outer.into_iter().rev().collect() };
        let mut turn: Vec<&GpuFur> = furs.iter().collect();
        for layer in order {
            for i in (1..furs.len()).filter(|&i| furs[i].over_last) {
                let pair = [&furs[i - 1], &furs[i]];
                (turn[i - 1], turn[i]) = if layer % 2 == 0 { pair.into() } else { (pair[1], pair[0]) };
            }
            for fur in turn.iter().filter(|fur| layer < self.renderer.tiles[fur.tile].layers && fur.shell_vertices > 0)
            {
                if set.replace(fur.painted) != Some(fur.painted) {
                    pass.set_pipeline(&pipelines[usize::from(fur.painted)]);
                }
                pass.set_bind_group(1, &self.renderer.tiles[fur.tile].group, &[]);
                pass.set_bind_group(2, &fur.shells, &[]);
                pass.draw(0..fur.shell_vertices, layer..layer + 1);
                cost.draw_calls += 1;
                cost.triangles += u64::from(fur.shell_vertices / 3);
            }
        }
        cost.bytes = self.bytes_read();
    }

    fn draw_fins(&self, pass: &mut wgpu::RenderPass<'_>, cost: &mut PassCost) {
        pass.set_pipeline(&self.renderer.pipelines.fins);
        for fur in self.furs.iter().filter(|fur| fur.fin_vertices > 0) {
            pass.set_bind_group(1, &self.renderer.tiles[fur.tile].group, &[]);
            pass.set_bind_group(2, &fur.fins, &[]);
            pass.set_bind_group(3, &self.renderer.tiles[fur.tile].fin, &[]);
            pass.draw(0..fur.fin_vertices, 0..1);
            cost.draw_calls += 1;
            cost.triangles += u64::from(fur.fin_vertices / 3);
        }
        cost.bytes = self.bytes_read();
    }

    fn bytes_read(&self) -> u64 {
        self.furs.iter().map(|fur| fur.bytes).chain(self.renderer.tiles.iter().map(|tile| tile.bytes)).sum()
    }
}
