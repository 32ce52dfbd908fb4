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
pub const SHARED: [Source; 15] = [
    Source::constants("constants", &CONSTANTS),
    Source::constants("law_constants", &LAW_CONSTANTS),
    source!("shared/look.wgsl"),
    source!("runtime/looks.wgsl"),
    source!("shared/law.wgsl"),
    source!("shared/light.wgsl"),
    source!("shared/view.wgsl"),
    source!("runtime/blending.wgsl"),
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
/// Where nothing behind is seen.
pub const FULLY: Source = source!("runtime/full.wgsl");
/// Skin behind what is drawn.
pub const UNDER: Source = source!("runtime/under.wgsl");
/// Weighted sums over the skin.
pub const WEIGHED: Source = source!("runtime/weighed.wgsl");
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
pub(super) const SKIN_VERTICES: wgpu::VertexBufferLayout<'_> = wgpu::VertexBufferLayout {
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
    /// Group 0 of what reads one target: its texels.
    pub texels: wgpu::BindGroupLayout,
    /// Group 0 of weighted sums: they, what they let through, and the skin.
    pub sums: wgpu::BindGroupLayout,
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
            texels: group("texels", &[flat]),
            sums: group("sums", &[flat; 3]),
            samples: group("samples", &[flat, depths(false), flat]),
        }
    }
}

/// Everything that is made once per device and number of samples.
pub struct Pipelines {
    /// What they bind.
    pub layouts: Layouts,
    /// The skin's depth.
    pub skin_depth: wgpu::RenderPipeline,
    /// Opaque skin: tests depth.
    pub skin: wgpu::RenderPipeline,
    /// The nearest depth where nothing behind is seen: among a pixel's edge samples (index 1), or once.
    pub full: [wgpu::RenderPipeline; 2],
    /// The skin under what is drawn.
    pub under: wgpu::RenderPipeline,
    /// Weighted sums over the skin.
    pub weighed: wgpu::RenderPipeline,
    /// What the skin's depths leave of each pixel.
    pub edges: wgpu::RenderPipeline,
    /// Shells and fins from front to back: test depth.
    pub coat: CoatPipelines,
    /// Of the skin, shells and fins.
    pub(super) modules: [wgpu::ShaderModule; 3],
    /// Samples to pixels.
    pub resolve: wgpu::RenderPipeline,
}

/// What distinguishes one pass from another.
#[derive(Clone, Copy)]
pub(super) struct Pass<'a> {
    pub shader: &'a wgpu::ShaderModule,
    /// Its function for fragments.
    pub entry: &'a str,
    pub groups: &'a [Option<&'a wgpu::BindGroupLayout>],
    pub vertices: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    pub constants: &'a [(&'a str, f64)],
    pub targets: &'a [Option<wgpu::ColorTargetState>],
    pub depth: Option<Depth>,
    pub samples: u32,
}

/// What a pass does with depth.
#[derive(Clone, Copy)]
pub(super) struct Depth {
    writes: bool,
    compare: wgpu::CompareFunction,
}

impl Depth {
    pub const TESTED: Self = Self { writes: false, compare: wgpu::CompareFunction::LessEqual };
    pub const WRITTEN: Self = Self { writes: true, ..Self::TESTED };
    pub const COPIED: Self = Self { writes: true, compare: wgpu::CompareFunction::Always };
}

impl Pipelines {
    /// Compiles all passes for pictures of `samples`² samples per pixel.
    ///
    /// # Errors
    /// [`crate::error::Kind::Device`] with the compiler's message.
    pub fn new(gpu: &Gpu, samples: u32) -> Result<Self> {
        let layouts = Layouts::new(gpu);
        let shader = |main| gpu.shader(main, &SHARED);
        let modules = [shader(SKIN)?, shader(SHELL)?, shader(FIN)?];
        let (edges, full, under, resolve) = (shader(EDGES)?, shader(FULLY)?, shader(UNDER)?, shader(RESOLVE)?);
        let weighed = shader(WEIGHED)?;
        let target = |format, blend, write_mask| Some(wgpu::ColorTargetState { format, blend, write_mask });
        let opaque = [target(COLOUR, None, wgpu::ColorWrites::ALL)];
        let behind = [target(COLOUR, Some(BEHIND), wgpu::ColorWrites::ALL)];
        let resolved = [RESOLVED, RESOLVED_DEPTH].map(|format| target(format, None, wgpu::ColorWrites::ALL));
        let (view, tile) = (Some(&layouts.view), Some(&layouts.tile));
        let skin_vertices = [Some(SKIN_VERTICES)];
        let skin_groups = [view, tile, Some(&layouts.material)];
        let skin_pass = |targets, depth| Pass {
            shader: &modules[0],
            entry: "fragment",
            groups: &skin_groups,
            vertices: &skin_vertices,
            constants: &[],
            targets,
            depth: Some(depth),
            samples: EDGE_SAMPLES,
        };
        let texels = [Some(&layouts.texels)];
        let full = |samples| Pass {
            shader: &full,
            entry: "fragment",
            groups: &texels,
            vertices: &[],
            constants: &[],
            targets: &[],
            depth: Some(Depth::COPIED),
            samples,
        };
        let under = Pass {
            shader: &under,
            entry: "fragment",
            groups: &texels,
            vertices: &[],
            constants: &[],
            targets: &behind,
            depth: None,
            samples: 1,
        };
        let weighed = Pass {
            shader: &weighed,
            groups: &[Some(&layouts.sums)],
            targets: &opaque,
            depth: Some(Depth { writes: false, compare: wgpu::CompareFunction::Always }),
            ..under
        };
        let coat = CoatPipelines::new(gpu, &layouts, &modules, "fragment", &[], &behind, Depth::TESTED);
        let edge = [target(EDGE, None, wgpu::ColorWrites::ALL)];
        let edges = Pass {
            shader: &edges,
            entry: "fragment",
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
            entry: "fragment",
            groups: &[Some(&layouts.samples)],
            vertices: &[],
            constants: &constants,
            targets: &resolved,
            depth: None,
            samples: 1,
        };
        Ok(Self {
            skin_depth: pipeline(gpu, &skin_pass(&[], Depth::WRITTEN)),
            skin: pipeline(gpu, &skin_pass(&opaque, Depth::TESTED)),
            full: [1, EDGE_SAMPLES].map(|samples| pipeline(gpu, &full(samples))),
            under: pipeline(gpu, &under),
            weighed: pipeline(gpu, &weighed),
            edges: pipeline(gpu, &edges),
            coat,
            modules,
            resolve: pipeline(gpu, &resolve),
            layouts,
        })
    }
}

/// Shells and fins, drawn in one of the ways that there are.
pub struct CoatPipelines {
    /// With fins to hand over to, and with textures at the roots (index 1), or without.
    shells: [[wgpu::RenderPipeline; 2]; 2],
    fins: wgpu::RenderPipeline,
}

impl CoatPipelines {
    /// Compiles the shaders' functions `entry`, of the skin's, the shells' and the fins' `modules`, with these constants beside their own.
    pub(super) fn new(
        gpu: &Gpu,
        layouts: &Layouts,
        modules: &[wgpu::ShaderModule; 3],
        entry: &str,
        constants: &[(&str, f64)],
        targets: &[Option<wgpu::ColorTargetState>],
        depth: Depth,
    ) -> Self {
        let [_, shell, fin] = modules;
        let (view, tile, geometry) = (Some(&layouts.view), Some(&layouts.tile), Some(&layouts.geometry));
        let pass = |shader, groups: &[Option<&wgpu::BindGroupLayout>], own: &[(&str, f64)]| {
            let constants = &[constants, own].concat();
            let depth = Some(depth);
            pipeline(gpu, &Pass { shader, entry, groups, vertices: &[], constants, targets, depth, samples: 1 })
        };
        let shells = |with_fins: bool, painted: bool| {
            let own = [("WITH_FINS", f64::from(with_fins)), ("PAINTED", f64::from(painted))];
            pass(shell, &[view, tile, geometry], &own)
        };
        Self {
            shells: [false, true].map(|fins| [false, true].map(|painted| shells(fins, painted))),
            fins: pass(fin, &[view, tile, geometry, Some(&layouts.fin)], &[]),
        }
    }

    /// That for the fins of a coat, or its shells with or without textures at the roots, where fins are shown or not.
    pub fn of(&self, fins: bool, painted: bool, fins_shown: bool) -> &wgpu::RenderPipeline {
        if fins { &self.fins } else { &self.shells[usize::from(fins_shown)][usize::from(painted)] }
    }
}

/// What is drawn lies behind what was: premultiplied, with the alpha of what is before it.
const BEHIND: wgpu::BlendState = {
    let component = wgpu::BlendComponent {
        src_factor: wgpu::BlendFactor::OneMinusDstAlpha,
        dst_factor: wgpu::BlendFactor::One,
        operation: wgpu::BlendOperation::Add,
    };
    wgpu::BlendState { color: component, alpha: component }
};

/// Compiles a pass.
pub(super) fn pipeline(gpu: &Gpu, pass: &Pass<'_>) -> wgpu::RenderPipeline {
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
        // The skin's depth needs no colour; what marks depths discards some.
        fragment: (pass.vertices.is_empty() || !pass.targets.is_empty()).then_some(wgpu::FragmentState {
            module: pass.shader,
            entry_point: Some(pass.entry),
            compilation_options,
            targets: pass.targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}
