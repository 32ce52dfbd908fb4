//! What pictures of one size are drawn into, and the way back to the host.

use super::bindings::bind;
use super::pipelines::{COLOUR, DEPTH, EDGE, EDGE_SAMPLES, Pipelines, RESOLVED, RESOLVED_DEPTH};
use crate::error::Result;
use crate::gpu::{Gpu, ReadBack};
use crate::runtime::draw_list::{Frame, Picture};

/// What the picture holds before it is written, so that a pixel that never is shows.
const POISON: wgpu::Color = wgpu::Color { r: f64::NAN, g: f64::NAN, b: f64::NAN, a: f64::NAN };

/// The skin's colour and depth at a pixel's edge samples, all else once per shading sample, and the finished picture with its depths.
pub(super) struct Targets {
    /// Pixels: width, height.
    pub size: [u32; 2],
    /// Memory of all, bytes.
    pub bytes: u64,
    /// The skin's edges, for coats to read.
    pub edges: wgpu::TextureView,
    skin_samples: wgpu::TextureView,
    pub skin: wgpu::TextureView,
    skin_group: wgpu::BindGroup,
    skin_depth: wgpu::TextureView,
    skin_depth_group: wgpu::BindGroup,
    samples: wgpu::TextureView,
    coat_group: wgpu::BindGroup,
    depth: wgpu::TextureView,
    samples_group: wgpu::BindGroup,
    picture: Finished<[f32; 4]>,
    nearest: Finished<f32>,
}

/// What comes back of a picture.
struct Finished<T> {
    texture: wgpu::Texture,
    view: wgpu::TextureView,
    read_back: ReadBack<T>,
}

impl<T: bytemuck::Pod> Finished<T> {
    fn new(gpu: &Gpu, label: &str, size: [u32; 2], format: wgpu::TextureFormat) -> Result<Self> {
        let texture = gpu.target(label, size, 1, format)?;
        Ok(Self { view: texture.create_view(&Default::default()), read_back: gpu.read_back(&texture), texture })
    }
}

impl Targets {
    /// For pictures of `size` with `samples`² shading samples per pixel.
    ///
    /// # Errors
    /// As [`Gpu::target`].
    pub fn new(gpu: &Gpu, pipelines: &Pipelines, size: [u32; 2], samples: u32) -> Result<Self> {
        let sampled = size.map(|edge| edge.saturating_mul(samples));
        let target = |label, samples, format| -> Result<wgpu::TextureView> {
            Ok(gpu.target(label, sampled, samples, format)?.create_view(&Default::default()))
        };
        let skin_samples = target("skin samples", EDGE_SAMPLES, COLOUR)?;
        let skin = target("skin", 1, COLOUR)?;
        let skin_depth = target("skin depth", EDGE_SAMPLES, DEPTH)?;
        let edges = target("edges", 1, EDGE)?;
        let samples = target("samples", 1, COLOUR)?;
        let depth = target("depth", 1, DEPTH)?;
        let resource = wgpu::BindingResource::TextureView;
        let skin_depth_group = bind(gpu, &pipelines.layouts.depths, &[resource(&skin_depth)]);
        let [skin_group, coat_group] =
            [&skin, &samples].map(|texels| bind(gpu, &pipelines.layouts.texels, &[resource(texels)]));
        let samples_group = bind(gpu, &pipelines.layouts.samples, &[&samples, &depth, &edges].map(resource));
        let area = |size: [u32; 2]| u64::from(size[0]) * u64::from(size[1]);
        let bytes = area(sampled) * (u64::from(EDGE_SAMPLES) * (8 + 4) + 8 + 8 + 8 + 4) + area(size) * (16 + 4);
        let picture = Finished::new(gpu, "picture", size, RESOLVED)?;
        let nearest = Finished::new(gpu, "nearest", size, RESOLVED_DEPTH)?;
        Ok(Self {
            size,
            bytes,
            edges,
            skin_samples,
            skin,
            skin_group,
            skin_depth,
            skin_depth_group,
            samples,
            coat_group,
            depth,
            samples_group,
            picture,
            nearest,
        })
    }

    /// Begins the pass of the skin's depths, from nothing.
    pub fn depth_pass<'e>(&self, encoder: &'e mut wgpu::CommandEncoder) -> wgpu::RenderPass<'e> {
        begin(encoder, "skin depth", None, (&self.skin_depth, wgpu::LoadOp::Clear(1.0)), None)
    }

    /// Finds what the skin leaves of each pixel.
    pub fn find_edges(&self, encoder: &mut wgpu::CommandEncoder, pipelines: &Pipelines) {
        let edges = attachment(&self.edges, wgpu::LoadOp::Clear(wgpu::Color::BLACK));
        let mut pass = begin(encoder, "edges", Some(edges), (&self.depth, wgpu::LoadOp::Clear(1.0)), None);
        pass.set_pipeline(&pipelines.edges);
        pass.set_bind_group(0, &self.skin_depth_group, &[]);
        pass.draw(0..3, 0..1);
    }

    /// Begins a pass of the coat over the skin's depths, the first of them on nothing.
    pub fn coat_pass<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        name: &str,
        first: bool,
        timestamp_writes: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) -> wgpu::RenderPass<'e> {
        self.coat_pass_before(self, encoder, name, first, timestamp_writes)
    }

    /// The same with the depths of other targets.
    pub fn coat_pass_before<'e>(
        &self,
        depths: &Self,
        encoder: &'e mut wgpu::CommandEncoder,
        name: &str,
        first: bool,
        timestamp_writes: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) -> wgpu::RenderPass<'e> {
        let load = if first { wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT) } else { wgpu::LoadOp::Load };
        let samples = attachment(&self.samples, load);
        begin(encoder, name, Some(samples), (&depths.depth, wgpu::LoadOp::Load), timestamp_writes)
    }

    /// The depths that a coat is tested by.
    pub fn coat_depth(&self) -> wgpu::RenderPassDepthStencilAttachment<'_> {
        depth_attachment(&self.depth, wgpu::LoadOp::Load)
    }

    /// Hides, where the coat is opaque by now, all that follows of it.
    pub fn hide_coat(&self, encoder: &mut wgpu::CommandEncoder, pipelines: &Pipelines) {
        self.hide(encoder, &self.depth, &pipelines.full[0]);
    }

    /// Hides the skin where the coat is opaque.
    pub fn hide_skin(&self, encoder: &mut wgpu::CommandEncoder, pipelines: &Pipelines) {
        self.hide(encoder, &self.skin_depth, &pipelines.full[1]);
    }

    fn hide(&self, encoder: &mut wgpu::CommandEncoder, depths: &wgpu::TextureView, pipeline: &wgpu::RenderPipeline) {
        let mut pass = begin(encoder, "full", None, (depths, wgpu::LoadOp::Load), None);
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &self.coat_group, &[]);
        pass.draw(0..3, 0..1);
    }

    /// Begins the pass of the skin where the depths of `depths` leave it to be seen.
    pub fn skin_pass<'e>(
        &self,
        depths: &Self,
        encoder: &'e mut wgpu::CommandEncoder,
        timestamp_writes: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) -> wgpu::RenderPass<'e> {
        let skin = wgpu::RenderPassColorAttachment {
            view: &self.skin_samples,
            depth_slice: None,
            resolve_target: Some(&self.skin),
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                store: wgpu::StoreOp::Discard,
            },
        };
        begin(encoder, "skin", Some(skin), (&depths.skin_depth, wgpu::LoadOp::Load), timestamp_writes)
    }

    /// Lays the skin under the coat.
    pub fn lay_skin_under(&self, encoder: &mut wgpu::CommandEncoder, pipelines: &Pipelines) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("under"),
            color_attachments: &[Some(attachment(&self.samples, wgpu::LoadOp::Load))],
            ..Default::default()
        });
        pass.set_pipeline(&pipelines.under);
        pass.set_bind_group(0, &self.skin_group, &[]);
        pass.draw(0..3, 0..1);
    }

    /// Averages shading samples into the picture, finds the nearest depths, and copies both to where they can be read.
    pub fn resolve(&self, encoder: &mut wgpu::CommandEncoder, pipelines: &Pipelines) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("resolve"),
            color_attachments: &[&self.picture.view, &self.nearest.view]
                .map(|view| Some(attachment(view, wgpu::LoadOp::Clear(POISON)))),
            ..Default::default()
        });
        pass.set_pipeline(&pipelines.resolve);
        pass.set_bind_group(0, &self.samples_group, &[]);
        pass.draw(0..3, 0..1);
        drop(pass);
        self.picture.read_back.copy(encoder, &self.picture.texture);
        self.nearest.read_back.copy(encoder, &self.nearest.texture);
    }

    /// The picture as `view` sees it, once everything recorded is done.
    ///
    /// # Errors
    /// As [`Gpu::read_buffer`].
    pub fn picture(&self, gpu: &Gpu, view: &Frame) -> Result<Picture> {
        let pixels = self.picture.read_back.texels(gpu)?;
        let depth_m = view.distances_m(&self.nearest.read_back.texels(gpu)?);
        Ok(Picture { size: self.size, pixels, depth_m })
    }
}

/// A target that is kept.
pub(super) fn attachment(
    view: &wgpu::TextureView,
    load: wgpu::LoadOp<wgpu::Color>,
) -> wgpu::RenderPassColorAttachment<'_> {
    let ops = wgpu::Operations { load, store: wgpu::StoreOp::Store };
    wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops }
}

/// Depths that are kept.
fn depth_attachment(view: &wgpu::TextureView, load: wgpu::LoadOp<f32>) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    let depth_ops = Some(wgpu::Operations { load, store: wgpu::StoreOp::Store });
    wgpu::RenderPassDepthStencilAttachment { view, depth_ops, stencil_ops: None }
}

/// Begins a pass with one colour, if any, and depths.
fn begin<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    name: &str,
    colour: Option<wgpu::RenderPassColorAttachment<'_>>,
    (depth, load): (&wgpu::TextureView, wgpu::LoadOp<f32>),
    timestamp_writes: Option<wgpu::RenderPassTimestampWrites<'_>>,
) -> wgpu::RenderPass<'e> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(name),
        color_attachments: colour.map(Some).as_slice(),
        depth_stencil_attachment: Some(depth_attachment(depth, load)),
        timestamp_writes,
        ..Default::default()
    })
}
