//! A pose on the device, ready to be drawn from anywhere in any light.

use super::bindings::bind;
use super::layout::ViewUniform;
use super::measuring::{CostPipelines, DepthPipelines};
use super::pipelines::CoatPipelines;
use super::resources::{self, GpuFur, GpuSkin, Textures};
use super::shadow_map::{GpuCasters, MAP_BYTES};
use super::targets::Targets;
use super::{Drawn, KeyShadow, PassCost, Renderer};
use crate::error::{Error, Result};
use crate::gpu::Timer;
use crate::runtime::away_from_borders;
use crate::runtime::detail::Detail;
use crate::runtime::draw_list::{Blending, DrawList, Frame, MAX_LIGHTS, Show};
use crate::runtime::order::{Item, Order, Run};
use crate::runtime::shadow_view::ShadowView;
use crate::runtime::sight::Sighted;
use bytemuck::Zeroable;
use std::cell::OnceCell;

/// Passes whose time is taken: the shadow map, and these.
const TIMED: [&str; 2] = ["coat", "skin"];

/// A posed asset on the device, and what each picture of it is drawn with.
pub struct Prepared<'a> {
    pub(super) renderer: &'a Renderer<'a>,
    skins: Vec<GpuSkin>,
    furs: Vec<GpuFur>,
    casters: GpuCasters,
    /// Of geometry and the skin's textures.
    bytes: u64,
    /// Camera and lights, written anew for each picture.
    pub(super) view: wgpu::Buffer,
    pub(super) timer: Timer,
    /// Those of the last picture, kept for the next of the same size.
    targets: Option<Targets>,
    /// Made when first asked for.
    pub(super) depths: OnceCell<DepthPipelines>,
    pub(super) costs: OnceCell<CostPipelines>,
    pub(super) depth_to_skin: OnceCell<wgpu::RenderPipeline>,
    pub(super) weighted: OnceCell<CoatPipelines>,
    pub(super) hashed: OnceCell<CoatPipelines>,
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
            .filter_map(|(fur, away_m)| GpuFur::new(gpu, layouts, (fur, &away_m), &renderer.tiles[fur.tile], &textures))
            .collect();
        let geometry =
            skins.iter().map(|skin| skin.geometry_bytes).chain(furs.iter().map(|fur| fur.bytes)).sum::<u64>();
        let map = &renderer.shadow_map;
        let casters = GpuCasters::new(gpu, map, scene, &view);
        Ok(Self {
            renderer,
            bytes: geometry + textures.bytes + casters.bytes,
            skins,
            furs,
            casters,
            view,
            timer: Timer::new(gpu, 1 + TIMED.len() as u32),
            targets: None,
            depths: OnceCell::new(),
            costs: OnceCell::new(),
            depth_to_skin: OnceCell::new(),
            weighted: OnceCell::new(),
            hashed: OnceCell::new(),
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
        self.draw_by(view, show, Blending::Sorted)
    }

    /// The same, blended in another way.
    ///
    /// # Errors
    /// As [`Self::draw`].
    pub fn draw_by(&mut self, view: &Frame, show: Show, blend: Blending) -> Result<Drawn> {
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
        let shadow = self.shadow(view);
        let uniform = ViewUniform::new(view, shadow.as_ref());
        gpu.queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&uniform));
        let order = Order::of(&self.sighted(), view, *samples, show);
        self.set(&order);
        let group = self.view_group(&order.items, &targets);
        let mut encoder = gpu.encoder("frame");
        let casters = shadow.is_some().then_some(&self.casters);
        let mut passes = vec![self.renderer.shadow_map.draw(&mut encoder, casters, self.timer.writes(0))];
        self.find_skin(&mut encoder, &targets, &group, &order.details);
        if blend == Blending::Sorted {
            passes.push(self.draw_sorted(&mut encoder, &targets, &group, &order, show));
        } else {
            passes.extend(self.draw_unsorted(&mut encoder, &targets, &group, &order, (show, blend))?);
        }
        // What was hidden is found again.
        targets.find_edges(&mut encoder, pipelines);
        if view.depths {
            let nearest = &self.depths.get_or_init(|| DepthPipelines::new(gpu, pipelines)).nearest;
            let mut pass = targets.coat_pass(&mut encoder, "depths", false, None);
            pass.set_bind_group(0, &group, &[]);
            let drawn = |fur: &GpuFur, fins: bool| (!fins).then_some(&nearest[usize::from(fur.painted)]);
            for runs in &order.pieces {
                self.draw_coat(&mut pass, runs, &order.details, drawn, &mut PassCost::default());
            }
        }
        if show.skin && blend == Blending::Sorted {
            targets.hide_skin(&mut encoder, pipelines);
            let mut pass = targets.skin_pass(&targets, &mut encoder, self.timer.writes(2));
            pass.set_bind_group(0, &group, &[]);
            passes.push(self.draw_skins(&mut pass, &pipelines.skin, &order.details));
            drop(pass);
            targets.lay_skin_under(&mut encoder, pipelines);
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
        let levels = order.details.iter().map(|detail| detail.level());
        // Of no coat the sum would be −0.
        let level = (0.0 + levels.sum::<f32>()) / order.details.len().max(1) as f32;
        Ok(Drawn { picture, passes, target_bytes, level, height_px: order.height_px, shadow })
    }

    /// Draws the coat from front to back.
    fn draw_sorted(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        targets: &Targets,
        group: &wgpu::BindGroup,
        order: &Order,
        show: Show,
    ) -> PassCost {
        let pipelines = &self.renderer.pipelines;
        let drawn = |fur: &GpuFur, fins: bool| Some(pipelines.coat.of(fins, fur.painted, show.fins));
        let mut coat = self.coat_cost();
        for (number, runs) in order.pieces.iter().enumerate() {
            let (first, last) = (number == 0, number + 1 == order.pieces.len());
            let mut pass = targets.coat_pass(encoder, TIMED[0], first, self.timer.spanning(1, first, last));
            pass.set_bind_group(0, group, &[]);
            self.draw_coat(&mut pass, runs, &order.details, drawn, &mut coat);
            drop(pass);
            targets.hide_coat(encoder, pipelines);
        }
        coat
    }

    /// What drawing the coats reads, before anything is drawn.
    pub(super) fn coat_cost(&self) -> PassCost {
        PassCost { name: TIMED[0], bytes: self.bytes_read(), ..PassCost::default() }
    }

    /// The key light's map, where it is asked for and holds what it should.
    pub(super) fn shadow(&self, view: &Frame) -> Option<ShadowView> {
        let key = view.lights.first().filter(|_| view.shadow_map);
        key.and_then(|light| ShadowView::of(light, &self.casters.extent))
    }

    /// Sets what of each coat is drawn next.
    pub(super) fn set(&self, order: &Order) {
        self.furs.iter().zip(&order.details).for_each(|(fur, &detail)| fur.set(self.renderer.gpu, detail));
    }

    pub(super) fn sighted(&self) -> Vec<&Sighted> {
        self.furs.iter().map(|fur| &fur.sighted).collect()
    }

    /// Group 0 of a picture that draws `items`.
    pub(super) fn view_group(&self, items: &[Item], targets: &Targets) -> wgpu::BindGroup {
        let Renderer { gpu, pipelines, shadow_map, .. } = self.renderer;
        let none = [Item::zeroed()];
        let items = if items.is_empty() { &none } else { items };
        let items = gpu.buffer("items", items, wgpu::BufferUsages::STORAGE);
        let resources = [
            self.view.as_entire_binding(),
            wgpu::BindingResource::Sampler(&shadow_map.sampler),
            wgpu::BindingResource::TextureView(&shadow_map.view),
            items.as_entire_binding(),
            wgpu::BindingResource::TextureView(&targets.edges),
        ];
        bind(gpu, &pipelines.layouts.view, &resources)
    }

    /// The finest level of a tile that any coat shows.
    fn finest(&self, tile: usize, details: &[Detail]) -> usize {
        let shown = self.furs.iter().zip(details).filter(|(fur, _)| fur.tile == tile);
        shown.filter_map(|(_, detail)| detail.levels().map(|(level, _)| level).min()).min().unwrap_or(0)
    }

    /// Finds the skin's depths and edges, which the coat is drawn over.
    pub(super) fn find_skin(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        targets: &Targets,
        group: &wgpu::BindGroup,
        details: &[Detail],
    ) {
        let pipelines = &self.renderer.pipelines;
        let mut pass = targets.depth_pass(encoder);
        pass.set_bind_group(0, group, &[]);
        self.draw_skins(&mut pass, &pipelines.skin_depth, details);
        drop(pass);
        targets.find_edges(encoder, pipelines);
    }

    /// All skins by `pipeline`, under the coats' levels.
    pub(super) fn draw_skins(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        pipeline: &wgpu::RenderPipeline,
        details: &[Detail],
    ) -> PassCost {
        let mut cost = PassCost { name: TIMED[1], ..PassCost::default() };
        pass.set_pipeline(pipeline);
        for skin in &self.skins {
            let tile =
                skin.tile.map_or(&self.renderer.bare, |tile| &self.renderer.tiles[tile][self.finest(tile, details)]);
            pass.set_bind_group(1, &tile.groups[0], &[]);
            pass.set_bind_group(2, &skin.material, &[]);
            pass.set_vertex_buffer(0, skin.vertices.slice(..));
            pass.set_index_buffer(skin.indices.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..skin.index_count, 0, 0..1);
            cost.bytes += skin.bytes;
            cost.draw_calls += 1;
            cost.triangles += u64::from(skin.index_count / 3);
        }
        cost
    }

    /// Each of `runs` by the pipeline that `drawn` has for its coat and for whether it is fins, if any; added to `cost`.
    pub(super) fn draw_coat<'p>(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        runs: &[Run],
        details: &[Detail],
        drawn: impl Fn(&GpuFur, bool) -> Option<&'p wgpu::RenderPipeline>,
        cost: &mut PassCost,
    ) {
        for run in runs {
            let fur = &self.furs[run.fur];
            let tile = &self.renderer.tiles[fur.tile][run.level];
            let Some(pipeline) = drawn(fur, run.fins) else { continue };
            pass.set_pipeline(pipeline);
            pass.set_bind_group(1, &tile.groups[run.look], &[]);
            pass.set_bind_group(
                2,
                if run.fins { &fur.fins } else { &fur.shells[details[run.fur].turn(run.level)] },
                &[],
            );
            if run.fins {
                pass.set_bind_group(3, &tile.fin, &[]);
            }
            // A fin has two triangles.
            let corners = if run.fins { 6 } else { 3 };
            pass.draw(corners * run.items.start..corners * run.items.end, 0..1);
            cost.draw_calls += 1;
            cost.triangles += u64::from(corners / 3) * run.items.len() as u64;
        }
    }

    fn bytes_read(&self) -> u64 {
        self.furs.iter().map(|fur| fur.bytes).chain(self.renderer.tiles.iter().flatten().map(|tile| tile.bytes)).sum()
    }
}
