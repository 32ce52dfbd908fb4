//! How long passes took, by the device's own clock.

use super::Gpu;
use crate::error::Result;

/// Timestamps around a number of passes; measures nothing on adapters that have none.
pub struct Timer {
    queries: Option<wgpu::QuerySet>,
    passes: u32,
}

impl Timer {
    /// A timer for `passes` passes.
    pub fn new(gpu: &Gpu, passes: u32) -> Self {
        let able = gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY);
        let queries = able.then(|| {
            gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("timer"),
                ty: wgpu::QueryType::Timestamp,
                count: 2 * passes,
            })
        });
        Self { queries, passes }
    }

    /// What pass number `pass` writes.
    pub fn writes(&self, pass: u32) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        self.queries.as_ref().map(|query_set| wgpu::RenderPassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: Some(2 * pass),
            end_of_pass_write_index: Some(2 * pass + 1),
        })
    }

    /// What compute pass number `pass` writes.
    pub fn compute_writes(&self, pass: u32) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        self.queries.as_ref().map(|query_set| wgpu::ComputePassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: Some(2 * pass),
            end_of_pass_write_index: Some(2 * pass + 1),
        })
    }

    /// Milliseconds of each pass, once the passes were submitted; `None` where the adapter has no clock.
    ///
    /// # Errors
    /// As [`Gpu::finish`].
    pub fn read_ms(&self, gpu: &Gpu) -> Result<Option<Vec<f64>>> {
        let Some(queries) = &self.queries else { return Ok(None) };
        let size = u64::from(self.passes) * 16;
        let buffer = |usage| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("timer"),
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        let resolved = buffer(wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC);
        let readable = buffer(wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ);
        let mut encoder = gpu.encoder("timer");
        encoder.resolve_query_set(queries, 0..2 * self.passes, &resolved, 0);
        encoder.copy_buffer_to_buffer(&resolved, 0, &readable, 0, size);
        gpu.finish(encoder)?;
        let ticks: Vec<[u64; 2]> = bytemuck::pod_collect_to_vec(&gpu.read_buffer(&readable)?);
        let ms_per_tick = f64::from(gpu.queue.get_timestamp_period()) * 1e-6;
        Ok(Some(ticks.iter().map(|[start, end]| end.saturating_sub(*start) as f64 * ms_per_tick).collect()))
    }
}
