//! What coats are drawn by and into without an order (`shaders/runtime/blending.wgsl`).

use super::bindings::bind;
use super::pipelines::{COLOUR, Depth, Layouts, Pass, Pipelines, pipeline};
use super::resources::GpuFur;
use super::targets::Targets;
use crate::error::Result;
use crate::gpu::Gpu;
use crate::runtime::draw_list::Show;

/// Passes of shells and fins that need no order.
pub(super) struct Unsorted {
    /// Shells: with fins to hand over to, and with textures at the roots (index 1), or without.
    shells: [[wgpu::RenderPipeline; 2]; 2],
    fins: wgpu::RenderPipeline,
}

impl Unsorted {
    /// Compiles them.
    fn new(
        gpu: &Gpu,
        pipelines: &Pipelines,
        entry: &str,
        targets: &[Option<wgpu::ColorTargetState>],
        depth: Depth,
    ) -> Self {
        let Layouts { view, tile, geometry, fin, .. } = &pipelines.layouts;
        let [_, shell, fins] = &pipelines.modules;
        let pass = |shader, groups: &[Option<&wgpu::BindGroupLayout>], constants: &[(&str, f64)]| {
            let pass =
                Pass { shader, entry, groups, vertices: &[], constants, targets, depth: Some(depth), samples: 1 };
            pipeline(gpu, &pass)
        };
        let shells = |with_fins: bool, painted: bool| {
            let constants = [("WITH_FINS", f64::from(with_fins)), ("PAINTED", f64::from(painted))];
            pass(shell, &[Some(view), Some(tile), Some(geometry)], &constants)
        };
        Self {
            shells: [false, true].map(|fins| [false, true].map(|painted| shells(fins, painted))),
            fins: pass(fins, &[Some(view), Some(tile), Some(geometry), Some(fin)], &[]),
        }
    }

    /// Those that add up weighted light and opacity, and multiply what comes through.
    pub fn weighted(gpu: &Gpu, pipelines: &Pipelines) -> Self {
        use wgpu::BlendFactor::{One, OneMinusSrc, OneMinusSrcAlpha, Zero};
        let component = |src_factor, dst_factor| wgpu::BlendComponent {
            src_factor,
            dst_factor,
            operation: wgpu::BlendOperation::Add,
        };
        let blends = [
            wgpu::BlendState { color: component(One, One), alpha: component(One, One) },
            wgpu::BlendState { color: component(Zero, OneMinusSrc), alpha: component(Zero, OneMinusSrcAlpha) },
        ];
        let targets = blends.map(|blend| {
            Some(wgpu::ColorTargetState { format: COLOUR, blend: Some(blend), write_mask: wgpu::ColorWrites::ALL })
        });
        Self::new(gpu, pipelines, "weighted", &targets, Depth::TESTED)
    }

    /// Those that are there or not, by chance.
    pub fn hashed(gpu: &Gpu, pipelines: &Pipelines) -> Self {
        let target = wgpu::ColorTargetState { format: COLOUR, blend: None, write_mask: wgpu::ColorWrites::ALL };
        Self::new(gpu, pipelines, "hashed", &[Some(target)], Depth::WRITTEN)
    }

    /// That for shells or fins of a coat.
    pub fn of(&self, fur: &GpuFur, fins: bool, show: Show) -> &wgpu::RenderPipeline {
        if fins { &self.fins } else { &self.shells[usize::from(show.fins)][usize::from(fur.painted)] }
    }
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
