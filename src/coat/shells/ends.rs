//! End opacity κ: what looking down the mean strand adds to the sides of the hairs. Each cross-section counts once over
//! the stack, in the slab where it is first hit.

use super::deposit::{Layout, Voxels, pieces, splat};
use crate::data::strands::Strands;
use crate::math::{Vec2, Vec3};
use crate::render::cast::Caster;
use crate::render::rays::{Ray, Rays};
use crate::render::{DepthRange, Scene};

/// Rays per texel edge.
const SUPERSAMPLING: usize = 4;

/// Straightens the mean strand: moves every point back by ∫ k dz.
fn straightened(strands: &Strands, slopes: &[Vec2], slab_m: f32) -> Strands {
    let mut starts = vec![Vec2::ZERO];
    for slope in slopes {
        starts.push(starts[starts.len() - 1] + *slope * slab_m);
    }
    let mut straight = strands.clone();
    for p in &mut straight.points_m {
        let slab = ((p.z / slab_m).max(0.0) as usize).min(slopes.len() - 1);
        let shift = starts[slab] + slopes[slab] * (p.z - slab as f32 * slab_m);
        *p -= shift.extend(0.0);
    }
    straight
}

/// κ of guard hair per voxel of a tile; `guard` holds its deposit alone.
pub fn guard_ends(strands: &Strands, guard: &Voxels, slopes: &[Vec2]) -> Vec<f32> {
    let layout = guard.layout;
    let (slab_m, edge_m) = (layout.slab_m, layout.texel_m * layout.size[0] as f32);
    let straight = straightened(strands, slopes, slab_m);
    let caster = Caster::new(Scene { guard: Some(&straight), torus_m: Some(edge_m), ..Scene::default() });
    let (size, fine) = (layout.size[0], layout.size[0] * SUPERSAMPLING);
    let top_m = slab_m * layout.slabs as f32;
    let mut above = vec![1.0_f32; fine * fine];
    let mut ends = vec![0.0; guard.extinction.len()];
    let per_texel = 1.0 / (SUPERSAMPLING * SUPERSAMPLING) as f32;
    for slab in (0..layout.slabs).rev() {
        let near_m = top_m - (slab + 1) as f32 * slab_m;
        let texel_of = |i: usize| i / fine / SUPERSAMPLING * size + i % fine / SUPERSAMPLING;
        // Only rays that are still open, over texels in which there is hair.
        let extinction = guard.slab(&guard.extinction, slab);
        let live: Vec<usize> = (0..fine * fine).filter(|&i| above[i] > 0.0 && extinction[texel_of(i)] > 0.0).collect();
        let ray = |&i: &usize| {
            let at = Vec2::new((i % fine) as f32 + 0.5, (i / fine) as f32 + 0.5) / fine as f32 * edge_m;
            Ray { origin_m: at.extend(top_m), direction: Vec3::NEG_Z }
        };
        let rays: Vec<Ray> = live.iter().map(ray).collect();
        let range = DepthRange { near_m, far_m: near_m + slab_m };
        let film = caster.render(&Rays::Texels { rays: &rays, size: [1, rays.len()] }, range);
        let mut open = vec![0.0_f32; size * size];
        let mut first = vec![0.0_f32; size * size];
        for (&i, &alpha) in live.iter().zip(&film.alpha) {
            open[texel_of(i)] += above[i] * per_texel;
            first[texel_of(i)] += above[i] * alpha * per_texel;
            above[i] *= 1.0 - alpha;
        }
        let down = slopes[slab].extend(1.0).normalize();
        for texel in 0..size * size {
            let voxel = slab * size * size + texel;
            if open[texel] < 0.5 * per_texel {
                continue;
            }
            // All rays of a texel hit says no more than that fewer than half a ray passes.
            let hit = (first[texel] / open[texel]).min(1.0 - 0.5 * per_texel);
            let (a, along) = (guard.extinction[voxel], down.dot(guard.tangent[voxel]));
            let sides = (a * a - along * along).max(0.0).sqrt() * slab_m / down.z;
            ends[voxel] = (-libm::log1pf(-hit) - sides).max(0.0);
        }
    }
    ends
}

/// Adds κ of undercoat: the end area of each hair at its tip, in the texel below it.
pub fn add_undercoat_ends(strands: &Strands, ends: &mut [f32], layout: &Layout) {
    let texel_m = layout.texel_m;
    for strand in 0..strands.len() {
        let Some(&tip) = strands.points_of_m(strand).last() else { continue };
        let slab = ((tip.z / layout.slab_m).max(0.0) as usize).min(layout.slabs - 1);
        let radius_m = strands.root_radius_m[strand] * strands.profile.radius_factor(1.0);
        let share = std::f32::consts::PI * radius_m * radius_m / (texel_m * texel_m);
        if let Some(texel) = layout.texel((tip.x / texel_m).floor() as i64, (tip.y / texel_m).floor() as i64) {
            ends[slab * layout.texels() + texel] += share;
        }
    }
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
    let layout = voxels.layout;
    let per_area = 0.25 * std::f32::consts::PI / (thinning * layout.texel_m * layout.texel_m);
    let per_volume = 1.0 / (layout.texel_m * layout.texel_m * layout.slab_m);
    for strand in 0..strands.len() {
        pieces(strands, strand, &layout, slopes, |piece| {
            let (low_m, high_m) = (piece.diameter_m + 0.5 * piece.taper_m, piece.diameter_m - 0.5 * piece.taper_m);
            let above_m = if piece.tip { 0.0 } else { high_m };
            let end = per_area * piece.opacity * (low_m * low_m - above_m * above_m).max(0.0);
            let side = per_volume * piece.length_m * piece.diameter_m * piece.opacity;
            splat(&layout, piece.at_m, piece.width_m(least_width_m), 1.0, |texel, share| {
                voxels.put(piece, texel, side * share);
                ends[piece.slab * layout.texels() + texel] += end * share;
            });
        });
    }
}
