//! End opacity κ: what looking down the mean strand adds to the sides of the hairs. Each cross-section counts once over
//! the stack, in the slab where it is first hit.

use super::deposit::{VoxelLayout, Voxels, segments, splat};
use crate::cast::Caster;
use crate::cast::Geometry;
use crate::cast::Rays;
use crate::data::strands::Strands;
use crate::math::{Vec2, Vec3};

/// Rays per texel edge.
const RAYS: usize = 4;

/// How far the mean strand has gone aside where it enters each slab, ∫ k dz, m.
fn starts_m(slopes: &[Vec2], layout: &VoxelLayout) -> Vec<Vec2> {
    let passed =
        |at: &mut Vec2, (slab, slope): (usize, &Vec2)| Some(std::mem::replace(at, *at + *slope * layout.slab_m(slab)));
    slopes.iter().enumerate().scan(Vec2::ZERO, passed).collect()
}

/// Straightens the mean strand: moves every point back by ∫ k dz.
fn straightened(strands: &Strands, slopes: &[Vec2], starts_m: &[Vec2], layout: &VoxelLayout) -> Strands {
    let mut straight = strands.clone();
    for p in &mut straight.points_m {
        let slab = layout.slabs.at(p.z / layout.height_m);
        let shift = starts_m[slab] + slopes[slab] * (p.z - layout.slabs.span(slab)[0] * layout.height_m);
        *p -= shift.extend(0.0);
    }
    straight
}

/// κ of guard hair per voxel of a tile; `guard` holds its deposit alone.
pub fn guard_ends(strands: &Strands, guard: &Voxels, slopes: &[Vec2]) -> Vec<f32> {
    let layout = &guard.layout;
    let edge_m = layout.texel_m * layout.size[0] as f32;
    let starts_m = starts_m(slopes, layout);
    let straight = straightened(strands, slopes, &starts_m, layout);
    let caster = Caster::new(Geometry { guard: Some(&straight), torus_m: Some(edge_m), ..Geometry::default() });
    let (size, fine) = (layout.size[0], layout.size[0] * RAYS);
    let (top_m, slabs) = (layout.height_m, layout.slabs.count());
    let rays = Rays::Tile { edge_m, top_m, direction: Vec3::NEG_Z, size: [fine, fine], supersampling: 1 };
    // From the top down: what each slab is the first to block.
    let ends_m: Vec<f32> = (0..slabs).rev().map(|slab| top_m - layout.slabs.span(slab)[0] * top_m).collect();
    let blocked = caster.first_blocked(&rays, &ends_m);
    let mut above = vec![1.0_f32; fine * fine];
    let mut ends = vec![0.0; guard.extinction.len()];
    let half_a_ray = 0.5 / (RAYS * RAYS) as f32;
    for (below, slab) in (0..slabs).rev().enumerate() {
        // Where the mean strand of a ray crosses the slab's middle: there its texel is.
        let aside = (starts_m[slab] + slopes[slab] * (0.5 * layout.slab_m(slab))) / edge_m * fine as f32;
        let aside = [aside.x, aside.y].map(|a| a.round() as i64);
        let (mut open, mut first) = (vec![0.0_f32; size * size], vec![0.0_f32; size * size]);
        for (i, above) in above.iter_mut().enumerate() {
            let [x, y] = [i % fine, i / fine].map(|c| c as i64);
            let [x, y] = [x + aside[0], y + aside[1]].map(|c| c.rem_euclid(fine as i64) as usize / RAYS);
            let own = blocked[i * slabs + below];
            open[y * size + x] += *above * (2.0 * half_a_ray);
            first[y * size + x] += own * (2.0 * half_a_ray);
            *above = (*above - own).max(0.0);
        }
        let down = slopes[slab].extend(1.0).normalize();
        for texel in 0..size * size {
            let voxel = slab * size * size + texel;
            if open[texel] < half_a_ray || guard.extinction[voxel] <= 0.0 {
                continue;
            }
            // All rays of a texel hit says no more than that fewer than half a ray passes.
            let hit = (first[texel] / open[texel]).min(1.0 - half_a_ray);
            let (a, along) = (guard.extinction[voxel], down.dot(guard.tangent[voxel]));
            let sides = (a * a - along * along).max(0.0).sqrt() * layout.slab_m(slab) / down.z;
            ends[voxel] = (-libm::log1pf(-hit) - sides).max(0.0);
        }
    }
    ends
}

/// Deposits hair that is fine against a texel and adds its κ to `ends`: what each cross-section adds to those above it, by their
/// areas. Hairs hide one another at random, so areas add up in the exponent. Each strand stands for `thinning` hairs: it is
/// as many times thicker. See [`Voxels::deposit`].
pub fn deposit_with_ends(
    strands: &Strands,
    slopes: &[Vec2],
    (least_width_m, thinning): (f32, f32),
    voxels: &mut Voxels,
    ends: &mut [f32],
) {
    let layout = voxels.layout.clone();
    let per_area = 0.25 * std::f32::consts::PI / (thinning * layout.texel_m * layout.texel_m);
    for strand in 0..strands.len() {
        segments(strands, strand, &layout, slopes, |segment| {
            let (low_m, high_m) =
                (segment.diameter_m + 0.5 * segment.taper_m, segment.diameter_m - 0.5 * segment.taper_m);
            let above_m = if segment.tip { 0.0 } else { high_m };
            let end = per_area * segment.opacity * (low_m * low_m - above_m * above_m).max(0.0);
            let per_volume = 1.0 / (layout.texel_m * layout.texel_m * layout.slab_m(segment.slab));
            let side = per_volume * segment.length_m * segment.diameter_m * segment.opacity;
            splat(&layout, segment.at_m, segment.width_m(least_width_m), 1.0, |texel, share| {
                voxels.put(segment, texel, side * share);
                ends[segment.slab * layout.texels() + texel] += end * share;
            });
        });
    }
}
