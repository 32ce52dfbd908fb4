//! The passes' shaders, bindings and fixed state.

use super::constants::CONSTANTS;
use super::layout::SkinVertex;
use crate::error::Result;
use crate::gpu::{Gpu, Source, Text};
use crate::volume::lighting::LAW_CONSTANTS;

macro_rules! source {
    ($path:literal) => {
        Source { path: $path, text: Text::Wgsl(include_str!(concat!("../../../shaders/", $path))) }
    };
}

/// Modules that others import, imported ones first.
pub const SHARED: [Source; 14] = [
    Source::constants("constants", &CONSTANTS),
    Source::constants("law_constants", &LAW_CONSTANTS),
    source!("shared/look.wgsl"),
    source!("runtime/looks.wgsl"),
    source!("shared/law.wgsl"),
    source!("shared/light.wgsl"),
    source!("shared/view.wgsl"),
    source!("runtime/items.wgsl"),
    source!("runtime/whole.wgsl"),
    source!("shared/shadow_map.wgsl"),
    source!("shared/fur_light.wgsl"),
    source!("shared/shading.wgsl"),
    source!("runtime/lights.wgsl"),
    source!("shared/coat.wgsl"),
];
/// Opaque skin.
pub const SKIN: Source = source!("runtime/skin.wgsl");
/// Shells.
pub const SHELL: Source = source!("runtime/shell.wgsl");
/// Fins.
pub const FIN: Source = source!("runtime/fin.wgsl");
/// What hides the key light.
pub const CASTER: Source = source!("runtime/caster.wgsl");
/// The skin's edges.
pub const EDGES: Source = source!("runtime/edges.wgsl");
/// Samples to pixels.
pub const RESOLVE: Source = source!("runtime/resolve.wgsl");

/// Places per pixel at which the skin's edges are sampled; shading happens once.
pub const EDGE_SAMPLES: u32 = 4;
/// Linear light with alpha while drawing.
pub const COLOUR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
/// Depth while drawing.
pub const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// The skin's edges: see `runtime/items.wgsl`.
pub const EDGE: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Float;
/// The finished picture.
pub const RESOLVED: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;
/// The finished picture's depths.
pub const RESOLVED_DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::R32Float;

/// The skin's vertices.
const SKIN_VERTICES: wgpu::VertexBufferLayout<'_> = wgpu::VertexBufferLayout {
    array_stride: size_of::<SkinVertex>() as u64,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &SkinVertex::ATTRIBUTES,
};

/// Layouts of what passes bind.
pub struct Layouts {
    /// Group 0: camera and lights, the key light's shadow map, what is drawn, and the skin's edges.
    pub view: wgpu::BindGroupLayout,
    /// Group 1: a tile.
    pub tile: wgpu::BindGroupLayout,
    /// Group 2 of shells and fins: geometry, and textures of the root.
    pub geometry: wgpu::BindGroupLayout,
    /// Group 2 of the skin: its textures.
    pub material: wgpu::BindGroupLayout,
    /// Group 3 of fins: their textures.
    pub fin: wgpu::BindGroupLayout,
    /// Group 0 of the skin's edges: its depths.
    pub depths: wgpu::BindGroupLayout,
    /// Group 0 of the resolve: the samples, their depths and the skin's edges.
    pub samples: wgpu::BindGroupLayout,
}

impl Layouts {
    fn new(gpu: &Gpu) -> Self {
        use wgpu::{BindingType, BufferBindingType, SamplerBindingType, ShaderStages, TextureSampleType};
        let buffer = |ty| BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
        let uniform = buffer(BufferBindingType::Uniform);
        let storage = buffer(BufferBindingType::Storage { read_only: true });
        let sampler = BindingType::Sampler(SamplerBindingType::Filtering);
        let texture = |filterable, view_dimension| BindingType::Texture {
            sample_type: TextureSampleType::Float { filterable },
            view_dimension,
            multisampled: false,
        };
        let depths = |multisampled| BindingType::Texture {
            sample_type: TextureSampleType::Depth,
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled,
        };
        let comparison = BindingType::Sampler(SamplerBindingType::Comparison);
        let array = texture(true, wgpu::TextureViewDimension::D2Array);
        let flat = texture(false, wgpu::TextureViewDimension::D2);
        let group = |label, kinds: &[BindingType]| {
            let entries: Vec<_> = (0..)
                .zip(kinds)
                .map(|(binding, &ty)| wgpu::BindGroupLayoutEntry {
                    binding,
                    visibility: ShaderStages::VERTEX_FRAGMENT,
                    ty,
                    count: None,
                })
                .collect();
            gpu.device
                .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
        };
        Self {
            view: group("view", &[uniform, comparison, depths(false), storage, flat]),
            tile: group("tile", &[uniform, storage, storage, sampler, array, array, array, storage, storage]),
            geometry: group("geometry", &[storage, storage, uniform, sampler, array, sampler, array]),
            material: group("material", &[sampler, array, sampler, array]),
            fin: group("fin", &[sampler, array, array]),
            depths: group("depths", &[depths(true)]),
            samples: group("samples", &[flat, depths(false), flat]),
        }
    }
}

/// Everything that is made once per device and number of samples.
pub struct Pipelines {
    /// What they bind.
    pub layouts: Layouts,
    /// Opaque skin: tests and writes depth.
    pub skin: wgpu::RenderPipeline,
    /// SkinMesh that only hides what is behind it.
    pub skin_depth: wgpu::RenderPipeline,
    /// What the skin's depths leave of each pixel.
    pub edges: wgpu::RenderPipeline,
    /// Shells: test depth. With fins to hand over to, and with textures at the roots (index 1), or without.
    pub shells: [[wgpu::RenderPipeline; 2]; 2],
    /// Fins: test depth.
    pub fins: wgpu::RenderPipeline,
    modules: [wgpu::ShaderModule; 3],
    /// Samples to pixels.
    pub resolve: wgpu::RenderPipeline,
}

/// What distinguishes one pass from another.
struct Pass<'a> {
    shader: &'a wgpu::ShaderModule,
    groups: &'a [Option<&'a wgpu::BindGroupLayout>],
    vertices: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    constants: &'a [(&'a str, f64)],
    targets: &'a [Option<wgpu::ColorTargetState>],
    depth: Option<Depth>,
    samples: u32,
}

/// What a pass does with depth.
#[derive(Clone, Copy)]
struct Depth {
    writes: bool,
    compare: wgpu::CompareFunction,
}

impl Depth {
    const TESTED: Self = Self { writes: false, compare: wgpu::CompareFunction::LessEqual };
    const WRITTEN: Self = Self { writes: true, ..Self::TESTED };
    const COPIED: Self = Self { writes: true, compare: wgpu::CompareFunction::Always };
}

impl Pipelines {
    /// Compiles all passes for pictures of `samples`² samples per pixel.
    ///
    /// # Errors
    /// [`crate::error::Kind::Device`] with the compiler's message.
    pub fn new(gpu: &Gpu, samples: u32) -> Result<Self> {
        let layouts = Layouts::new(gpu);
        let [skin, shell, fin, edges, resolve] =
            [SKIN, SHELL, FIN, EDGES, RESOLVE].map(|main| gpu.shader(main, &SHARED));
        let (skin, shell, fin, edges, resolve) = (skin?, shell?, fin?, edges?, resolve?);
        let target = |format, blend, write_mask| Some(wgpu::ColorTargetState { format, blend, write_mask });
        let opaque = [target(COLOUR, None, wgpu::ColorWrites::ALL)];
        let hidden = [target(COLOUR, None, wgpu::ColorWrites::empty())];
        let blended = [target(COLOUR, Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING), wgpu::ColorWrites::ALL)];
        let resolved = [RESOLVED, RESOLVED_DEPTH].map(|format| target(format, None, wgpu::ColorWrites::ALL));
        let (view, tile) = (Some(&layouts.view), Some(&layouts.tile));
        let skin_vertices = [Some(SKIN_VERTICES)];
        let skin_groups = [view, tile, Some(&layouts.material)];
        let skin_pass = |targets| Pass {
            shader: &skin,
            groups: &skin_groups,
            vertices: &skin_vertices,
            constants: &[],
            targets,
            depth: Some(Depth::WRITTEN),
            samples: EDGE_SAMPLES,
        };
        let shell_groups = [view, tile, Some(&layouts.geometry)];
        let shells = |with_fins: bool, painted: bool| {
            let constants = [("WITH_FINS", f64::from(with_fins)), ("PAINTED", f64::from(painted))];
            pipeline(
                gpu,
                &Pass {
                    shader: &shell,
                    groups: &shell_groups,
                    vertices: &[],
                    constants: &constants,
                    targets: &blended,
                    depth: Some(Depth::TESTED),
                    samples: 1,
                },
            )
        };
        let fin_groups = [view, tile, Some(&layouts.geometry), Some(&layouts.fin)];
        let fins = Pass {
            shader: &fin,
            groups: &fin_groups,
            vertices: &[],
            constants: &[],
            targets: &blended,
            depth: Some(Depth::TESTED),
            samples: 1,
        };
        let edge = [target(EDGE, None, wgpu::ColorWrites::ALL)];
        let edges = Pass {
            shader: &edges,
            groups: &[Some(&layouts.depths)],
            vertices: &[],
            constants: &[],
            targets: &edge,
            depth: Some(Depth::COPIED),
            samples: 1,
        };
        let constants = [("SAMPLES", f64::from(samples))];
        let resolve = Pass {
            shader: &resolve,
            groups: &[Some(&layouts.samples)],
            vertices: &[],
            constants: &constants,
            targets: &resolved,
            depth: None,
            samples: 1,
        };
        Ok(Self {
            skin: pipeline(gpu, &skin_pass(&opaque)),
            skin_depth: pipeline(gpu, &skin_pass(&hidden)),
            edges: pipeline(gpu, &edges),
            shells: [false, true].map(|fins| [false, true].map(|painted| shells(fins, painted))),
            fins: pipeline(gpu, &fins),
            modules: [skin, shell, fin],
            resolve: pipeline(gpu, &resolve),
            layouts,
        })
    }
}

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
            groups: &[Some(view), Some(tile), Some(material)],
            vertices: &[Some(SKIN_VERTICES)],
            constants: &[measured],
            targets: &targets,
            depth: Some(Depth::WRITTEN),
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

fn pipeline(gpu: &Gpu, pass: &Pass<'_>) -> wgpu::RenderPipeline {
    let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: pass.groups,
        immediate_size: 0,
    });
    let compilation_options = wgpu::PipelineCompilationOptions { constants: pass.constants, ..Default::default() };
    gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: pass.shader,
            entry_point: Some("vertex"),
            compilation_options: compilation_options.clone(),
            buffers: pass.vertices,
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: pass.depth.map(|depth| wgpu::DepthStencilState {
            format: DEPTH,
            depth_write_enabled: Some(depth.writes),
            depth_compare: Some(depth.compare),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState { count: pass.samples, ..Default::default() },
        fragment: Some(wgpu::FragmentState {
            module: pass.shader,
            entry_point: Some("fragment"),
            compilation_options,
            targets: pass.targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}
