//! A film filled by rows of tiles, each by one thread.

use crate::data::film::Film;
use crate::math::Vec3;
use crate::render::bins::{Grid, TILE};
use crate::render::resolve::Pixel;
use std::mem::take;
use std::ops::Range;

/// One row of tiles of a film, to be filled by one thread.
pub(super) struct FilmRows<'a> {
    /// Row of tiles within the band.
    pub(super) row: usize,
    width: usize,
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
    /// Depths are still weighted by alpha: passes add up, [`finish`] divides.
    pub(super) fn set(&mut self, y: usize, x: usize, pixel: &Pixel, depth_scale: f32) {
        let at = y * self.width + x;
        put(self.radiance, at, pixel.radiance);
        put(self.alpha, at, pixel.alpha);
        put(self.depth_m, at, pixel.z_m * depth_scale);
        put(self.albedo, at, pixel.albedo);
        put(self.tangent, at, pixel.tangent);
        put(self.normal, at, pixel.normal);
        put(self.guard, at, pixel.guard);
        put(self.undercoat, at, pixel.undercoat);
    }
}

/// Sets a pixel of a layer, where the film has it.
pub(in crate::render) fn put<T>(layer: &mut [T], at: usize, value: T) {
    if let Some(out) = layer.get_mut(at) {
        *out = value;
    }
}

pub(super) fn film_rows<'a>(film: &'a mut Film, grid: &Grid) -> Vec<FilmRows<'a>> {
    let width = film.width;
    let pixels = grid.first_row * TILE * width..((grid.first_row + grid.rows) * TILE).min(film.height) * width;
    let mut radiance = rows(&mut film.radiance, &pixels, width, grid.rows);
    let mut alpha = rows(&mut film.alpha, &pixels, width, grid.rows);
    let mut depth_m = rows(&mut film.depth_m, &pixels, width, grid.rows);
    let mut albedo = rows(&mut film.albedo, &pixels, width, grid.rows);
    let mut tangent = rows(&mut film.tangent, &pixels, width, grid.rows);
    let mut normal = rows(&mut film.normal, &pixels, width, grid.rows);
    let mut guard = rows(&mut film.guard, &pixels, width, grid.rows);
    let mut undercoat = rows(&mut film.undercoat, &pixels, width, grid.rows);
    (0..grid.rows)
        .map(|row| FilmRows {
            row,
            width,
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

/// A layer's pixels of each of `count` rows of tiles; none of a layer that the film does not have.
fn rows<'a, T>(layer: &'a mut [T], pixels: &Range<usize>, width: usize, count: usize) -> Vec<&'a mut [T]> {
    let mut rows: Vec<&mut [T]> = match layer.get_mut(pixels.clone()) {
        Some(layer) => layer.chunks_mut(TILE * width).collect(),
        None => Vec::new(),
    };
    rows.resize_with(count, Default::default);
    rows
}

/// Adds one pass to the sum of those before it.
pub(super) fn add(sum: &mut Film, film: &Film) {
    fn all<T: Copy + std::ops::AddAssign>(sum: &mut [T], values: &[T]) {
        sum.iter_mut().zip(values).for_each(|(s, &v)| *s += v);
    }
    all(&mut sum.radiance, &film.radiance);
    all(&mut sum.alpha, &film.alpha);
    all(&mut sum.depth_m, &film.depth_m);
    all(&mut sum.albedo, &film.albedo);
    all(&mut sum.tangent, &film.tangent);
    all(&mut sum.normal, &film.normal);
    all(&mut sum.guard, &film.guard);
    all(&mut sum.undercoat, &film.undercoat);
}

/// Scales sums over passes to means, and depths to means over what was hit.
pub(in crate::render) fn finish(film: &mut Film, scale: f32) {
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
