//! Coats drawn without an order.

use super::pipelines::CoatPipelines;
use super::prepared::Prepared;
use super::targets::{Targets, attachment};
use super::unsorted::{self, Sums};
use super::{PassCost, Renderer};
use crate::error::Result;
use crate::runtime::draw_list::{Blending, Show};
use crate::runtime::order::Order;

impl Prepared<'_> {
    /// Draws a coat without an order, and the skin where it is shown; what both cost.
    ///
    /// # Errors
    /// As [`Gpu::target`].
    pub(super) fn draw_unsorted(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        targets: &Targets,
        group: &wgpu::BindGroup,
        order: &Order,
        (show, blend): (Show, Blending),
    ) -> Result<[PassCost; 2]> {
        let Renderer { gpu, pipelines, samples, .. } = self.renderer;
        let mut coat = self.coat_cost();
        let mut skin = PassCost { name: "skin", ..PassCost::default() };
        let mut draw_skin = |encoder: &mut wgpu::CommandEncoder| {
            let mut pass = targets.skin_pass(targets, encoder, self.timer.writes(2));
            pass.set_bind_group(0, group, &[]);
            if show.skin {
                skin = self.draw_skins(&mut pass, &pipelines.skin, &order.details);
            }
        };
        let mut draw_coat = |mut pass: wgpu::RenderPass<'_>, by: &CoatPipelines| {
            pass.set_bind_group(0, group, &[]);
            for runs in &order.pieces {
                self.draw_coat(
                    &mut pass,
                    runs,
                    &order.details,
                    |fur, fins| Some(by.of(fins, fur.painted, show.fins)),
                    &mut coat,
                );
            }
        };
        if blend == Blending::Hashed {
            let hashed = self.hashed.get_or_init(|| unsorted::hashed(gpu, pipelines));
            draw_coat(targets.coat_pass(encoder, "hashed", true, self.timer.writes(1)), hashed);
            targets.hide_skin(encoder, pipelines);
            draw_skin(encoder);
            targets.lay_skin_under(encoder, pipelines);
            return Ok([coat, skin]);
        }
        draw_skin(encoder);
        let weighted = self.weighted.get_or_init(|| unsorted::weighted(gpu, pipelines));
        let sums = Sums::new(gpu, pipelines, targets, *samples)?;
        let cleared = |view, colour| Some(attachment(view, wgpu::LoadOp::Clear(colour)));
        let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("weighted"),
            color_attachments: &[
                cleared(&sums.sums, wgpu::Color::TRANSPARENT),
                cleared(&sums.passed, wgpu::Color::WHITE),
            ],
            depth_stencil_attachment: Some(targets.coat_depth()),
            timestamp_writes: self.timer.writes(1),
            ..Default::default()
        });
        draw_coat(pass, weighted);
        let mut pass = targets.coat_pass(encoder, "weighed", true, None);
        pass.set_pipeline(&pipelines.weighed);
        pass.set_bind_group(0, &sums.group, &[]);
        pass.draw(0..3, 0..1);
        drop(pass);
        Ok([coat, skin])
    }
}
