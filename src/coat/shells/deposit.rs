//! Strands into voxels: lateral extinction, mean tangent and colour of each slab's texels.

use crate::data::strands::Strands;
use crate::math::{Vec2, Vec3};
use rayon::prelude::*;
use std::ops::Range;

/// Batches that strands are deposited in.
const BATCHES: usize = 4;

/// The slabs of a tile, `[slab][y][x]`, slab 0 at the skin.
#[derive(Clone, Debug)]
pub struct Voxels {
    /// Texels along the edge.
    pub size: usize,
    /// Slabs.
    pub slabs: usize,
    /// Edge of the tile, m.
    pub edge_m: f32,
    /// Height of one slab, m.
    pub slab_m: f32,
    /// A = Σ ℓ D / V, 1/m.
    pub extinction: Vec<f32>,
    /// Am = Σ ℓ D t / V, 1/m.
    pub tangent: Vec<Vec3>,
    /// Σ ℓ D colour / V, 1/m.
    pub colour: Vec<Vec3>,
}

impl Voxels {
    /// Empty voxels.
    pub fn new(size: usize, slabs: usize, edge_m: f32, height_m: f32) -> Self {
        let n = size * size * slabs;
        Self {
            size,
            slabs,
            edge_m,
            slab_m: height_m / slabs as f32,
            extinction: vec![0.0; n],
            tangent: vec![Vec3::ZERO; n],
            colour: vec![Vec3::ZERO; n],
        }
    }

    /// Adds another set with the same layout.
    pub fn add(&mut self, other: &Self) {
        self.extinction.iter_mut().zip(&other.extinction).for_each(|(a, b)| *a += b);
        self.tangent.iter_mut().zip(&other.tangent).for_each(|(a, b)| *a += *b);
        self.colour.iter_mut().zip(&other.colour).for_each(|(a, b)| *a += *b);
    }

    /// The part of an array that belongs to one slab.
    pub fn slab<'a, T>(&self, values: &'a [T], slab: usize) -> &'a [T] {
        let n = self.size * self.size;
        &values[slab * n..(slab + 1) * n]
    }

    /// Strands deposited into empty voxels of this layout, a fixed number of batches side by side, so that the sums come
    /// out the same for any number of threads. See [`Self::deposit`].
    pub fn deposited(&self, strands: &Strands, slopes: &[Vec2], least_width_m: f32) -> Self {
        let batch = strands.len().div_ceil(BATCHES).max(1);
        let batches: Vec<Self> = (0..BATCHES)
            .into_par_iter()
            .map(|b| {
                let mut voxels = Self::new(self.size, self.slabs, self.edge_m, self.slab_m * self.slabs as f32);
                let range = (b * batch).min(strands.len())..((b + 1) * batch).min(strands.len());
                voxels.deposit(strands, range, slopes, least_width_m);
                voxels
            })
            .collect();
        let mut sum = Self::new(self.size, self.slabs, self.edge_m, self.slab_m * self.slabs as f32);
        batches.iter().for_each(|voxels| sum.add(voxels));
        sum
    }

    /// Deposits the strands of `range`. Each piece goes where the mean strand through it, of slope `slopes[slab]`, crosses the slab's
    /// middle, spread over a square as wide as the hair (equal in area to its cross-section) or `least_width_m`.
    pub fn deposit(&mut self, strands: &Strands, range: Range<usize>, slopes: &[Vec2], least_width_m: f32) {
        let segments = strands.points_per_strand - 1;
        for strand in range {
            let points = strands.points_of_m(strand);
            for (i, pair) in points.windows(2).enumerate() {
                let along = pair[1] - pair[0];
                let direction = along.normalize_or_zero();
                if direction == Vec3::ZERO {
                    continue;
                }
                // Steps short enough that each lies in one slab (nearly) and moves by at most half a texel.
                let texel_m = self.edge_m / self.size as f32;
                let steps = (along.truncate().length() / (0.5 * texel_m)).max(along.z.abs() / (0.25 * self.slab_m));
                let steps = steps.ceil().max(1.0);
                for step in 0..steps as usize {
                    let t = (step as f32 + 0.5) / steps;
                    let s = (i as f32 + t) / segments as f32;
                    let diameter_m = 2.0 * strands.root_radius_m[strand] * strands.profile.radius_factor(s);
                    let at = pair[0] + along * t;
                    let slab = ((at.z / self.slab_m) as usize).min(self.slabs - 1);
                    let middle_m = (slab as f32 + 0.5) * self.slab_m;
                    let flat = at.truncate() - slopes[slab] * (at.z - middle_m);
                    let amount = along.length() / steps * diameter_m * strands.profile.opacity_at(s);
                    let colour = strands.tint[strand] * strands.profile.ramp_at(s);
                    let width_m = (0.886_227 * diameter_m).max(least_width_m);
                    self.splat(slab, flat, width_m, amount, direction, colour);
                }
            }
        }
    }

    /// Spreads `amount` (ℓ D, m²) over a square of edge `width_m`, each texel getting what it covers of it.
    fn splat(&mut self, slab: usize, at: Vec2, width_m: f32, amount: f32, direction: Vec3, colour: Vec3) {
        let texel_m = self.edge_m / self.size as f32;
        let per_volume = amount / (texel_m * texel_m * self.slab_m);
        let low = (at - 0.5 * width_m) / texel_m;
        let high = (at + 0.5 * width_m) / texel_m;
        let width = (width_m / texel_m).max(1e-6);
        let covered = |cell: i64, low: f32, high: f32| {
            ((high.min(cell as f32 + 1.0) - low.max(cell as f32)) / width).clamp(0.0, 1.0)
        };
        let size = self.size as i64;
        for y in low.y.floor() as i64..=high.y.floor() as i64 {
            for x in low.x.floor() as i64..=high.x.floor() as i64 {
                let weight = per_volume * covered(x, low.x, high.x) * covered(y, low.y, high.y);
                let index = (slab * self.size + y.rem_euclid(size) as usize) * self.size + x.rem_euclid(size) as usize;
                self.extinction[index] += weight;
                self.tangent[index] += weight * direction;
                self.colour[index] += weight * colour;
            }
        }
    }
}

/// Mean slope (dx, dy)/dz of strands in each slab, weighted as their extinction; 0 where there is none.
pub fn mean_slopes(strands: &Strands, slabs: usize, height_m: f32) -> Vec<Vec2> {
    let slab_m = height_m / slabs as f32;
    let mut sums = vec![Vec3::ZERO; slabs];
    let segments = strands.points_per_strand - 1;
    for strand in 0..strands.len() {
        for (i, pair) in strands.points_of_m(strand).windows(2).enumerate() {
            let weight =
                strands.root_radius_m[strand] * strands.profile.radius_factor((i as f32 + 0.5) / segments as f32);
            let (low, high) = (pair[0].z.min(pair[1].z), pair[0].z.max(pair[1].z));
            let (first, last) = ((low / slab_m).max(0.0) as usize, (high / slab_m).max(0.0) as usize);
            for (slab, sum) in sums.iter_mut().enumerate().take(last + 1).skip(first) {
                let inside = (high.min((slab + 1) as f32 * slab_m) - low.max(slab as f32 * slab_m)).max(0.0);
                *sum += (pair[1] - pair[0]) * (weight * inside / (high - low).max(1e-12));
            }
        }
    }
    sums.into_iter().map(|s| if s.z > 0.0 { s.truncate() / s.z } else { Vec2::ZERO }).collect()
}
