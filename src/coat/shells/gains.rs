//! Gains g(θ) per mip and layer: what makes the eye see as far into the stack as into its strands, at every angle.

use crate::cast::Caster;
use crate::cast::Geometry;
use crate::cast::Rays;
use crate::data::coat::{GAIN_ANGLES_DEG, Tile};
use crate::data::shell::{Incidence, Slabs, Stack};
use crate::math::{Mat3, Vec2, Vec3};
use rayon::prelude::*;

/// Azimuths at which truth and stack are compared.
const AZIMUTHS: usize = 8;
/// Rays along a tile's edge per direction, of a dense coat and of one that skin is seen through.
const RAYS: [usize; 2] = [16, 40];
/// Rays along a tile's edge per direction of a draft.
const DRAFT_RAYS: usize = 5;
/// Places along a tile's edge where the stack is evaluated, per direction, likewise.
const SPOTS: [usize; 2] = [16, 24];
/// Share of the skin that is seen through a thin coat.
const THIN: f64 = 0.01;
/// Bounds of a gain: outside, texels too coarse to tell are at fault, not the law.
const BOUNDS: (f64, f64) = (0.1, 4.0);
/// Least variance of what a ray passes.
const BLACK: f64 = 2e-4;
/// Rays that tell as much as all that are cast: many pass between the same hairs.
const TOLD_BY: f64 = 1000.0;
/// By how much gains differ from slab to slab, as a rule.
const LIKE: f64 = 0.3;
/// Optical depth without gains behind which nothing is looked at.
const UNSEEN: f32 = 20.0;
/// Most steps to a gain.
const STEPS: usize = 12;

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

/// What is seen through strands: how deep into stacks.
pub struct Truth {
    /// Bottoms of slabs, over the stack's height, the highest first.
    bottoms: Vec<f32>,
    /// Mean transmittance from outside to each, at each of [`GAIN_ANGLES_DEG`] (in the tile).
    through: [Vec<f64>; 9],
}

impl Truth {
    /// Of strands mapped by `skin_from_tile`, which reach up to `top_m` there, down to the bottoms of all slabs of `cuts`. A `draft` casts a few
    /// rays.
    pub fn new(
        scene: Geometry<'_>,
        (edge_m, top_m): (f32, f32),
        cuts: &[Slabs],
        skin_from_tile: Mat3,
        draft: bool,
    ) -> Self {
        let of = |cut: &Slabs| (0..cut.count()).map(|slab| cut.span(slab)[0]).collect::<Vec<_>>();
        let mut bottoms: Vec<f32> = cuts.iter().flat_map(of).collect();
        bottoms.sort_by(|a, b| b.total_cmp(a));
        bottoms.dedup();
        let caster = Caster::new(scene);
        let mean = |theta: f32, rays: usize| {
            let mut mean = vec![0.0; bottoms.len()];
            let around: Vec<Vec3> = directions(theta).map(|in_tile| (skin_from_tile * in_tile).normalize()).collect();
            for &direction in &around {
                let n = along_edge(theta, rays);
                let rays = Rays::Tile { edge_m, top_m, direction, size: [n, n], supersampling: 1 };
                let ends_m: Vec<f32> = bottoms.iter().map(|bottom| (1.0 - bottom) * top_m / -direction.z).collect();
                let through = caster.seen_through(&rays, &ends_m);
                mean.iter_mut().zip(&through).for_each(|(mean, through)| *mean += through / around.len() as f64);
            }
            mean
        };
        let through = GAIN_ANGLES_DEG.map(|theta| {
            if draft {
                return mean(theta, DRAFT_RAYS);
            }
            let few = mean(theta, RAYS[0]);
            if is_thin(few.last()) { mean(theta, RAYS[1]) } else { few }
        });
        Self { bottoms, through }
    }

    /// Down to the bottoms of one of the cuts, the lowest first.
    pub fn of(&self, cut: &Slabs) -> [Vec<f64>; 9] {
        let deeper = |bottom: f32| self.bottoms.partition_point(|other| *other > bottom);
        let at: Vec<usize> = (0..cut.count()).map(|slab| deeper(cut.span(slab)[0])).collect();
        self.through.each_ref().map(|through| at.iter().map(|&i| through[i]).collect())
    }
}

/// Whether skin is seen through all of it: then it is worth to look closer.
fn is_thin(to_skin: Option<&f64>) -> bool {
    to_skin.is_some_and(|&skin| skin > THIN)
}

/// Fits the gains of every mip and layer of `tile`, mapped by `skin_from_tile`, to the truth. What is seen down to a slab's bottom is
/// made right from the outermost slab on.
pub fn fit(tile: &Tile, truth: &[Vec<f64>; 9], skin_from_tile: Mat3) -> Vec<Vec<[f32; 9]>> {
    let stack = Stack::new(tile);
    let angles = GAIN_ANGLES_DEG.len();
    let fitted: Vec<Vec<f32>> = (0..stack.mips() * angles)
        .into_par_iter()
        .map(|i| {
            let (mip, angle) = (i / angles, i % angles);
            let truth = &truth[angle];
            let size = tile.shells.size >> mip;
            let spots = (size as usize).clamp(8, SPOTS[usize::from(is_thin(truth.first()))]);
            let in_tiles = directions(GAIN_ANGLES_DEG[angle]);
            let seen: Vec<Incidence> = in_tiles
                .map(|d| Incidence::new((skin_from_tile * d).normalize(), skin_from_tile, 1.0 / size.max(1) as f32))
                .collect();
            solve(&slab_depths(&stack, &seen, along_edge(GAIN_ANGLES_DEG[angle], spots)), truth)
        })
        .collect();
    let of_layer = |mip: usize, slab: usize| std::array::from_fn(|angle| fitted[mip * angles + angle][slab]);
    (0..stack.mips())
        .map(|mip| std::iter::once([1.0; 9]).chain((0..truth[0].len()).map(|slab| of_layer(mip, slab))).collect())
        .collect()
}

/// Ungained optical depths of slabs seen at `n`² places of each view: `[slab][place]`, the lowest first.
fn slab_depths(stack: &Stack<'_>, views: &[Incidence], n: usize) -> Vec<Vec<f32>> {
    let mut depths = vec![vec![0.0; n * n * views.len()]; stack.slabs()];
    for (view, seen) in views.iter().enumerate() {
        for i in 0..n * n {
            let uv = Vec2::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5) / n as f32;
            let mut sum = 0.0;
            for (layer, depth) in stack.slab_depths(uv, seen) {
                depths[layer - 1][view * n * n + i] = depth;
                sum += depth;
                // Whatever the gains, nothing is seen of what lies deeper.
                if sum > UNSEEN {
                    break;
                }
            }
        }
    }
    depths
}

/// Gains of slabs, with which as much is seen through all down to each as the truth says. Where next to nothing is hidden or next to
/// nothing passes, rays cannot tell: the gain is then near that of the slab above. Last all are scaled so that as much skin is seen.
fn solve(depths: &[Vec<f32>], truth: &[f64]) -> Vec<f32> {
    let places = depths.first().map_or(0, Vec::len);
    let mut through = vec![1.0_f32; places];
    let mut sums = vec![0.0_f32; places];
    let mut gains = vec![1.0; depths.len()];
    let mut above = 1.0;
    for (slab, depths) in depths.iter().enumerate().rev() {
        let target = truth[slab];
        let noise = (target * (1.0 - target)).max(BLACK) / TOLD_BY;
        let mut gain: f64 = above;
        for _ in 0..STEPS {
            let (mut mean, mut slope) = (0.0, 0.0);
            for (through, depth) in through.iter().zip(depths) {
                let left = f64::from(through * libm::expf(-(gain as f32) * depth));
                mean += left;
                slope -= left * f64::from(*depth);
            }
            let [mean, slope] = [mean, slope].map(|sum| sum / places as f64);
            // Least squares of what is seen and of the step from slab to slab.
            let pull = slope * (mean - target) / noise + (gain - above) / (LIKE * LIKE);
            let step = pull / (slope * slope / noise + 1.0 / (LIKE * LIKE));
            gain = (gain - step).clamp(BOUNDS.0, BOUNDS.1);
            if step.abs() < 1e-4 {
                break;
            }
        }
        for ((through, sum), depth) in through.iter_mut().zip(&mut sums).zip(depths) {
            *through *= libm::expf(-(gain as f32) * depth);
            *sum += gain as f32 * depth;
        }
        gains[slab] = gain as f32;
        above = gain;
    }
    let scale = if is_thin(truth.first()) { scale(&sums, truth[0]) } else { 1.0 };
    gains.into_iter().map(|gain| gain * scale).collect()
}

/// The factor g with mean e^(−g τ) = target: the mean falls monotonically in g, so halving finds it.
fn scale(depths: &[f32], target: f64) -> f32 {
    let mean = |g: f64| depths.iter().map(|&t| libm::exp(-g * f64::from(t))).sum::<f64>() / depths.len() as f64;
    let (mut low, mut high) = BOUNDS;
    for _ in 0..24 {
        let middle = 0.5 * (low + high);
        *(if mean(middle) > target { &mut low } else { &mut high }) = middle;
    }
    (0.5 * (low + high)) as f32
}
