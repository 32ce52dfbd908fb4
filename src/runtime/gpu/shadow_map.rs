//! The key light's shadow map on the device: drawn before each picture, read by every pass that lights something.

use super::PassCost;
use super::bindings::bind;
use super::layout::CasterVertex;
use super::pipelines::{CASTER, DEPTH, SHARED};
use crate::error::Result;
use crate::gpu::Gpu;
use crate::runtime::casters::Casters;
use crate::runtime::draw_list::DrawList;
use crate::runtime::shadow_view::TEXELS;

/// The map, and what draws into it.
pub(super) struct ShadowMap {
    /// Its depths: 1 where nothing hides the light.
    pub view: wgpu::TextureView,
    /// Compares with the four texels around a place.
    pub sampler: wgpu::Sampler,
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
}

/// Memory of the map, bytes.
pub(super) const MAP_BYTES: u64 = TEXELS as u64 * TEXELS as u64 * 4;

impl ShadowMap {
    /// Compiles the pass and makes the map.
    ///
    /// # Errors
    /// [`crate::error::Kind::Device`] with the compiler's message; as [`Gpu::target`].
    pub fn new(gpu: &Gpu) -> Result<Self> {
        let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("caster"),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::VERTEX,
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                count: None,
            }],
        });
        let shader = gpu.shader(CASTER, &SHARED)?;
        let pipeline_layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("shadow map"),
            layout: Some(&pipeline_layout),
            vertex: wgpu::VertexState {
                module: &shader,
                entry_point: Some("vertex"),
                compilation_options: Default::default(),
                buffers: &[Some(wgpu::VertexBufferLayout {
                    array_stride: size_of::<CasterVertex>() as u64,
                    step_mode: wgpu::VertexStepMode::Vertex,
                    attributes: &CasterVertex::ATTRIBUTES,
                })],
            },
            // Far sides alone: what lies on a body lies before them, so that none hides itself.
            primitive: wgpu::PrimitiveState { cull_mode: Some(wgpu::Face::Front), ..Default::default() },
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::LessEqual),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            multisample: wgpu::MultisampleState::default(),
            fragment: None,
            multiview_mask: None,
            cache: None,
        });
        let texture = gpu.target("shadow map", [TEXELS; 2], 1, DEPTH)?;
        let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("shadow map"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            compare: Some(wgpu::CompareFunction::LessEqual),
            ..Default::default()
        });
        Ok(Self { view: texture.create_view(&Default::default()), sampler, layout, pipeline })
    }

    /// Records the pass: `casters` where there are any, else nothing but light.
    pub fn draw(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        casters: Option<&GpuCasters>,
        timestamp_writes: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) -> PassCost {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("shadow map"),
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.view,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            timestamp_writes,
            ..Default::default()
        });
        let mut cost = PassCost { name: "shadow map", ms: None, bytes: 0, draw_calls: 0, triangles: 0 };
        if let Some(casters) = casters.filter(|casters| casters.index_count > 0) {
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &casters.group, &[]);
            pass.set_vertex_buffer(0, casters.vertices.slice(..));
            pass.set_index_buffer(casters.indices.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..casters.index_count, 0, 0..1);
            cost.bytes = casters.bytes;
            cost.draw_calls = 1;
            cost.triangles = u64::from(casters.index_count / 3);
        }
        cost
    }
}

/// What casts a shadow in one pose, on the device.
pub(super) struct GpuCasters {
    /// Where it is; its lists lie on the device alone.
    pub extent: Casters,
    /// Geometry memory.
    pub bytes: u64,
    group: wgpu::BindGroup,
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    index_count: u32,
}

impl GpuCasters {
    /// Uploads those of `scene`, which are drawn with the light in the buffer `view`.
    pub fn new(gpu: &Gpu, map: &ShadowMap, scene: &DrawList<'_>, view: &wgpu::Buffer) -> Self {
        let casters = Casters::of(scene);
        let vertices = CasterVertex::of(&casters);
        Self {
            bytes: size_of_val(&vertices[..]) as u64 + size_of_val(&casters.triangles[..]) as u64,
            group: bind(gpu, &map.layout, &[view.as_entire_binding()]),
            vertices: gpu.buffer("caster vertices", &vertices, wgpu::BufferUsages::VERTEX),
            indices: gpu.buffer("caster indices", &casters.triangles, wgpu::BufferUsages::INDEX),
            index_count: 3 * casters.triangles.len() as u32,
            extent: Casters { asset: casters.asset, guests: casters.guests, ..Casters::default() },
        }
    }
}
