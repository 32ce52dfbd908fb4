//! How long passes took, by the device's own clock.

use super::Gpu;
use crate::error::Result;

/// Timestamps around a number of passes, picture after picture; measures nothing on adapters that have no clock.
pub struct Timer {
    clock: Option<Clock>,
    passes: u32,
}

/// Where timestamps are kept and how they come back.
struct Clock {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    readable: wgpu::Buffer,
}

impl Timer {
    /// A timer for `passes` passes.
    pub fn new(gpu: &Gpu, passes: u32) -> Self {
        let buffer = |usage| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("timer"),
                size: u64::from(passes) * 16,
                usage,
                mapped_at_creation: false,
            })
        };
        let able = gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY);
        let clock = able.then(|| Clock {
            queries: gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("timer"),
                ty: wgpu::QueryType::Timestamp,
                count: 2 * passes,
            }),
            resolved: buffer(wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC),
            readable: buffer(wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ),
        });
        Self { clock, passes }
    }

    /// What pass number `pass` writes.
    pub fn writes(&self, pass: u32) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        self.clock.as_ref().map(|clock| wgpu::RenderPassTimestampWrites {
            query_set: &clock.queries,
            beginning_of_pass_write_index: Some(2 * pass),
            end_of_pass_write_index: Some(2 * pass + 1),
        })
    }

    /// What the first and the last of several passes write that count as pass number `pass`.
    pub fn spanning(&self, pass: u32, first: bool, last: bool) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        let writes = self.writes(pass)?;
        (first || last).then_some(wgpu::RenderPassTimestampWrites {
            beginning_of_pass_write_index: writes.beginning_of_pass_write_index.filter(|_| first),
            end_of_pass_write_index: writes.end_of_pass_write_index.filter(|_| last),
            ..writes
        })
    }

    /// What compute pass number `pass` writes.
    pub fn compute_writes(&self, pass: u32) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        self.clock.as_ref().map(|clock| wgpu::ComputePassTimestampWrites {
            query_set: &clock.queries,
            beginning_of_pass_write_index: Some(2 * pass),
            end_of_pass_write_index: Some(2 * pass + 1),
        })
    }

    /// Ends the measuring: recorded after the last of the passes, into the same encoder.
    pub fn stop(&self, encoder: &mut wgpu::CommandEncoder) {
        if let Some(Clock { queries, resolved, readable }) = &self.clock {
            encoder.resolve_query_set(queries, 0..2 * self.passes, resolved, 0);
            encoder.copy_buffer_to_buffer(resolved, 0, readable, 0, readable.size());
        }
    }

    /// Milliseconds of each pass, once the passes were submitted and done; `None` where the adapter has no clock.
    ///
    /// # Errors
    /// As [`Gpu::read_buffer`].
    pub fn read_ms(&self, gpu: &Gpu) -> Result<Option<Vec<f64>>> {
        let Some(clock) = &self.clock else { return Ok(None) };
        let ticks: Vec<[u64; 2]> = bytemuck::pod_collect_to_vec(&gpu.read_buffer(&clock.readable)?);
        let ms_per_tick = f64::from(gpu.queue.get_timestamp_period()) * 1e-6;
        Ok(Some(ticks.iter().map(|[start, end]| end.saturating_sub(*start) as f64 * ms_per_tick).collect()))
    }
}
