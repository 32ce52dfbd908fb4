//! A film filled by rows of tiles, each by one thread.

use crate::data::film::Film;
use crate::math::Vec3;
use crate::render::bins::{Grid, TILE};
use crate::render::resolve::Pixel;
use rayon::prelude::*;

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
        self.radiance[at] = pixel.radiance;
        self.alpha[at] = pixel.alpha;
        self.depth_m[at] = pixel.z_m * depth_scale;
        self.albedo[at] = pixel.albedo;
        self.tangent[at] = pixel.tangent;
        self.normal[at] = pixel.normal;
        self.guard[at] = pixel.guard;
        self.undercoat[at] = pixel.undercoat;
    }
}

pub(super) fn film_rows<'a>(film: &'a mut Film, grid: &Grid) -> impl IndexedParallelIterator<Item = FilmRows<'a>> {
    let width = film.width;
    let (from, to) = (grid.first_row * TILE * width, ((grid.first_row + grid.rows) * TILE).min(film.height) * width);
    let size = TILE * width;
    (
        film.radiance[from..to].par_chunks_mut(size),
        film.alpha[from..to].par_chunks_mut(size),
        film.depth_m[from..to].par_chunks_mut(size),
        film.albedo[from..to].par_chunks_mut(size),
        film.tangent[from..to].par_chunks_mut(size),
        film.normal[from..to].par_chunks_mut(size),
        film.guard[from..to].par_chunks_mut(size),
        film.undercoat[from..to].par_chunks_mut(size),
    )
        .into_par_iter()
        .enumerate()
        .map(move |(row, (radiance, alpha, depth_m, albedo, tangent, normal, guard, undercoat))| FilmRows {
            row,
            width,
            radiance,
            alpha,
            depth_m,
            albedo,
            tangent,
            normal,
            guard,
            undercoat,
        })
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
