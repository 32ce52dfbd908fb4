//! A picture of a pelt on a graphics device: the same steps as on the CPU, as compute passes (`shaders/render/`).
//!
//! A pass runs from the skin to the film without a look from the host. Lists that grow with the picture (where rays enter the
//! shell, stretches of undercoat, fragments of guard hair) are counted, then filled; where one was too short, the device
//! says how much it needs and the band is drawn again, with more room or fewer rows. Nothing is dropped.

mod band;
pub mod items;
pub mod kernels;
pub mod layout;
pub mod plan;
mod scene;

use super::march::volume::Volume;
use super::mean::MeanShadow;
use super::pelt::{Lighting, Pelt};
use super::picture::{Counts, Picture, Row, Settings, add, finish, subdivisions};
use super::resolve::Blending;
use crate::data::camera::Camera;
use crate::data::film::Film;
use crate::error::Result;
use crate::gpu::Gpu;
use crate::math::Vec3;
use band::{Band, STEPS};
use kernels::Kernels;
use plan::Plan;
use scene::GpuScene;
use std::time::Instant;

/// Renders a picture as [`super::picture::draw`] does, on a device, in bands whose buffers take at most `budget_bytes`.
///
/// # Errors
/// As [`super::picture::draw`]; [`crate::error::Kind::Device`] where the device fails, runs out of memory or cannot hold a row of
/// the picture.
pub fn draw(
    gpu: &Gpu,
    pelt: &Pelt<'_>,
    lighting: &Lighting,
    camera: &Camera,
    settings: &Settings,
    budget_bytes: usize,
) -> Result<Picture> {
    let view = settings.view(camera, pelt.skin.origin_m)?;
    let thinned = pelt.guard.and_then(|(strands, _)| settings.thinning(&view).of(strands));
    let guard = pelt.guard.map(|(strands, fibre)| (thinned.as_ref().unwrap_or(strands), fibre));
    let pelt = &Pelt { guard, ..*pelt };
    let mut picture = Picture { film: Film::default(), rows: Vec::new(), counts: Counts::default() };

    let start = Instant::now();
    let kernels = Kernels::new(gpu, matches!(settings.blending, Blending::Simplified { .. }))?;
    add_row(&mut picture, "kernels", Some(ms_since(start)), 0);

    let start = Instant::now();
    let normals = pelt.skin.smooth_normals();
    let subdivisions = subdivisions(pelt, &view, settings);
    let volume = Volume::new(pelt, &normals, lighting.key.to_light, settings.resolution, subdivisions);
    let mean = MeanShadow::new(pelt, lighting.key.to_light, settings.shadow_span);
    let (volume, mean) = (volume.as_ref(), mean.as_ref());
    let most_bytes = budget_bytes / 2;
    let scene = GpuScene::new(gpu, &kernels, pelt, lighting, settings, &normals, volume, mean, &view, most_bytes)?;
    let filled_ms = scene.fill_ms.as_ref().map_or(0.0, |ms| ms.iter().sum());
    add_row(&mut picture, "shell", Some(ms_since(start) - filled_ms), scene.bytes[0]);
    for (i, name) in ["densities", "shadows"].into_iter().enumerate() {
        add_row(&mut picture, name, scene.fill_ms.as_ref().map(|ms| ms[i]), scene.stored_bytes[i]);
    }

    let largest = gpu.largest_storage_bytes() as usize;
    let mut plan = Plan::new(view.size, budget_bytes, largest);
    let mut band = Band::new(gpu, &kernels, &scene, plan.room)?;
    let lit = band.light(gpu, &kernels, &scene, &view)?;
    add_row(&mut picture, "shaded strands", lit, scene.bytes[1]);
    picture.film = Film::of_layers(settings.size[0], settings.size[1], settings.layers);
    let height = view.size[1];
    let mut row = 0;
    while row < height {
        let rows = [row as u32, (row + plan.rows).min(height) as u32];
        let drawn = band.draw(gpu, &kernels, &scene, &view, rows)?;
        if drawn.totals.overflow != 0 {
            plan = plan.grown(&drawn.totals)?;
            drop(band);
            band = Band::new(gpu, &kernels, &scene, plan.room)?;
            continue;
        }
        for (i, name) in STEPS.into_iter().enumerate() {
            add_row(&mut picture, name, drawn.ms.as_ref().map(|ms| ms[i]), room_bytes(&plan, i));
        }
        picture.counts.fragments += u64::from(drawn.totals.fragments);
        picture.counts.steps += u64::from(drawn.totals.steps);
        unpack(&mut picture.film, settings.edge_samples(), row, &drawn.film);
        row = rows[1] as usize;
    }
    picture.counts.strands = scene.strand_count as u64;
    picture.counts.pieces = scene.piece_count as u64;
    picture.counts.subelements = scene.stored_bytes[0] as u64;
    finish(&mut picture.film, settings.edge_samples());
    Ok(picture)
}

fn ms_since(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}

/// Bytes that a step of a band fills.
fn room_bytes(plan: &Plan, step: usize) -> usize {
    let room = &plan.room;
    match STEPS[step] {
        "base mesh" => 8 * room.pixels,
        "shell entrances" => 12 * room.pixels + band::START_BYTES * room.starts,
        "march" => 8 * room.pixels + band::STRETCH_BYTES * room.stretches,
        "explicit raster" => band::FRAGMENT_BYTES * room.fragments,
        _ => band::FILM_BYTES * room.pixels,
    }
}

fn add_row(picture: &mut Picture, name: &'static str, ms: Option<f64>, bytes: usize) {
    let ms = ms.unwrap_or(0.0);
    match picture.rows.iter_mut().find(|row| row.name == name) {
        Some(row) => {
            row.ms += ms;
            row.bytes = row.bytes.max(bytes);
        }
        None => picture.rows.push(Row { name, ms, bytes }),
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
