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
use crate::runtime::shadow_view::ShadowView;

/// By which pipeline a coat is drawn, and its fins.
type Drawn<'p> = dyn Fn(&GpuFur, bool) -> &'p wgpu::RenderPipeline + 'p;

impl Prepared<'_> {
    /// What a picture costs, as a picture: red is how many fragments a pixel runs, green how many texels they read. An anisotropic sampler
    /// counts as many as it may take; taps that are placed by hand, and those of the shadow map, count each.
    ///
    /// # Errors
    /// As [`Self::draw`].
    pub fn cost(&mut self, view: &Frame, show: Show) -> Result<Picture> {
        let Renderer { gpu, pipelines, samples, .. } = self.renderer;
        let costs = self.costs.get_or_init(|| CostPipelines::new(gpu, pipelines));
        let order = Order::of(&self.sighted(), view, *samples, show);
        let skin = if show.skin { &costs.skin } else { &pipelines.skin_depth };
        let shells = &costs.shells[usize::from(show.fins)];
        let counted = |fur: &GpuFur, fins: bool| if fins { &costs.fins } else { &shells[usize::from(fur.painted)] };
        self.measured(view, self.shadow(view).as_ref(), skin, &[(order, &counted)])
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
        self.measured(view, None, &pipelines.skin_depth, &[(skin, &|_, _| expected), (coat, &|_, _| slabs)])
    }

    /// A picture of what `skin` and then each order add up, drawn by its own pipelines.
    fn measured(
        &self,
        view: &Frame,
        shadow: Option<&ShadowView>,
        skin: &wgpu::RenderPipeline,
        orders: &[(Order, &Drawn<'_>)],
    ) -> Result<Picture> {
        let Renderer { gpu, pipelines, samples, .. } = self.renderer;
        let targets = Targets::new(gpu, pipelines, view.size, *samples)?;
        gpu.queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&ViewUniform::new(view, shadow)));
        // All show the same levels.
        orders.iter().for_each(|(order, _)| self.set(order));
        let groups: Vec<_> = orders.iter().map(|(order, _)| self.view_group(&order.items, &targets)).collect();
        let mut encoder = gpu.encoder("measured");
        let mut pass = targets.skin_pass(&mut encoder, None);
        pass.set_bind_group(0, &groups[0], &[]);
        self.draw_skins(&mut pass, skin, &orders[0].0.details);
        drop(pass);
        targets.find_edges(&mut encoder, pipelines);
        let mut pass = targets.coat_pass(&mut encoder, "measured", None);
        for ((order, drawn), group) in orders.iter().zip(&groups) {
            pass.set_bind_group(0, group, &[]);
            self.draw_coat(&mut pass, order, |fur, fins| Some(drawn(fur, fins)));
        }
        drop(pass);
        targets.resolve(&mut encoder, pipelines);
        gpu.finish(encoder)?;
        targets.picture(gpu, view)
    }
}
