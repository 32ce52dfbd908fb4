//! Compute passes: layouts, kernels and how they are sent off.

use super::Gpu;
use crate::error::{Error, Kind, Result};

/// What a kernel binds at one place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Binding {
    /// Numbers that all threads share.
    Uniform,
    /// An array to read.
    Read,
    /// An array to read and write.
    Write,
}

/// A compiled compute shader.
pub struct Kernel {
    pipeline: wgpu::ComputePipeline,
}

impl Gpu {
    /// A layout of buffers at bindings 0, 1, ….
    pub fn layout(&self, label: &str, bindings: &[Binding]) -> wgpu::BindGroupLayout {
        let entries: Vec<_> = (0..)
            .zip(bindings)
            .map(|(binding, kind)| wgpu::BindGroupLayoutEntry {
                binding,
                visibility: wgpu::ShaderStages::COMPUTE,
                ty: wgpu::BindingType::Buffer {
                    ty: match kind {
                        Binding::Uniform => wgpu::BufferBindingType::Uniform,
                        Binding::Read => wgpu::BufferBindingType::Storage { read_only: true },
                        Binding::Write => wgpu::BufferBindingType::Storage { read_only: false },
                    },
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                count: None,
            })
            .collect();
        self.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
    }

    /// Buffers at bindings 0, 1, ….
    pub fn group(&self, layout: &wgpu::BindGroupLayout, buffers: &[&wgpu::Buffer]) -> wgpu::BindGroup {
        let entries: Vec<_> = (0..)
            .zip(buffers)
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        self.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
    }

    /// The only entry point of `module`, which binds `groups` from 0 on, without gaps.
    pub fn kernel(
        &self,
        label: &str,
        module: &wgpu::ShaderModule,
        groups: &[&wgpu::BindGroupLayout],
        constants: &[(&str, f64)],
    ) -> Kernel {
        let layout = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(label),
            bind_group_layouts: &groups.iter().copied().map(Some).collect::<Vec<_>>(),
            immediate_size: 0,
        });
        let pipeline = self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(label),
            layout: Some(&layout),
            module,
            entry_point: None,
            compilation_options: wgpu::PipelineCompilationOptions { constants, ..Default::default() },
            cache: None,
        });
        Kernel { pipeline }
    }

    /// A buffer of `count` items of `item_bytes` that shaders read and write; never empty.
    ///
    /// # Errors
    /// [`Kind::Device`] where the adapter binds no buffer as large.
    pub fn storage(&self, label: &str, count: usize, item_bytes: usize) -> Result<wgpu::Buffer> {
        let size = (count * item_bytes).max(256).next_multiple_of(16) as u64;
        self.check_size(label, size)?;
        Ok(self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        }))
    }

    /// A buffer with `contents` for shaders to read.
    ///
    /// # Errors
    /// As [`Self::storage`].
    pub fn read_only<T: bytemuck::NoUninit>(&self, label: &str, contents: &[T]) -> Result<wgpu::Buffer> {
        self.check_size(label, size_of_val(contents) as u64)?;
        Ok(self.buffer(label, contents, wgpu::BufferUsages::STORAGE))
    }

    /// Bytes of the largest buffer that shaders can bind.
    pub fn largest_storage_bytes(&self) -> u64 {
        let limits = self.device.limits();
        limits.max_buffer_size.min(limits.max_storage_buffer_binding_size)
    }

    fn check_size(&self, label: &str, size: u64) -> Result<()> {
        let most = self.largest_storage_bytes();
        if size > most {
            return Err(Error::new(Kind::Device, "a buffer is too large for this adapter")
                .with_field(label)
                .with_found(format!("{size} bytes"))
                .with_expected(format!("at most {most}")));
        }
        Ok(())
    }
}

impl Kernel {
    /// Sends off `count` workgroups. They are laid out in rows, because adapters count no further than 65,535 in one
    /// direction; a shader numbers them `y · num_workgroups.x + x` and stops past its last.
    pub fn dispatch(&self, pass: &mut wgpu::ComputePass<'_>, groups: &[&wgpu::BindGroup], count: usize) {
        const ROW: u32 = 32_768;
        let count = count as u32;
        if count == 0 {
            return;
        }
        pass.set_pipeline(&self.pipeline);
        for (index, group) in (0..).zip(groups) {
            pass.set_bind_group(index, *group, &[]);
        }
        if count <= ROW {
            pass.dispatch_workgroups(count, 1, 1);
        } else {
            pass.dispatch_workgroups(ROW, count.div_ceil(ROW), 1);
        }
    }
}
