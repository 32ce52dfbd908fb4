//! Transmittance from outside: what of the light at 45°, averaged around, reaches the middle of each voxel.
//!
//! For a ray with √(1 − (ω·m)²) = |cos θ| the law is ∫ A dz + Σ κ; upright hair at 45° is that case. Other lights raise
//! it to the power √(1 − (l·m)²)/|cos θ|.

use super::deposit::Voxels;
use rayon::prelude::*;
use std::f32::consts::{FRAC_1_SQRT_2, TAU};

/// Directions around the normal.
const AZIMUTHS: usize = 8;

/// T₀ per slab and texel, `[slab][y][x]`, and on the skin, `[y][x]`.
pub fn transmittance(voxels: &Voxels, ends: &[f32]) -> (Vec<f32>, Vec<f32>) {
    let each: Vec<(Vec<f32>, Vec<f32>)> = (0..AZIMUTHS)
        .into_par_iter()
        .map(|i| towards(voxels, ends, (i as f32 + 0.5) * TAU / AZIMUTHS as f32))
        .collect();
    let share = 1.0 / AZIMUTHS as f32;
    let slabs = (0..voxels.extinction.len()).map(|v| each.iter().map(|e| e.0[v]).sum::<f32>() * share).collect();
    let skin = (0..voxels.layout.texels()).map(|v| each.iter().map(|e| e.1[v]).sum::<f32>() * share).collect();
    (slabs, skin)
}

/// Most places at which the hair that a ray crosses in a slab is looked at.
const MOST_PLACES: usize = 24;

/// The same for one azimuth. Goes down slab by slab: the optical depth above a voxel is that above the voxel which the
/// ray reaches one slab higher, plus that slab's own, which is the mean of the texels that the ray passes on its way through.
fn towards(voxels: &Voxels, ends: &[f32], azimuth_rad: f32) -> (Vec<f32>, Vec<f32>) {
    let (sin, cos) = libm::sincosf(azimuth_rad);
    let direction = crate::math::Vec3::new(cos, sin, 1.0) * FRAC_1_SQRT_2;
    let layout = voxels.layout;
    let [width, height] = layout.size.map(|edge| edge as i64);
    let run = layout.slab_m / layout.texel_m;
    // Whole texels, rounded so that the error does not add up over the slabs.
    let reach = |slabs: f32| ((cos * run * slabs).round() as i64, (sin * run * slabs).round() as i64);
    let shifted = |texel: usize, (dx, dy): (i64, i64)| {
        let (x, y) = (texel as i64 % width + dx, texel as i64 / width + dy);
        // Beyond the border of a chart hair goes on as it is at the border.
        layout.texel(x, y).unwrap_or((y.clamp(0, height - 1) * width + x.clamp(0, width - 1)) as usize)
    };
    // Shares of a slab's height at which it is looked at, and how far the ray has come by then. Not at the hair itself, which does
    // not stand in its own light.
    let places = (run.ceil() as usize).clamp(1, MOST_PLACES);
    let way = |from: f32, to: f32| -> Vec<(i64, i64)> {
        let at = |i: usize| from + (to - from) * (i as f32 + 0.5) / places as f32;
        let first = reach(from);
        (0..places).map(|i| reach(at(i))).map(|(x, y)| (x - first.0, y - first.1)).collect()
    };
    let mean = |own: &[f32], texel: usize, way: &[(i64, i64)]| {
        let apart = way.iter().filter(|&&step| step != (0, 0));
        let (sum, count) = apart.fold((0.0, 0), |(sum, count), &step| (sum + own[shifted(texel, step)], count + 1));
        if count > 0 { sum / count as f32 } else { own[texel] }
    };
    let n = layout.texels();
    let mut above = vec![0.0_f32; n];
    let mut result = vec![0.0; layout.slabs * n];
    for slab in (0..layout.slabs).rev() {
        let (low, middle, high) = (slab as f32, slab as f32 + 0.5, slab as f32 + 1.0);
        let step = |from: f32| (reach(high).0 - reach(from).0, reach(high).1 - reach(from).1);
        let (whole, half) = (way(low, high), way(middle, high));
        let own: Vec<f32> = (0..n)
            .map(|texel| {
                let v = slab * n + texel;
                let (a, along) = (voxels.extinction[v], direction.dot(voxels.tangent[v]));
                (a * a - along * along).max(0.0).sqrt() * layout.slab_m / FRAC_1_SQRT_2 + ends[v]
            })
            .collect();
        for texel in 0..n {
            let beyond = above[shifted(texel, step(middle))];
            result[slab * n + texel] = libm::expf(-0.5 * mean(&own, texel, &half) - beyond);
        }
        above = (0..n).map(|texel| mean(&own, texel, &whole) + above[shifted(texel, step(low))]).collect();
    }
    (result, above.into_iter().map(|t| libm::expf(-t)).collect())
}
