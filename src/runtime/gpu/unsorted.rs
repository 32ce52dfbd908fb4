//! What coats are drawn by and into without an order (`shaders/runtime/blending.wgsl`).

use super::bindings::bind;
use super::pipelines::{COLOUR, CoatPipelines, Depth, Pipelines};
use super::targets::Targets;
use crate::error::Result;
use crate::gpu::Gpu;

/// Passes of a coat that add up weighted light and opacity, and multiply what comes through.
pub fn weighted(gpu: &Gpu, pipelines: &Pipelines) -> CoatPipelines {
    use wgpu::BlendFactor::{One, OneMinusSrc, OneMinusSrcAlpha, Zero};
    let component =
        |src_factor, dst_factor| wgpu::BlendComponent { src_factor, dst_factor, operation: wgpu::BlendOperation::Add };
    let blends = [
        wgpu::BlendState { color: component(One, One), alpha: component(One, One) },
        wgpu::BlendState { color: component(Zero, OneMinusSrc), alpha: component(Zero, OneMinusSrcAlpha) },
    ];
    let targets = blends.map(|blend| {
        Some(wgpu::ColorTargetState { format: COLOUR, blend: Some(blend), write_mask: wgpu::ColorWrites::ALL })
    });
    CoatPipelines::new(gpu, &pipelines.layouts, &pipelines.modules, "weighted", &[], &targets, Depth::TESTED)
}

/// Passes of a coat whose hair is there or not, by chance.
pub fn hashed(gpu: &Gpu, pipelines: &Pipelines) -> CoatPipelines {
    let target = wgpu::ColorTargetState { format: COLOUR, blend: None, write_mask: wgpu::ColorWrites::ALL };
    CoatPipelines::new(gpu, &pipelines.layouts, &pipelines.modules, "hashed", &[], &[Some(target)], Depth::WRITTEN)
}

/// What weighted sums are drawn into.
pub(super) struct Sums {
    /// Weighted light and opacity, added up.
    pub sums: wgpu::TextureView,
    /// What comes through, multiplied.
    pub passed: wgpu::TextureView,
    /// Both and the skin, to lay the coat over it.
    pub group: wgpu::BindGroup,
}

impl Sums {
    /// For pictures as large as `targets`.
    ///
    /// # Errors
    /// As [`Gpu::target`].
    pub fn new(gpu: &Gpu, pipelines: &Pipelines, targets: &Targets, samples: u32) -> Result<Self> {
        let sampled = targets.size.map(|edge| edge.saturating_mul(samples));
        let target = |label| -> Result<wgpu::TextureView> {
            Ok(gpu.target(label, sampled, 1, COLOUR)?.create_view(&Default::default()))
        };
        let (sums, passed) = (target("sums")?, target("passed")?);
        let views = [&sums, &passed, &targets.skin].map(wgpu::BindingResource::TextureView);
        let group = bind(gpu, &pipelines.layouts.sums, &views);
        Ok(Self { sums, passed, group })
    }
}
