//! A film filled by rows of tiles, each by one thread.

use crate::data::film::Film;
use crate::hybrid::resolve::Pixel;
use crate::math::Vec3;
use crate::volume::bins::{TILE, TileGrid};
use std::mem::take;
use std::ops::AddAssign;
use std::ops::Range;

/// One row of tiles of a film, to be filled by one thread.
pub(super) struct FilmRows<'a> {
    /// Row of tiles within the band.
    pub(super) row: usize,
    width: usize,
    /// Samples along a pixel's edge.
    samples: usize,
    radiance: &'a mut [Vec3],
    alpha: &'a mut [f32],
    depth_m: &'a mut [f32],
    albedo: &'a mut [Vec3],
    tangent: &'a mut [Vec3],
    normal: &'a mut [Vec3],
    guard: &'a mut [f32],
    undercoat: &'a mut [f32],
}

impl FilmRows<'_> {
    /// Adds the sample in column `x` and, from the tiles' first one, row `y`: samples add up, [`finish`] divides. Depths are
    /// still weighted by alpha.
    pub(super) fn add(&mut self, y: usize, x: usize, sample: &Pixel, depth_scale: f32) {
        let at = y / self.samples * self.width + x / self.samples;
        add(self.radiance, at, sample.radiance);
        add(self.alpha, at, sample.alpha);
        add(self.depth_m, at, sample.z_m * depth_scale);
        add(self.albedo, at, sample.albedo);
        add(self.tangent, at, sample.tangent);
        add(self.normal, at, sample.normal);
        add(self.guard, at, sample.guard);
        add(self.undercoat, at, sample.undercoat);
    }
}

/// Adds to a pixel of a layer, where the film has it.
pub(in crate::hybrid) fn add<T: AddAssign>(layer: &mut [T], at: usize, value: T) {
    if let Some(out) = layer.get_mut(at) {
        *out += value;
    }
}

/// The rows of tiles of a band; of `samples` along a pixel's edge, which divide a tile.
pub(super) fn film_rows<'a>(film: &'a mut Film, grid: &TileGrid, samples: usize) -> Vec<FilmRows<'a>> {
    let (width, edge) = (film.width, TILE / samples);
    let pixels = grid.first_row * edge * width..((grid.first_row + grid.rows) * edge).min(film.height) * width;
    let mut radiance = rows(&mut film.radiance, &pixels, edge * width, grid.rows);
    let mut alpha = rows(&mut film.alpha, &pixels, edge * width, grid.rows);
    let mut depth_m = rows(&mut film.depth_m, &pixels, edge * width, grid.rows);
    let mut albedo = rows(&mut film.albedo, &pixels, edge * width, grid.rows);
    let mut tangent = rows(&mut film.tangent, &pixels, edge * width, grid.rows);
    let mut normal = rows(&mut film.normal, &pixels, edge * width, grid.rows);
    let mut guard = rows(&mut film.guard, &pixels, edge * width, grid.rows);
    let mut undercoat = rows(&mut film.undercoat, &pixels, edge * width, grid.rows);
    (0..grid.rows)
        .map(|row| FilmRows {
            row,
            width,
            samples,
            radiance: take(&mut radiance[row]),
            alpha: take(&mut alpha[row]),
            depth_m: take(&mut depth_m[row]),
            albedo: take(&mut albedo[row]),
            tangent: take(&mut tangent[row]),
            normal: take(&mut normal[row]),
            guard: take(&mut guard[row]),
            undercoat: take(&mut undercoat[row]),
        })
        .collect()
}

/// A layer's pixels of each of `count` rows of tiles of `size` pixels; none of a layer that the film does not have.
fn rows<'a, T>(layer: &'a mut [T], pixels: &Range<usize>, size: usize, count: usize) -> Vec<&'a mut [T]> {
    let mut rows: Vec<&mut [T]> = match layer.get_mut(pixels.clone()) {
        Some(layer) => layer.chunks_mut(size).collect(),
        None => Vec::new(),
    };
    rows.resize_with(count, Default::default);
    rows
}

/// Scales sums over samples to means, and depths to means over what was hit.
pub(in crate::hybrid) fn finish(film: &mut Film, edge_samples: usize) {
    let scale = 1.0 / (edge_samples * edge_samples) as f32;
    for (depth, &alpha) in film.depth_m.iter_mut().zip(&film.alpha) {
        *depth = if alpha > 0.0 { *depth / alpha } else { 0.0 };
    }
    if scale != 1.0 {
        for layer in [&mut film.radiance, &mut film.albedo, &mut film.tangent, &mut film.normal] {
            layer.iter_mut().for_each(|v| *v *= scale);
        }
        for layer in [&mut film.alpha, &mut film.guard, &mut film.undercoat] {
            layer.iter_mut().for_each(|v| *v *= scale);
        }
    }
}
