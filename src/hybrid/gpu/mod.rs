//! A picture of a scene on a graphics device: the same steps as on the CPU, as compute passes (`shaders/hybrid/`).
//!
//! A pass runs from the skin to the film without a look from the host. Lists that grow with the picture (where rays enter the
//! shell, virtual fragments of undercoat, fragments of guard hair) are counted, then filled; where one was too short, the device
//! says how much it needs and the band is drawn again, with more room or fewer rows. Nothing is dropped.

mod band;
mod constants;
pub mod items;
pub mod kernels;
pub mod layout;
pub mod plan;
mod resident;
mod seen;

use super::cpu::{add, finish};
use super::picture::Picture;
use super::prepared::Prepared;
use super::resolve::Blending;
use crate::data::camera::Camera;
use crate::data::film::Film;
use crate::error::Result;
use crate::gpu::Gpu;
use crate::math::Vec3;
use crate::metrics::timing::Steps;
use band::{BandBuffers, STEPS};
use kernels::Kernels;
use plan::Plan;
use resident::Resident;
use seen::Seen;
use std::time::Instant;

/// A graphics device with a scene and the kernels that draw it: what does not hang on the camera.
pub struct GpuRenderer<'a> {
    gpu: &'a Gpu,
    prepared: &'a Prepared<'a>,
    kernels: Kernels,
    resident: Resident,
    steps: Steps,
}

/// Makes a device ready to draw a scene.
///
/// # Errors
/// [`crate::error::Kind::Device`] where the device does not take the kernels, or something does not fit it.
pub fn prepare<'a>(gpu: &'a Gpu, prepared: &'a Prepared<'a>) -> Result<GpuRenderer<'a>> {
    let start = Instant::now();
    let kernels = Kernels::new(gpu, matches!(prepared.settings.blending, Blending::Simplified { .. }))?;
    let mut steps = Steps::default();
    steps.add_since("kernels", start, 0);
    let start = Instant::now();
    let resident = Resident::new(gpu, prepared)?;
    steps.add_since("shell", start, resident.bytes);
    Ok(GpuRenderer { gpu, prepared, kernels, resident, steps })
}

impl GpuRenderer<'_> {
    /// Draws what [`Prepared::draw_alone`] draws, in bands whose buffers take at most `budget_bytes`.
    ///
    /// # Errors
    /// As [`Prepared::draw`]; [`crate::error::Kind::Device`] where the device fails, runs out of memory or cannot hold a row of
    /// the picture.
    pub fn draw(&self, camera: &Camera, budget_bytes: usize) -> Result<Picture> {
        let Self { gpu, prepared, kernels, .. } = self;
        let settings = &prepared.settings;
        let mut picture = Picture { steps: self.steps.followed_by(&prepared.steps), ..Picture::default() };

        let start = Instant::now();
        let view = settings.view(camera, prepared.scene.skin.origin_m)?;
        let volume = prepared.volume(&view);
        let seen = Seen::new(self, volume.as_ref(), &view, budget_bytes / 2)?;
        let filled_ms = seen.fill_ms.as_ref().map_or(0.0, |ms| ms.iter().sum());
        picture.steps.add("shell", ms_since(start) - filled_ms, seen.bytes[0] as u64);
        for (i, name) in ["densities", "shadows"].into_iter().enumerate() {
            let ms = seen.fill_ms.as_ref().map_or(0.0, |ms| ms[i]);
            picture.steps.add(name, ms, seen.stored_bytes[i] as u64);
        }

        let largest = gpu.largest_storage_bytes() as usize;
        let mut plan = Plan::new(view.size, budget_bytes, largest);
        let mut band = BandBuffers::new(gpu, kernels, &seen, plan.room)?;
        let lit_ms = band.light(gpu, kernels, &seen, &view)?;
        picture.steps.add("shaded strands", lit_ms.unwrap_or(0.0), seen.bytes[1] as u64);
        picture.film = Film::of_layers(settings.size[0], settings.size[1], settings.layers);
        let height = view.size[1];
        let mut row = 0;
        while row < height {
            let rows = [row as u32, (row + plan.rows).min(height) as u32];
            let drawn = band.draw(gpu, kernels, &seen, &view, rows)?;
            if drawn.totals.overflow != 0 {
                plan = plan.grown(&drawn.totals)?;
                drop(band);
                band = BandBuffers::new(gpu, kernels, &seen, plan.room)?;
                continue;
            }
            for (i, name) in STEPS.into_iter().enumerate() {
                let ms = drawn.ms.as_ref().map_or(0.0, |ms| ms[i]);
                picture.steps.add(name, ms, room_bytes(&plan, i) as u64);
            }
            picture.counts.fragments += u64::from(drawn.totals.fragments);
            picture.counts.steps += u64::from(drawn.totals.steps);
            unpack(&mut picture.film, settings.edge_samples(), row, &drawn.film);
            row = rows[1] as usize;
        }
        picture.counts.strands = seen.strand_count as u64;
        picture.counts.segments = seen.segment_count as u64;
        picture.counts.subelements = seen.stored_bytes[0] as u64;
        finish(&mut picture.film, settings.edge_samples());
        Ok(picture)
    }
}

fn ms_since(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}

/// Bytes that a step of a band fills.
fn room_bytes(plan: &Plan, step: usize) -> usize {
    let room = &plan.room;
    match STEPS[step] {
        "base mesh" => 8 * room.pixels,
        "shell entrances" => 12 * room.pixels + plan::START_BYTES * room.starts,
        "march" => 8 * room.pixels + plan::VIRTUAL_FRAGMENT_BYTES * room.virtual_fragments,
        "explicit raster" => plan::FRAGMENT_BYTES * room.fragments,
        _ => plan::FILM_BYTES * room.pixels,
    }
}

/// Adds the samples of a band, four planes of them, to a film's pixels from the samples' row `first` on.
fn unpack(film: &mut Film, edge_samples: usize, first: usize, planes: &[[f32; 4]]) {
    let count = planes.len() / 4;
    let width = film.width * edge_samples;
    let rgb = |v: &[f32; 4]| Vec3::new(v[0], v[1], v[2]);
    for i in 0..count {
        let at = (first + i / width) / edge_samples * film.width + i % width / edge_samples;
        let [radiance, albedo, tangent, normal] = [0, 1, 2, 3].map(|plane| &planes[plane * count + i]);
        add(&mut film.radiance, at, rgb(radiance));
        add(&mut film.alpha, at, radiance[3]);
        add(&mut film.albedo, at, rgb(albedo));
        add(&mut film.depth_m, at, albedo[3]);
        add(&mut film.tangent, at, rgb(tangent));
        add(&mut film.guard, at, tangent[3]);
        add(&mut film.normal, at, rgb(normal));
        add(&mut film.undercoat, at, normal[3]);
    }
}
