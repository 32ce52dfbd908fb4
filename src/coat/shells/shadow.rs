//! Transmittance from outside: what of the light at 45°, averaged around, reaches the middle of each voxel.
//!
//! For a ray with √(1 − (ω·m)²) = |cos θ| the law is ∫ A dz + Σ κ; upright hair at 45° is that case. Other lights raise
//! it to the power √(1 − (l·m)²)/|cos θ|.

use super::deposit::Voxels;
use crate::math::Vec2;
use rayon::prelude::*;
use std::f32::consts::FRAC_1_SQRT_2;

/// Directions around the normal.
const AZIMUTHS: usize = 8;

/// T₀ per slab and texel, `[slab][y][x]`.
pub fn transmittance(voxels: &Voxels, ends: &[f32]) -> Vec<f32> {
    let n = voxels.size * voxels.size;
    (0..voxels.slabs * n).into_par_iter().map(|i| at_voxel(voxels, ends, i / n, i % n)).collect()
}

/// T₀ on the skin, `[y][x]`.
pub fn transmittance_at_skin(voxels: &Voxels, ends: &[f32]) -> Vec<f32> {
    let below = |texel: usize| mean_over_azimuths(|a| (-march(voxels, ends, 0, 0.0, texel, a)).exp());
    (0..voxels.size * voxels.size).into_par_iter().map(below).collect()
}

fn at_voxel(voxels: &Voxels, ends: &[f32], slab: usize, texel: usize) -> f32 {
    // Half of the own slab, then the slabs above.
    mean_over_azimuths(|a| (-march(voxels, ends, slab, 0.5, texel, a)).exp())
}

fn mean_over_azimuths(f: impl Fn(f32) -> f32) -> f32 {
    let turn = std::f32::consts::TAU / AZIMUTHS as f32;
    (0..AZIMUTHS).map(|i| f((i as f32 + 0.5) * turn)).sum::<f32>() / AZIMUTHS as f32
}

/// Optical depth at 45° towards `azimuth`, from height `skip` (in slabs) above the bottom of `slab` to the top.
fn march(voxels: &Voxels, ends: &[f32], slab: usize, skip: f32, texel: usize, azimuth: f32) -> f32 {
    let (sin, cos) = libm::sincosf(azimuth);
    let out = Vec2::new(cos, sin);
    let direction = (out * FRAC_1_SQRT_2).extend(FRAC_1_SQRT_2);
    let texel_m = voxels.edge_m / voxels.size as f32;
    let start = Vec2::new((texel % voxels.size) as f32, (texel / voxels.size) as f32) + 0.5;
    let mask = voxels.size as i64 - 1;
    let mut depth = 0.0;
    for s in slab..voxels.slabs {
        let part = if s == slab { 1.0 - skip } else { 1.0 };
        // Two samples a slab: at 45° a slab's run is often more than a texel.
        for half in [0.25, 0.75] {
            let rise = (s - slab) as f32 + if s == slab { skip + part * half } else { half } - skip;
            let p = start + out * (rise * voxels.slab_m / texel_m);
            let (x, y) = (p.x.floor() as i64 & mask, p.y.floor() as i64 & mask);
            let voxel = (s * voxels.size + y as usize) * voxels.size + x as usize;
            let (a, along) = (voxels.extinction[voxel], direction.dot(voxels.tangent[voxel]));
            let sides = (a * a - along * along).max(0.0).sqrt() * voxels.slab_m / FRAC_1_SQRT_2;
            depth += 0.5 * part * (sides + ends[voxel]);
        }
    }
    depth
}
