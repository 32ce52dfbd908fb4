//! One band of rows: its buffers, and the passes that draw it.

use super::kernels::Kernels;
use super::layout::{Totals, ViewUniform};
use super::plan::{FILM_BYTES, Room, START_BYTES, VIRTUAL_FRAGMENT_BYTES};
use super::seen::Seen;
use crate::error::Result;
use crate::gpu::{Gpu, Timer};
use crate::stage::projection::Projection;

/// The device's steps in the order of their timestamps.
pub(super) const STEPS: [&str; 5] = ["base mesh", "shell entrances", "march", "explicit raster", "compositing"];

/// Buffers with room for a band.
pub(super) struct BandBuffers {
    view: wgpu::Buffer,
    totals: wgpu::Buffer,
    pixels: [wgpu::Buffer; 6],
    film: wgpu::Buffer,
    frame: wgpu::BindGroup,
    entrances: wgpu::BindGroup,
    march: wgpu::BindGroup,
    guard: wgpu::BindGroup,
    order: wgpu::BindGroup,
    composite: wgpu::BindGroup,
    poison: wgpu::BindGroup,
    log_radiance: wgpu::BindGroup,
    room: Room,
}

/// A band as drawn, and what it came to.
pub(super) struct DrawnBand {
    /// Four planes of four numbers per pixel, as `hybrid/composite.wgsl` describes.
    pub film: Vec<[f32; 4]>,
    /// What the band came to.
    pub totals: Totals,
    /// Time of each of [`STEPS`], ms; none without a clock.
    pub ms: Option<Vec<f64>>,
}

impl BandBuffers {
    /// Makes the buffers.
    ///
    /// # Errors
    /// [`crate::error::Kind::Device`] where one is too large.
    pub(super) fn new(gpu: &Gpu, kernels: &Kernels, seen: &Seen, room: Room) -> Result<Self> {
        let pixel = |label, bytes| gpu.storage(label, room.pixels, bytes);
        let view = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("view"),
            size: size_of::<ViewUniform>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let totals = gpu.storage("totals", 1, size_of::<Totals>())?;
        let pixels = [
            pixel("skin depth", 4)?,
            pixel("skin triangle", 4)?,
            pixel("opaque depth", 4)?,
            pixel("first virtual fragment", 4)?,
            pixel("spans", 8)?,
            pixel("cursors", 4)?,
        ];
        let film = pixel("film", FILM_BYTES)?;
        let starts = gpu.storage("starts", room.starts, START_BYTES)?;
        let virtual_fragments = gpu.storage("virtual_fragments", room.virtual_fragments, VIRTUAL_FRAGMENT_BYTES)?;
        let fragment = |label| gpu.storage(label, room.fragments, 4);
        let [z, point, share, pixel, order] = [
            fragment("fragment depths")?,
            fragment("fragment points")?,
            fragment("fragment shares")?,
            fragment("fragment pixels")?,
            fragment("fragment order")?,
        ];
        let layouts = &kernels.layouts;
        let mut of_frame = vec![&view, &totals];
        of_frame.extend(&pixels);
        Ok(Self {
            frame: gpu.group(&layouts.frame, &of_frame),
            entrances: gpu.group(&layouts.entrances, &[&seen.faces, &starts]),
            march: gpu.group(&layouts.march, &[&seen.faces, &starts, &seen.inside, &virtual_fragments]),
            guard: gpu.group(&layouts.guard, &[&z, &point, &share, &pixel]),
            order: gpu.group(&layouts.order, &[&z, &point, &pixel, &order]),
            composite: gpu.group(
                &layouts.composite,
                &[&z, &point, &share, &order, &virtual_fragments, &seen.log_radiance, &film],
            ),
            poison: gpu.group(&layouts.one, &[&film]),
            log_radiance: gpu.group(&layouts.one, &[&seen.log_radiance]),
            view,
            totals,
            pixels,
            film,
            room,
        })
    }

    /// Lights the guard hair. What it looks like depends on the eye alone, so once serves all bands.
    ///
    /// # Errors
    /// As [`Gpu::finish`].
    pub(super) fn light(&self, gpu: &Gpu, kernels: &Kernels, seen: &Seen, view: &Projection) -> Result<Option<f64>> {
        gpu.queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&ViewUniform::new(view, [0, 0])));
        let timer = Timer::new(gpu, 1);
        let mut encoder = gpu.encoder("light");
        let groups = [&seen.group, &seen.volume, &self.frame, &self.log_radiance];
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some("light"),
                timestamp_writes: timer.compute_writes(0),
            });
            kernels.strands.dispatch(&mut pass, &groups, seen.strand_count.div_ceil(64));
        }
        timer.stop(&mut encoder);
        gpu.finish(encoder)?;
        Ok(timer.read_ms(gpu)?.map(|ms| ms[0]))
    }

    /// Draws `rows` of the picture.
    ///
    /// # Errors
    /// As [`Gpu::finish`].
    pub(super) fn draw(
        &self,
        gpu: &Gpu,
        kernels: &Kernels,
        seen: &Seen,
        view: &Projection,
        rows: [u32; 2],
    ) -> Result<DrawnBand> {
        let pixels = (rows[1] - rows[0]) as usize * view.size[0];
        let totals_bytes = size_of::<Totals>() as u64;
        let film_bytes = (pixels * FILM_BYTES) as u64;
        let read = |label, size| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
                mapped_at_creation: false,
            })
        };
        let read_totals = read("read totals", totals_bytes);
        let read_film = read("read film", film_bytes);
        let timer = Timer::new(gpu, STEPS.len() as u32);
        let uniform = ViewUniform {
            most_starts: self.room.starts as u32,
            most_fragments: self.room.fragments as u32,
            most_virtual_fragments: self.room.virtual_fragments as u32,
            ..ViewUniform::new(view, rows)
        };
        gpu.queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&uniform));
        let mut encoder = gpu.encoder("band");
        self.record(&mut encoder, kernels, seen, pixels, |step| timer.compute_writes(step));
        timer.stop(&mut encoder);
        encoder.copy_buffer_to_buffer(&self.totals, 0, &read_totals, 0, totals_bytes);
        encoder.copy_buffer_to_buffer(&self.film, 0, &read_film, 0, film_bytes);
        gpu.finish(encoder)?;
        Ok(DrawnBand {
            film: bytemuck::pod_collect_to_vec(&gpu.read_buffer(&read_film)?),
            totals: bytemuck::pod_read_unaligned(&gpu.read_buffer(&read_totals)?),
            ms: timer.read_ms(gpu)?,
        })
    }

    fn record<'a>(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        kernels: &Kernels,
        seen: &Seen,
        pixels: usize,
        writes: impl Fn(u32) -> Option<wgpu::ComputePassTimestampWrites<'a>>,
    ) {
        let [skin_depth, skin_triangle, .., cursors] = &self.pixels;
        for buffer in [&self.totals, skin_depth, skin_triangle, cursors] {
            encoder.clear_buffer(buffer, 0, None);
        }
        let common = [&seen.group, &seen.volume, &self.frame];
        let own = |group3| [common[0], common[1], common[2], group3];
        let (by_256, by_64) = (pixels.div_ceil(256), pixels.div_ceil(64));
        let begin = |encoder: &mut wgpu::CommandEncoder, step: usize, record: &dyn Fn(&mut wgpu::ComputePass<'_>)| {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some(STEPS[step]),
                timestamp_writes: writes(step as u32),
            });
            record(&mut pass);
        };
        begin(encoder, 0, &|pass| {
            for kernel in &kernels.skin {
                kernel.dispatch(pass, &common, seen.triangle_count);
            }
        });
        begin(encoder, 1, &|pass| {
            kernels.entrances[0].dispatch(pass, &own(&self.entrances), seen.face_count);
            kernels.allot[0].dispatch(pass, &common, by_256);
            kernels.entrances[1].dispatch(pass, &own(&self.entrances), seen.face_count);
        });
        begin(encoder, 2, &|pass| {
            kernels.march.dispatch(pass, &own(&self.march), by_64);
        });
        encoder.clear_buffer(cursors, 0, None);
        begin(encoder, 3, &|pass| {
            kernels.guard[0].dispatch(pass, &own(&self.guard), seen.segment_count.div_ceil(64));
            kernels.allot[1].dispatch(pass, &common, by_256);
            kernels.guard[1].dispatch(pass, &own(&self.guard), seen.segment_count.div_ceil(64));
            kernels.trim.dispatch(pass, &own(&self.guard), by_64);
            // More threads than fragments: how many there are is not known here.
            kernels.order.dispatch(pass, &own(&self.order), self.room.fragments.div_ceil(64));
        });
        begin(encoder, 4, &|pass| {
            kernels.poison.dispatch(pass, &own(&self.poison), (4 * pixels).div_ceil(64));
            kernels.composite.dispatch(pass, &own(&self.composite), by_64);
        });
    }
}
