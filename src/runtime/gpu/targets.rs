//! What pictures of one size are drawn into, and the way back to the host.

use super::pipelines::{COLOUR, DEPTH, EDGE_SAMPLES, Pipelines, RESOLVED, RESOLVED_DEPTH};
use super::resources::bind;
use crate::error::Result;
use crate::gpu::{Gpu, ReadBack};
use crate::runtime::draw_list::{Frame, Picture};

/// What the picture holds before it is written, so that a pixel that never is shows.
const POISON: wgpu::Color = wgpu::Color { r: f64::NAN, g: f64::NAN, b: f64::NAN, a: f64::NAN };

/// The pass that comes last before the resolve.
const LAST: usize = 3;

/// Colour and depth at a pixel's edge samples, its shading samples, and the finished picture with its depths.
pub(super) struct Targets {
    /// Pixels: width, height.
    pub size: [u32; 2],
    /// Memory of all, bytes.
    pub bytes: u64,
    edges: wgpu::TextureView,
    depth: wgpu::TextureView,
    samples: wgpu::TextureView,
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
        let edges = gpu.target("edge samples", sampled, EDGE_SAMPLES, COLOUR)?;
        let depth = gpu.target("depth", sampled, EDGE_SAMPLES, DEPTH)?;
        let shaded = gpu.target("samples", sampled, 1, COLOUR)?;
        let [edges, depth, samples] = [&edges, &depth, &shaded].map(|texture| texture.create_view(&Default::default()));
        let resources = [&samples, &depth].map(wgpu::BindingResource::TextureView);
        let samples_group = bind(gpu, &pipelines.layouts.samples, &resources);
        let area = |size: [u32; 2]| u64::from(size[0]) * u64::from(size[1]);
        let bytes = area(sampled) * (u64::from(EDGE_SAMPLES) * (8 + 4) + 8) + area(size) * (16 + 4);
        let picture = Finished::new(gpu, "picture", size, RESOLVED)?;
        let nearest = Finished::new(gpu, "nearest", size, RESOLVED_DEPTH)?;
        Ok(Self { size, bytes, edges, depth, samples, samples_group, picture, nearest })
    }

    /// Begins pass number `index`: the first clears, the last turns edge samples into shading samples.
    pub fn pass<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        name: &str,
        index: usize,
        timestamp_writes: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) -> wgpu::RenderPass<'e> {
        let clear = index == 0;
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(name),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.edges,
                depth_slice: None,
                resolve_target: (index == LAST).then_some(&self.samples),
                ops: wgpu::Operations {
                    load: if clear { wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT) } else { wgpu::LoadOp::Load },
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth,
                depth_ops: Some(wgpu::Operations {
                    load: if clear { wgpu::LoadOp::Clear(1.0) } else { wgpu::LoadOp::Load },
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            timestamp_writes,
            ..Default::default()
        })
    }

    /// Averages shading samples into the picture, finds the nearest depths, and copies both to where they can be read.
    pub fn resolve(&self, encoder: &mut wgpu::CommandEncoder, pipelines: &Pipelines) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("resolve"),
            color_attachments: &[&self.picture.view, &self.nearest.view].map(|view| {
                Some(wgpu::RenderPassColorAttachment {
                    view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations { load: wgpu::LoadOp::Clear(POISON), store: wgpu::StoreOp::Store },
                })
            }),
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
