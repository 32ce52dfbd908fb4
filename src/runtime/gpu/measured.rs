//! What is measured of a picture instead of drawn.

use super::Renderer;
use super::layout::ViewUniform;
use super::pipelines::{CostPipelines, DepthPipelines};
use super::prepared::Prepared;
use super::resources::GpuFur;
use super::targets::Targets;
use crate::error::Result;
use crate::runtime::draw_list::{Frame, Picture, Show};
use crate::runtime::order::Order;

impl Prepared<'_> {
    /// What a picture costs, as a picture: red is how many fragments a pixel runs, green how many texels they read. An anisotropic sampler
    /// counts as many as it may take; taps that are placed by hand, and those of the shadow map, count each.
    ///
    /// # Errors
    /// As [`Self::draw`].
    pub fn cost(&mut self, view: &Frame, show: Show) -> Result<Picture> {
        let Renderer { gpu, pipelines, samples, .. } = self.renderer;
        let targets = Targets::new(gpu, pipelines, view.size, *samples)?;
        let costs = self.costs.get_or_init(|| CostPipelines::new(gpu, pipelines));
        let uniform = ViewUniform::new(view, self.shadow(view).as_ref());
        gpu.queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&uniform));
        let order = Order::of(&self.sighted(), view, *samples, show);
        let group = self.view_group(&order.items, &targets);
        let mut encoder = gpu.encoder("cost");
        let mut pass = targets.skin_pass(&mut encoder, None);
        pass.set_bind_group(0, &group, &[]);
        self.draw_skins(&mut pass, if show.skin { &costs.skin } else { &pipelines.skin_depth });
        drop(pass);
        targets.find_edges(&mut encoder, pipelines);
        let mut pass = targets.coat_pass(&mut encoder, "coat", None);
        pass.set_bind_group(0, &group, &[]);
        let shells = &costs.shells[usize::from(show.fins)];
        let counted =
            |fur: &GpuFur, fins: bool| Some(if fins { &costs.fins } else { &shells[usize::from(fur.painted)] });
        self.draw_coat(&mut pass, &order, counted);
        drop(pass);
        targets.resolve(&mut encoder, pipelines);
        gpu.finish(encoder)?;
        targets.picture(gpu, view)
    }

    /// How much hair lies over the skin, as a picture: red is the mean optical depth that all near shells have at a pixel, green
    /// what they would have on a plane there, at most 4 (red: 4 each slab); blue is 1 where furred skin is seen and nothing before it.
    ///
    /// # Errors
    /// As [`Self::draw`].
    pub fn hair_over_skin(&mut self, view: &Frame) -> Result<Picture> {
        let Renderer { gpu, pipelines, samples, .. } = self.renderer;
        let targets = Targets::new(gpu, pipelines, view.size, *samples)?;
        let depths = self.depths.get_or_init(|| DepthPipelines::new(gpu, pipelines));
        let (expected, slabs) = (&depths.expected, &depths.slabs);
        gpu.queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&ViewUniform::new(view, None)));
        let mut encoder = gpu.encoder("hair over skin");
        let orders = [true, false].map(|skin| Order::all(&self.sighted(), view, *samples, skin));
        let groups = orders.each_ref().map(|order| self.view_group(&order.items, &targets));
        let mut pass = targets.skin_pass(&mut encoder, None);
        pass.set_bind_group(0, &groups[0], &[]);
        self.draw_skins(&mut pass, &pipelines.skin_depth);
        drop(pass);
        targets.find_edges(&mut encoder, pipelines);
        let mut pass = targets.coat_pass(&mut encoder, "hair", None);
        for ((order, group), pipeline) in orders.iter().zip(&groups).zip([expected, slabs]) {
            pass.set_bind_group(0, group, &[]);
            self.draw_coat(&mut pass, order, |_, _| Some(pipeline));
        }
        drop(pass);
        targets.resolve(&mut encoder, pipelines);
        gpu.finish(encoder)?;
        targets.picture(gpu, view)
    }
}
