//! What is measured of a picture instead of drawn.

use super::layout::ViewUniform;
use super::measuring::{self, CostPipelines, DepthPipelines};
use super::prepared::Prepared;
use super::resources::GpuFur;
use super::targets::Targets;
use super::unsorted;
use super::{PassCost, Renderer};
use crate::error::Result;
use crate::runtime::detail::Detail;
use crate::runtime::draw_list::{Blending, Frame, Picture, Show};
use crate::runtime::order::Order;
use crate::runtime::sight::{Eye, Sighted};

impl Prepared<'_> {
    /// What a picture costs, as a picture: red is how many fragments a pixel runs, green how many texels they read. An anisotropic sampler
    /// counts as many as it may take; taps that are placed by hand, and those of the shadow map, count each.
    ///
    /// # Errors
    /// As [`Self::draw`].
    pub fn cost(&mut self, view: &Frame, show: Show, blend: Blending) -> Result<Picture> {
        let Renderer { gpu, pipelines, samples, .. } = self.renderer;
        let costs = self.costs.get_or_init(|| CostPipelines::new(gpu, pipelines));
        let order = Order::of(&self.sighted(), view, *samples, show);
        let targets = || Targets::new(gpu, pipelines, view.size, *samples);
        let (targets, counted) = (targets()?, targets()?);
        gpu.queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&ViewUniform::new(view, self.shadow(view).as_ref())));
        self.set(&order);
        let group = self.view_group(&order.items, &targets);
        let mut encoder = gpu.encoder("cost");
        self.find_skin(&mut encoder, &targets, &group, &order.details);
        let drawn = match blend {
            Blending::Hashed => self.hashed.get_or_init(|| unsorted::hashed(gpu, pipelines)),
            Blending::Sorted | Blending::Weighted => &pipelines.coat,
        };
        // Each piece is counted and drawn with the same depths, so that what is hidden by then counts for nothing.
        for (number, runs) in order.pieces.iter().enumerate() {
            for (into, by) in [(&counted, &costs.coat), (&targets, drawn)] {
                let mut pass = into.coat_pass_before(&targets, &mut encoder, "cost", number == 0, None);
                pass.set_bind_group(0, &group, &[]);
                let by = |fur: &GpuFur, fins| Some(by.of(fins, fur.painted, show.fins));
                self.draw_coat(&mut pass, runs, &order.details, by, &mut PassCost::default());
            }
            if blend == Blending::Sorted {
                targets.hide_coat(&mut encoder, pipelines);
            }
        }
        if show.skin {
            if blend != Blending::Weighted {
                targets.hide_skin(&mut encoder, pipelines);
            }
            let mut pass = counted.skin_pass(&targets, &mut encoder, None);
            pass.set_bind_group(0, &group, &[]);
            self.draw_skins(&mut pass, &costs.skin, &order.details);
            drop(pass);
            counted.lay_skin_under(&mut encoder, pipelines);
        }
        counted.resolve(&mut encoder, pipelines);
        gpu.finish(encoder)?;
        counted.picture(gpu, view)
    }

    /// How much hair lies over the skin, as a picture: red is the mean optical depth that all near shells have at a pixel, green
    /// what they would have on a plane there, at most 4 (red: 4 each slab); blue is 1 where furred skin is seen and nothing before it.
    ///
    /// # Errors
    /// As [`Self::draw`].
    pub fn hair_over_skin(&mut self, view: &Frame) -> Result<Picture> {
        let Renderer { gpu, pipelines, samples, .. } = self.renderer;
        let DepthPipelines { expected, slabs, .. } = self.depths.get_or_init(|| DepthPipelines::new(gpu, pipelines));
        let [skin, coat] = [true, false].map(|skin| Order::all(&self.sighted(), view, *samples, skin));
        let targets = Targets::new(gpu, pipelines, view.size, *samples)?;
        gpu.queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&ViewUniform::new(view, None)));
        // Both show the same levels.
        self.set(&skin);
        let [over, there] = [&skin, &coat].map(|order| self.view_group(&order.items, &targets));
        let mut encoder = gpu.encoder("hair over skin");
        self.find_skin(&mut encoder, &targets, &over, &skin.details);
        let mut pass = targets.coat_pass(&mut encoder, "hair over skin", true, None);
        for (order, drawn, group) in [(&skin, expected, &over), (&coat, slabs, &there)] {
            pass.set_bind_group(0, group, &[]);
            for runs in &order.pieces {
                self.draw_coat(&mut pass, runs, &order.details, |_, _| Some(drawn), &mut PassCost::default());
            }
        }
        drop(pass);
        targets.resolve(&mut encoder, pipelines);
        gpu.finish(encoder)?;
        targets.picture(gpu, view)
    }

    /// How much hair shadows the skin, as a picture of the skin: red is the optical depth that light from 45 degrees to upright hair meets
    /// on its way to it, as the skin is shaded by, but however much it is; green is 1 where there is hair.
    ///
    /// # Errors
    /// As [`Self::draw`].
    pub fn depth_to_skin(&mut self, view: &Frame) -> Result<Picture> {
        let Renderer { gpu, pipelines, samples, .. } = self.renderer;
        let drawn = self.depth_to_skin.get_or_init(|| measuring::depth_to_skin(gpu, pipelines));
        let targets = Targets::new(gpu, pipelines, view.size, *samples)?;
        gpu.queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&ViewUniform::new(view, None)));
        let details: Vec<Detail> = self.levels(view).into_iter().map(|(detail, _)| detail).collect();
        let group = self.view_group(&[], &targets);
        let mut encoder = gpu.encoder("depth to skin");
        self.find_skin(&mut encoder, &targets, &group, &details);
        // Nothing is before the skin.
        drop(targets.coat_pass(&mut encoder, "no coat", true, None));
        let mut pass = targets.skin_pass(&targets, &mut encoder, None);
        pass.set_bind_group(0, &group, &[]);
        self.draw_skins(&mut pass, drawn, &details);
        drop(pass);
        targets.lay_skin_under(&mut encoder, pipelines);
        targets.resolve(&mut encoder, pipelines);
        gpu.finish(encoder)?;
        targets.picture(gpu, view)
    }

    /// Of each coat, in the scene's order: which levels a picture shows of it, and how high its longest hair is there, pixels.
    pub fn levels(&self, view: &Frame) -> Vec<(Detail, f32)> {
        let eye = Eye::of(view, self.renderer.samples);
        let of = |fur: &Sighted| {
            let height_px = fur.height_px(&eye);
            (fur.detail(height_px, view.level), height_px)
        };
        self.sighted().into_iter().map(of).collect()
    }
}
