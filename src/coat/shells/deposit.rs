//! Strands into voxels: lateral extinction, mean tangent and colour of each slab's texels.

use crate::data::shell::Slabs;
use crate::data::strands::Strands;
use crate::math::{Vec2, Vec3};
use rayon::prelude::*;
use std::ops::Range;

/// Batches that strands are deposited in.
const BATCHES: usize = 4;

/// How voxels lie.
#[derive(Clone, Debug, PartialEq)]
pub struct VoxelLayout {
    /// Texels along x and y.
    pub size: [usize; 2],
    /// Edge of a texel, m.
    pub texel_m: f32,
    /// Whether what leaves on one side comes in on the other, as on a tile; else it is gone.
    pub toroidal: bool,
    /// Slabs.
    pub slabs: Slabs,
    /// Height of the stack, m.
    pub height_m: f32,
}

impl VoxelLayout {
    /// A tile with `size` texels along its edge, its stack `height_m` high.
    pub fn tile(size: usize, slabs: Slabs, edge_m: f32, height_m: f32) -> Self {
        Self { size: [size, size], texel_m: edge_m / size as f32, toroidal: true, slabs, height_m }
    }

    /// Height of a slab, m.
    pub fn slab_m(&self, slab: usize) -> f32 {
        self.slabs.thickness(slab) * self.height_m
    }

    /// Texels of one slab.
    pub fn texels(&self) -> usize {
        self.size[0] * self.size[1]
    }

    /// The texel at column `x` and row `y`, if there is one.
    pub fn texel(&self, x: i64, y: i64) -> Option<usize> {
        let (width, height) = (self.size[0] as i64, self.size[1] as i64);
        let at = |x: i64, y: i64| (y * width + x) as usize;
        if self.toroidal {
            return Some(at(x.rem_euclid(width), y.rem_euclid(height)));
        }
        ((0..width).contains(&x) && (0..height).contains(&y)).then(|| at(x, y))
    }
}

/// Slabs of hair, `[slab][y][x]`, slab 0 at the skin.
#[derive(Clone, Debug)]
pub struct Voxels {
    /// How they lie.
    pub layout: VoxelLayout,
    /// A = Σ ℓ D / V, 1/m.
    pub extinction: Vec<f32>,
    /// Am = Σ ℓ D t / V, 1/m.
    pub tangent: Vec<Vec3>,
    /// Σ ℓ D colour / V, 1/m.
    pub colour: Vec<Vec3>,
}

impl Voxels {
    /// Empty voxels.
    pub fn new(layout: VoxelLayout) -> Self {
        let n = layout.texels() * layout.slabs.count();
        Self { layout, extinction: vec![0.0; n], tangent: vec![Vec3::ZERO; n], colour: vec![Vec3::ZERO; n] }
    }

    /// Adds another set with the same layout.
    fn add(&mut self, other: &Self) {
        self.extinction.iter_mut().zip(&other.extinction).for_each(|(a, b)| *a += b);
        self.tangent.iter_mut().zip(&other.tangent).for_each(|(a, b)| *a += *b);
        self.colour.iter_mut().zip(&other.colour).for_each(|(a, b)| *a += *b);
    }

    /// Strands deposited into empty voxels, a fixed number of batches side by side, so that the sums come
    /// out the same for any number of threads. See [`Self::deposit`].
    pub fn deposited(layout: &VoxelLayout, strands: &Strands, slopes: &[Vec2]) -> Self {
        let batch = strands.len().div_ceil(BATCHES).max(1);
        let batches: Vec<Self> = (0..BATCHES)
            .into_par_iter()
            .map(|b| {
                let mut voxels = Self::new(layout.clone());
                let range = (b * batch).min(strands.len())..((b + 1) * batch).min(strands.len());
                voxels.deposit(strands, range, slopes);
                voxels
            })
            .collect();
        let mut sum = Self::new(layout.clone());
        batches.iter().for_each(|voxels| sum.add(voxels));
        sum
    }

    /// Adds `weight` (1/m) of a segment to a texel of its slab.
    pub fn put(&mut self, segment: &VoxelSegment, texel: usize, weight: f32) {
        let index = segment.slab * self.layout.texels() + texel;
        self.extinction[index] += weight;
        self.tangent[index] += weight * segment.direction;
        self.colour[index] += weight * segment.colour;
    }

    /// Deposits the strands of `range`. Each segment goes where the mean strand through it, of slope `slopes[slab]`, crosses the slab's
    /// middle, spread over a square as wide as the hair (equal in area to its cross-section).
    fn deposit(&mut self, strands: &Strands, range: Range<usize>, slopes: &[Vec2]) {
        let layout = self.layout.clone();
        for strand in range {
            segments(strands, strand, &layout, slopes, |segment| {
                let width_m = segment.width_m(0.0);
                let amount = segment.length_m * segment.diameter_m * segment.opacity;
                let per_volume = amount / (layout.texel_m * layout.texel_m * layout.slab_m(segment.slab));
                splat(&layout, segment.at_m, width_m, per_volume, |texel, weight| {
                    self.put(segment, texel, weight);
                });
            });
        }
    }
}

/// A short segment of a strand, within one slab (nearly).
pub struct VoxelSegment {
    /// The slab.
    pub slab: usize,
    /// Where the mean strand through it crosses the slab's middle, m.
    pub at_m: Vec2,
    /// Its length, m.
    pub length_m: f32,
    /// Diameter in its middle, m.
    pub diameter_m: f32,
    /// How much thicker it is at its lower end than at its upper one, m.
    pub taper_m: f32,
    /// Whether the strand ends here.
    pub tip: bool,
    /// Opacity.
    pub opacity: f32,
    /// Unit vector along it.
    pub direction: Vec3,
    /// Colour.
    pub colour: Vec3,
}

impl VoxelSegment {
    /// Edge of the square that it is spread over: equal in area to its cross-section, or `least_m`.
    pub fn width_m(&self, least_m: f32) -> f32 {
        (0.886_227 * self.diameter_m).max(least_m)
    }
}

/// Cuts a strand into segments short enough that each lies in one slab and moves by at most half a texel.
pub fn segments(
    strands: &Strands,
    strand: usize,
    layout: &VoxelLayout,
    slopes: &[Vec2],
    mut each: impl FnMut(&VoxelSegment),
) {
    let segments = strands.points_per_strand - 1;
    let thinnest_m = (0..layout.slabs.count()).map(|slab| layout.slab_m(slab)).fold(f32::INFINITY, f32::min);
    let root_m = 2.0 * strands.root_radius_m[strand];
    for (i, pair) in strands.points_of_m(strand).windows(2).enumerate() {
        let along = pair[1] - pair[0];
        let direction = along.normalize_or_zero();
        if direction == Vec3::ZERO {
            continue;
        }
        let steps = (along.truncate().length() / (0.5 * layout.texel_m)).max(along.z.abs() / (0.25 * thinnest_m));
        let steps = steps.ceil().max(1.0);
        let taper_m = root_m * (1.0 - strands.profile.taper) / (steps * segments as f32);
        for step in 0..steps as usize {
            let t = (step as f32 + 0.5) / steps;
            let s = (i as f32 + t) / segments as f32;
            let at = pair[0] + along * t;
            let slab = layout.slabs.at(at.z / layout.height_m);
            let middle_m = layout.slabs.middle(slab) * layout.height_m;
            each(&VoxelSegment {
                slab,
                at_m: at.truncate() - slopes[slab] * (at.z - middle_m),
                length_m: along.length() / steps,
                diameter_m: root_m * strands.profile.radius_factor(s),
                taper_m,
                tip: i + 1 == segments && step + 1 == steps as usize,
                opacity: strands.profile.opacity_at(s),
                direction,
                colour: strands.tint[strand] * strands.profile.ramp_at(s),
            });
        }
    }
}

/// Spreads `amount` over a square of edge `width_m`: gives `each` every texel with what it covers of it.
pub fn splat(layout: &VoxelLayout, at_m: Vec2, width_m: f32, amount: f32, mut each: impl FnMut(usize, f32)) {
    let texel_m = layout.texel_m;
    let low = (at_m - 0.5 * width_m) / texel_m;
    let high = (at_m + 0.5 * width_m) / texel_m;
    let width = (width_m / texel_m).max(1e-6);
    let covered =
        |cell: i64, low: f32, high: f32| ((high.min(cell as f32 + 1.0) - low.max(cell as f32)) / width).clamp(0.0, 1.0);
    for y in low.y.floor() as i64..=high.y.floor() as i64 {
        for x in low.x.floor() as i64..=high.x.floor() as i64 {
            if let Some(texel) = layout.texel(x, y) {
                each(texel, amount * covered(x, low.x, high.x) * covered(y, low.y, high.y));
            }
        }
    }
}

/// Mean slope (dx, dy)/dz of strands in each slab, weighted as their extinction; 0 where there is none.
pub fn mean_slopes(strands: &Strands, slabs: &Slabs, height_m: f32) -> Vec<Vec2> {
    let mut sums = vec![Vec3::ZERO; slabs.count()];
    let segments = strands.points_per_strand - 1;
    for strand in 0..strands.len() {
        for (i, pair) in strands.points_of_m(strand).windows(2).enumerate() {
            let weight =
                strands.root_radius_m[strand] * strands.profile.radius_factor((i as f32 + 0.5) / segments as f32);
            let (low, high) = (pair[0].z.min(pair[1].z), pair[0].z.max(pair[1].z));
            let (first, last) = (slabs.at(low / height_m), slabs.at(high / height_m));
            for (slab, sum) in sums.iter_mut().enumerate().take(last + 1).skip(first) {
                let [bottom, top] = slabs.span(slab).map(|height| height * height_m);
                let top = if slab + 1 == slabs.count() { top.max(high) } else { top };
                let inside = (high.min(top) - low.max(bottom)).max(0.0);
                *sum += (pair[1] - pair[0]) * (weight * inside / (high - low).max(1e-12));
            }
        }
    }
    sums.into_iter().map(|s| if s.z > 0.0 { s.truncate() / s.z } else { Vec2::ZERO }).collect()
}
