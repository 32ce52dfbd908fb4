//! Gains g(θ) per mip: what makes the stack's mean transmittance that of its strands at every angle.

use crate::cast::Caster;
use crate::cast::Geometry;
use crate::cast::Rays;
use crate::data::coat::{GAIN_ANGLES_DEG, Tile};
use crate::data::ray::DepthRange;
use crate::data::shell::{Incidence, Stack};
use crate::math::{Mat3, Vec2, Vec3};
use rayon::prelude::*;

/// Azimuths at which truth and stack are compared.
const AZIMUTHS: usize = 8;
/// Rays along a tile's edge per direction.
const RAYS: usize = 40;
/// Places along a tile's edge where the stack is evaluated, per direction.
const SPOTS: usize = 24;
/// Bounds of a gain: outside, texels too coarse to tell are at fault, not the law.
const BOUNDS: (f32, f32) = (0.1, 4.0);
/// Mean transmittance below which its ratio says nothing.
const BLACK: f64 = 2e-4;

/// Unit directions into the tile at `theta_deg`, evenly around.
pub fn directions(theta_deg: f32) -> impl Iterator<Item = Vec3> {
    let (sin, cos) = libm::sincosf(theta_deg.to_radians());
    let count = if theta_deg == 0.0 { 1 } else { AZIMUTHS };
    (0..count).map(move |i| {
        let (s, c) = libm::sincosf((i as f32 + 0.25) * std::f32::consts::TAU / AZIMUTHS as f32);
        Vec3::new(sin * c, sin * s, -cos)
    })
}

/// `n`, or more where there is one direction alone, so that every angle is judged at about as many places.
fn along_edge(theta_deg: f32, n: usize) -> usize {
    if theta_deg == 0.0 { 3 * n } else { n }
}

/// Mean transmittance at each of [`GAIN_ANGLES_DEG`] (in the tile) of strands mapped by `skin_from_tile`, which reach
/// up to `top_m` there.
pub fn strand_transmittance(scene: Geometry<'_>, edge_m: f32, top_m: f32, skin_from_tile: Mat3) -> [f64; 9] {
    let caster = Caster::new(scene);
    let mut black = false;
    GAIN_ANGLES_DEG.map(|theta| {
        // Rays only get longer with the angle.
        if black {
            return 0.0;
        }
        let each: Vec<f64> = directions(theta)
            .map(|in_tile| (skin_from_tile * in_tile).normalize())
            .map(|direction| {
                let n = along_edge(theta, RAYS);
                let rays = Rays::Tile { edge_m, top_m, direction, size: [n, n], supersampling: 1 };
                let far_m = top_m / -direction.z;
                caster.mean_transmittance(&rays, DepthRange { near_m: 0.0, far_m })
            })
            .collect();
        let mean = each.iter().sum::<f64>() / each.len() as f64;
        black = mean <= BLACK;
        mean
    })
}

/// Fits the gains of every mip of `tile`, mapped by `skin_from_tile`, to the truth.
pub fn fit(tile: &Tile, truth: &[f64; 9], skin_from_tile: Mat3) -> Vec<[f32; 9]> {
    let stack = Stack::new(tile);
    (0..stack.mips())
        .map(|mip| {
            let mut gains = [1.0; 9];
            let mut last = 1.0;
            for (i, (&theta, &target)) in GAIN_ANGLES_DEG.iter().zip(truth).enumerate() {
                // Where nothing passes, any gain does: keep the neighbour's, which varies slowly.
                if target > BLACK {
                    let depths = optical_depths(&stack, tile.shells.size >> mip, theta, skin_from_tile);
                    last = solve(&depths, target);
                }
                gains[i] = last;
            }
            gains
        })
        .collect()
}

/// Ungained optical depths seen through pixels as large as a texel of the mip with `size` texels.
fn optical_depths(stack: &Stack<'_>, size: u32, theta_deg: f32, skin_from_tile: Mat3) -> Vec<f32> {
    let n = along_edge(theta_deg, (size as usize).clamp(8, SPOTS));
    let seen: Vec<Incidence> = directions(theta_deg)
        .map(|in_tile| Incidence::new((skin_from_tile * in_tile).normalize(), skin_from_tile, 1.0 / size.max(1) as f32))
        .collect();
    (0..n * n)
        .into_par_iter()
        .flat_map_iter(|i| {
            let uv = Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32;
            seen.iter().map(move |seen| stack.optical_depth(uv, seen)).collect::<Vec<_>>()
        })
        .collect()
}

/// The gain g with mean e^(−g τ) = target: the mean falls monotonically in g, so halving finds it.
fn solve(depths: &[f32], target: f64) -> f32 {
    let mean = |g: f64| depths.iter().map(|&t| libm::exp(-g * f64::from(t))).sum::<f64>() / depths.len() as f64;
    let (mut low, mut high) = (f64::from(BOUNDS.0), f64::from(BOUNDS.1));
    for _ in 0..24 {
        let middle = 0.5 * (low + high);
        *(if mean(middle) > target { &mut low } else { &mut high }) = middle;
    }
    (0.5 * (low + high)) as f32
}
