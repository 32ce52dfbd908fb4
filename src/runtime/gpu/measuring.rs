//! The passes that measure instead of drawing.

use super::pipelines::{COLOUR, Depth, EDGE_SAMPLES, Layouts, Pass, Pipelines, SKIN_VERTICES, pipeline};
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
    /// Shells: with fins to hand over to, and with textures at the roots (index 1), or without.
    pub shells: [[wgpu::RenderPipeline; 2]; 2],
    /// Fins.
    pub fins: wgpu::RenderPipeline,
}

impl CostPipelines {
    /// Compiles them.
    pub fn new(gpu: &Gpu, pipelines: &Pipelines) -> Self {
        let Layouts { view, tile, geometry, material, fin, .. } = &pipelines.layouts;
        let [skin, shell, fins] = &pipelines.modules;
        let targets = [Some(added())];
        let pass = |shader, groups: &[Option<&wgpu::BindGroupLayout>], constants: &[(&str, f64)]| {
            let pass = Pass {
                shader,
                entry: "fragment",
                groups,
                vertices: &[],
                constants,
                targets: &targets,
                depth: Some(Depth::TESTED),
                samples: 1,
            };
            pipeline(gpu, &pass)
        };
        let measured = ("MEASURE", 4.0);
        let shells = |with_fins: bool, painted: bool| {
            let constants = [("WITH_FINS", f64::from(with_fins)), ("PAINTED", f64::from(painted)), measured];
            pass(shell, &[Some(view), Some(tile), Some(geometry)], &constants)
        };
        let skin = Pass {
            shader: skin,
            entry: "fragment",
            groups: &[Some(view), Some(tile), Some(material)],
            vertices: &[Some(SKIN_VERTICES)],
            constants: &[measured],
            targets: &targets,
            depth: Some(Depth::TESTED),
            samples: EDGE_SAMPLES,
        };
        Self {
            skin: pipeline(gpu, &skin),
            shells: [false, true].map(|fins| [false, true].map(|painted| shells(fins, painted))),
            fins: pass(fins, &[Some(view), Some(tile), Some(geometry), Some(fin)], &[measured]),
        }
    }
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
