//! Depth of field after the fact: a film's layers by depth, each blurred by its circle of confusion (`docs/steps/film.md`).

use super::projection::Projection;
use crate::data::film::Film;
use crate::math::{DVec4, Vec2};
use rayon::prelude::*;

/// Height of the sensor that f-numbers refer to: that of 35 mm film, m.
pub const SENSOR_HEIGHT_M: f32 = 0.024;

/// Most layers.
const MOST_LAYERS: f32 = 32.0;
/// Least part of a layer that must be seen at a pixel to be believed; below, its surroundings speak too.
const BELIEVED: f64 = 0.05;

/// A thin lens in place of a pinhole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Diameter of the opening, m.
    pub aperture_m: f32,
    /// Depth along the optical axis that is sharp, m.
    pub focus_m: f32,
}

impl Lens {
    /// Of an f-number, on a camera of 35 mm film with this vertical field of view.
    pub fn of_f_number(f_number: f32, vfov_rad: f32, focus_m: f32) -> Self {
        let focal_m = 0.5 * SENSOR_HEIGHT_M / libm::tanf(0.5 * vfov_rad);
        Self { aperture_m: focal_m / f_number, focus_m }
    }

    /// Radius of the circle of confusion at depth `z_m`, px: negative in front of what is sharp. `focal_px` is the distance
    /// of the picture's plane in pixels.
    ///
    /// The thin lens gives a circle of diameter A |v₁ − v₂|/v₂ on a sensor at v₁, where 1/v = 1/f − 1/z; with a pixel of
    /// v₁/focal_px that is A focal_px |1/focus − 1/z|, whatever f is.
    pub fn radius_px(&self, focal_px: f32, z_m: f32) -> f32 {
        0.5 * self.aperture_m * focal_px * (1.0 / self.focus_m - 1.0 / z_m)
    }
}

/// Radiance and alpha of `film` as a lens would have them; its other layers stay sharp.
///
/// What lies at one circle of confusion forms a layer. A layer is known where nothing stands before it; under what does, it
/// is continued from around. Layers are blurred one by one and put over each other, so that what is sharp takes nothing
/// from what is blurred behind it, and what is blurred in front does not thin out what it hides.
pub fn defocus(film: &Film, view: &Projection, lens: &Lens) -> Film {
    let radii: Vec<f32> = (0..film.alpha.len()).map(|i| radius_px(film, view, lens, i)).collect();
    let covered = || radii.iter().zip(&film.alpha).filter(|&(_, &alpha)| alpha > 0.0).map(|(&r, _)| r);
    let (low, high) = covered().fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), r| (low.min(r), high.max(r)));
    if !(low.is_finite() && high.is_finite()) || low.abs().max(high.abs()) < 0.05 {
        return film.clone();
    }
    let spacing = ((high - low) / (MOST_LAYERS - 1.0)).max(1.0);
    let count = ((high - low) / spacing).ceil() as usize + 1;
    let mut front = vec![DVec4::ZERO; film.alpha.len()];
    // What is left of the pixels as drawn, once the layers so far are taken off.
    let mut through = vec![1.0_f64; film.alpha.len()];
    for layer in 0..count {
        let radius = low + layer as f32 * spacing;
        let share = |i: usize| (1.0 - (radii[i] - radius).abs() / spacing).max(0.0);
        let own = |i: usize| (film.radiance[i] * share(i)).extend(film.alpha[i] * share(i)).as_dvec4();
        let seen: Vec<DVec4> = (0..radii.len()).map(own).collect();
        let whole = continued(&seen, &through, film.width, film.height);
        let blurred = blur(&whole, film.width, film.height, f64::from(radius.abs()));
        for (sum, value) in front.iter_mut().zip(blurred) {
            *sum += value * (1.0 - sum.w).max(0.0);
        }
        through.iter_mut().zip(&seen).for_each(|(left, seen)| *left = (*left - seen.w).max(0.0));
    }
    let mut out = film.clone();
    for (i, value) in front.into_iter().enumerate() {
        let value = value.as_vec4();
        out.radiance[i] = value.truncate();
        out.alpha[i] = value.w.min(1.0);
    }
    out
}

/// Depth of what stands in the middle of the picture, m: the median over its covered pixels; none where there are none.
pub fn middle_depth_m(film: &Film, view: &Projection) -> Option<f32> {
    let span = |size: usize| (size * 9 / 20)..(size * 11 / 20).max(size * 9 / 20 + 1).min(size);
    let mut depths: Vec<f32> = span(film.height)
        .flat_map(|y| span(film.width).map(move |x| y * film.width + x))
        .filter(|&i| film.alpha[i] > 0.5)
        .map(|i| depth_m(film, view, i))
        .collect();
    let middle = depths.len() / 2;
    (!depths.is_empty()).then(|| *depths.select_nth_unstable_by(middle, f32::total_cmp).1)
}

/// Depth along the optical axis, from the film's distance along the ray, m.
fn depth_m(film: &Film, view: &Projection, i: usize) -> f32 {
    let middle = Vec2::new((i % film.width) as f32 + 0.5, (i / film.width) as f32 + 0.5);
    film.depth_m[i] / view.direction(middle).length()
}

fn radius_px(film: &Film, view: &Projection, lens: &Lens, i: usize) -> f32 {
    if film.alpha[i] > 0.0 { lens.radius_px(view.focal_px, depth_m(film, view, i).max(view.near_m)) } else { 0.0 }
}

/// A layer freed of what hides it: `seen` over how much of it could be seen (`through`), and where that is nothing, what is
/// around (push and pull over a pyramid, Gortler et al. 1996).
fn continued(seen: &[DVec4], through: &[f64], width: usize, height: usize) -> Vec<DVec4> {
    let around = if width.max(height) > 1 {
        let (half_width, half_height) = (width.div_ceil(2), height.div_ceil(2));
        let mut coarse = vec![DVec4::ZERO; half_width * half_height];
        let mut weights = vec![0.0; coarse.len()];
        for i in 0..seen.len() {
            let at = i / width / 2 * half_width + i % width / 2;
            coarse[at] += seen[i];
            weights[at] += through[i];
        }
        // More than one pixel's worth is enough to know: then nothing needs to come from further off.
        for (value, weight) in coarse.iter_mut().zip(&mut weights) {
            let scale = 1.0 / weight.max(1.0);
            *value *= scale;
            *weight *= scale;
        }
        if weights.iter().all(|&w| w >= BELIEVED) || weights.iter().all(|&w| w == 0.0) {
            coarse.iter_mut().zip(&weights).for_each(|(value, &w)| *value /= w.max(1e-12));
            coarse
        } else {
            continued(&coarse, &weights, half_width, half_height)
        }
    } else {
        vec![DVec4::ZERO]
    };
    let half_width = width.div_ceil(2);
    (0..seen.len())
        .map(|i| {
            let trust = (through[i] / BELIEVED).min(1.0);
            let own = if through[i] > 0.0 { seen[i] / through[i].max(seen[i].w) } else { DVec4::ZERO };
            if trust >= 1.0 {
                own
            } else {
                own * trust + around[i / width / 2 * half_width + i % width / 2] * (1.0 - trust)
            }
        })
        .collect()
}

/// Spreads every pixel over a disc.
fn blur(values: &[DVec4], width: usize, height: usize, radius: f64) -> Vec<DVec4> {
    if radius < 0.25 || values.iter().all(|v| v.w == 0.0) {
        return values.to_vec();
    }
    // Sums of each row up to a place, so that a run of pixels is a difference.
    let sums: Vec<DVec4> = values
        .par_chunks(width)
        .flat_map_iter(|row| {
            let mut sum = DVec4::ZERO;
            std::iter::once(sum).chain(row.iter().map(move |&v| {
                sum += v;
                sum
            }))
        })
        .collect();
    let reach = (radius + 0.5).floor() as isize;
    // Half the disc's width in each row of pixels, averaged over the row's height.
    let area_up_to = |y: f64| {
        let y = y.clamp(-radius, radius);
        0.5 * (y * (radius * radius - y * y).sqrt() + radius * radius * libm::asin(y / radius))
    };
    let halves: Vec<f64> =
        (-reach..=reach).map(|dy| area_up_to(dy as f64 + 0.5) - area_up_to(dy as f64 - 0.5)).collect();
    let mut out = vec![DVec4::ZERO; values.len()];
    out.par_chunks_mut(width).enumerate().for_each(|(y, row)| {
        // How much of each disc lies in the picture: what is beyond its edge is taken to be like what is inside.
        let mut within = vec![0.0; width];
        for (dy, &half) in (-reach..=reach).zip(&halves) {
            let source = y as isize + dy;
            if source < 0 || source >= height as isize {
                continue;
            }
            let sums = &sums[source as usize * (width + 1)..][..width + 1];
            let up_to = |x: f64| {
                let left = (x as usize).min(width - 1);
                sums[left].lerp(sums[left + 1], x - left as f64)
            };
            for (x, (value, within)) in row.iter_mut().zip(&mut within).enumerate() {
                let middle = x as f64 + 0.5;
                let (from, to) = ((middle - half).max(0.0), (middle + half).min(width as f64));
                *value += up_to(to) - up_to(from);
                *within += to - from;
            }
        }
        row.iter_mut().zip(within).for_each(|(value, within)| *value /= within);
    });
    out
}
