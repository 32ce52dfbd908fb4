//! The passes that measure instead of drawing.

use super::pipelines::{COLOUR, CoatPipelines, Depth, EDGE_SAMPLES, Layouts, Pass, Pipelines, SKIN_VERTICES, pipeline};
use crate::gpu::Gpu;

/// The passes that add up how much hair lies over the skin, and that find the nearest hair.
pub struct DepthPipelines {
    /// On the skin: what the hair over it would come to.
    pub expected: wgpu::RenderPipeline,
    /// Each near shell.
    pub slabs: wgpu::RenderPipeline,
    /// Depth of each near shell where it has hair, without and with textures at the roots.
    pub nearest: [wgpu::RenderPipeline; 2],
}

impl DepthPipelines {
    /// Compiles them.
    pub fn new(gpu: &Gpu, pipelines: &Pipelines) -> Self {
        let Layouts { view, tile, geometry, .. } = &pipelines.layouts;
        let targets = [Some(added())];
        let hidden =
            [Some(wgpu::ColorTargetState { format: COLOUR, blend: None, write_mask: wgpu::ColorWrites::empty() })];
        let shells = |depths: f64, painted: bool, targets, depth| {
            let constants = [("WITH_FINS", 0.0), ("MEASURE", depths), ("PAINTED", f64::from(painted))];
            let pass = Pass {
                shader: &pipelines.modules[1],
                entry: "fragment",
                groups: &[Some(view), Some(tile), Some(geometry)],
                vertices: &[],
                constants: &constants,
                targets,
                depth: Some(depth),
                samples: 1,
            };
            pipeline(gpu, &pass)
        };
        Self {
            expected: shells(2.0, true, &targets, Depth::TESTED),
            slabs: shells(1.0, true, &targets, Depth::TESTED),
            nearest: [false, true].map(|painted| shells(3.0, painted, &hidden, Depth::WRITTEN)),
        }
    }
}

/// The passes that add up what a picture costs.
pub struct CostPipelines {
    /// Skin.
    pub skin: wgpu::RenderPipeline,
    /// Shells and fins.
    pub coat: CoatPipelines,
}

impl CostPipelines {
    /// Compiles them.
    pub fn new(gpu: &Gpu, pipelines: &Pipelines) -> Self {
        let targets = [Some(added())];
        let measured = [("MEASURE", 4.0)];
        let (layouts, modules) = (&pipelines.layouts, &pipelines.modules);
        Self {
            skin: skin(gpu, pipelines, &measured, &targets),
            coat: CoatPipelines::new(gpu, layouts, modules, "fragment", &measured, &targets, Depth::TESTED),
        }
    }
}

/// The pass that finds how much hair is between the skin and light.
pub fn depth_to_skin(gpu: &Gpu, pipelines: &Pipelines) -> wgpu::RenderPipeline {
    let target = wgpu::ColorTargetState { format: COLOUR, blend: None, write_mask: wgpu::ColorWrites::ALL };
    skin(gpu, pipelines, &[("MEASURE", 5.0)], &[Some(target)])
}

/// A pass of the skin with these constants.
fn skin(
    gpu: &Gpu,
    pipelines: &Pipelines,
    constants: &[(&str, f64)],
    targets: &[Option<wgpu::ColorTargetState>],
) -> wgpu::RenderPipeline {
    let Layouts { view, tile, material, .. } = &pipelines.layouts;
    let pass = Pass {
        shader: &pipelines.modules[0],
        entry: "fragment",
        groups: &[Some(view), Some(tile), Some(material)],
        vertices: &[Some(SKIN_VERTICES)],
        constants,
        targets,
        depth: Some(Depth::TESTED),
        samples: EDGE_SAMPLES,
    };
    pipeline(gpu, &pass)
}

/// A target to which everything is added.
fn added() -> wgpu::ColorTargetState {
    let one = wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::One,
        dst_factor: wgpu::BlendFactor::One,
        operation: wgpu::BlendOperation::Add,
    };
    let blend = Some(wgpu::BlendState { color: one, alpha: one });
    wgpu::ColorTargetState { format: COLOUR, blend, write_mask: wgpu::ColorWrites::ALL }
}
