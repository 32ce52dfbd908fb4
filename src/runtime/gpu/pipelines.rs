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
pub const SHARED: [Source; 12] = [
    Source::constants("constants", &CONSTANTS),
    Source::constants("law_constants", &LAW_CONSTANTS),
    source!("shared/look.wgsl"),
    source!("runtime/looks.wgsl"),
    source!("shared/law.wgsl"),
    source!("shared/light.wgsl"),
    source!("shared/view.wgsl"),
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
/// Samples to pixels.
pub const RESOLVE: Source = source!("runtime/resolve.wgsl");

/// Places per pixel at which edges are sampled; shading happens once.
pub const EDGE_SAMPLES: u32 = 4;
/// Linear light with alpha while drawing.
pub const COLOUR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
/// Depth while drawing.
pub const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// The finished picture.
pub const RESOLVED: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;
/// The finished picture's depths.
pub const RESOLVED_DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::R32Float;

/// Layouts of what passes bind.
pub struct Layouts {
    /// Group 0: camera and lights, and the key light's shadow map.
    pub view: wgpu::BindGroupLayout,
    /// Group 1: a tile.
    pub tile: wgpu::BindGroupLayout,
    /// Group 2 of shells and fins: geometry, and textures of the root.
    pub geometry: wgpu::BindGroupLayout,
    /// Group 2 of the skin: its textures.
    pub material: wgpu::BindGroupLayout,
    /// Group 3 of fins: their textures.
    pub fin: wgpu::BindGroupLayout,
    /// Group 0 of the resolve: the samples and their depths.
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
            view: group("view", &[uniform, comparison, depths(false)]),
            tile: group("tile", &[uniform, storage, storage, sampler, array, array, array, storage, storage]),
            geometry: group("geometry", &[storage, storage, uniform, sampler, array, sampler, array]),
            material: group("material", &[sampler, array, sampler, array]),
            fin: group("fin", &[sampler, array, array]),
            samples: group("samples", &[texture(false, wgpu::TextureViewDimension::D2), depths(true)]),
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
    /// Far side of the shells: tests depth.
    pub far_shells: ShellPipelines,
    /// Near side of the shells: tests and writes depth.
    pub near_shells: ShellPipelines,
    /// Fins: test depth.
    pub fins: wgpu::RenderPipeline,
    shell: wgpu::ShaderModule,
    /// Samples to pixels.
    pub resolve: wgpu::RenderPipeline,
}

/// One side of the shells: with fins to hand over to, and with textures at the roots (index 1), or without.
pub type ShellPipelines = [[wgpu::RenderPipeline; 2]; 2];

/// What distinguishes one pass from another.
struct Pass<'a> {
    shader: &'a wgpu::ShaderModule,
    groups: &'a [Option<&'a wgpu::BindGroupLayout>],
    vertices: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    constants: &'a [(&'a str, f64)],
    targets: &'a [Option<wgpu::ColorTargetState>],
    writes_depth: Option<bool>,
}

impl Pipelines {
    /// Compiles all passes for pictures of `samples`² samples per pixel.
    ///
    /// # Errors
    /// [`crate::error::Kind::Device`] with the compiler's message.
    pub fn new(gpu: &Gpu, samples: u32) -> Result<Self> {
        let layouts = Layouts::new(gpu);
        let [skin, shell, fin, resolve] = [SKIN, SHELL, FIN, RESOLVE].map(|main| gpu.shader(main, &SHARED));
        let (skin, shell, fin, resolve) = (skin?, shell?, fin?, resolve?);
        let target = |format, blend, write_mask| Some(wgpu::ColorTargetState { format, blend, write_mask });
        let opaque = [target(COLOUR, None, wgpu::ColorWrites::ALL)];
        let hidden = [target(COLOUR, None, wgpu::ColorWrites::empty())];
        let blended = [target(COLOUR, Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING), wgpu::ColorWrites::ALL)];
        let resolved = [RESOLVED, RESOLVED_DEPTH].map(|format| target(format, None, wgpu::ColorWrites::ALL));
        let (view, tile) = (Some(&layouts.view), Some(&layouts.tile));
        let skin_vertices = [Some(wgpu::VertexBufferLayout {
            array_stride: size_of::<SkinVertex>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: &SkinVertex::ATTRIBUTES,
        })];
        let skin_groups = [view, tile, Some(&layouts.material)];
        let skin_pass = |targets| Pass {
            shader: &skin,
            groups: &skin_groups,
            vertices: &skin_vertices,
            constants: &[],
            targets,
            writes_depth: Some(true),
        };
        let shell_groups = [view, tile, Some(&layouts.geometry)];
        let shells = |near: bool, with_fins: bool, painted: bool| {
            let constants =
                [("NEAR_SIDE", f64::from(near)), ("WITH_FINS", f64::from(with_fins)), ("PAINTED", f64::from(painted))];
            pipeline(
                gpu,
                &Pass {
                    shader: &shell,
                    groups: &shell_groups,
                    vertices: &[],
                    constants: &constants,
                    targets: &blended,
                    writes_depth: Some(near),
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
            writes_depth: Some(false),
        };
        let constants = [("SAMPLES", f64::from(samples))];
        let resolve = Pass {
            shader: &resolve,
            groups: &[Some(&layouts.samples)],
            vertices: &[],
            constants: &constants,
            targets: &resolved,
            writes_depth: None,
        };
        Ok(Self {
            skin: pipeline(gpu, &skin_pass(&opaque)),
            skin_depth: pipeline(gpu, &skin_pass(&hidden)),
            far_shells: [false, true].map(|fins| [false, true].map(|painted| shells(false, fins, painted))),
            near_shells: [false, true].map(|fins| [false, true].map(|painted| shells(true, fins, painted))),
            fins: pipeline(gpu, &fins),
            shell,
            resolve: pipeline(gpu, &resolve),
            layouts,
        })
    }
}

/// The passes that add up how much hair lies over the skin.
pub struct DepthPipelines {
    /// On the skin: what the hair over it would come to.
    pub expected: wgpu::RenderPipeline,
    /// Each near shell.
    pub slabs: wgpu::RenderPipeline,
}

impl DepthPipelines {
    /// Compiles both.
    pub fn new(gpu: &Gpu, pipelines: &Pipelines) -> Self {
        let Layouts { view, tile, geometry, .. } = &pipelines.layouts;
        let one = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::One,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Add,
        };
        let added = wgpu::BlendState { color: one, alpha: one };
        let targets =
            [Some(wgpu::ColorTargetState { format: COLOUR, blend: Some(added), write_mask: wgpu::ColorWrites::ALL })];
        let shells = |depths: f64| {
            let constants = [("NEAR_SIDE", 1.0), ("WITH_FINS", 0.0), ("DEPTHS", depths)];
            let pass = Pass {
                shader: &pipelines.shell,
                groups: &[Some(view), Some(tile), Some(geometry)],
                vertices: &[],
                constants: &constants,
                targets: &targets,
                writes_depth: Some(false),
            };
            pipeline(gpu, &pass)
        };
        Self { expected: shells(2.0), slabs: shells(1.0) }
    }
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
        depth_stencil: pass.writes_depth.map(|write| wgpu::DepthStencilState {
            format: DEPTH,
            depth_write_enabled: Some(write),
            depth_compare: Some(wgpu::CompareFunction::LessEqual),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState {
            count: if pass.writes_depth.is_some() { EDGE_SAMPLES } else { 1 },
            ..Default::default()
        },
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
