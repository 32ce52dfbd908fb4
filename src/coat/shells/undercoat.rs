//! Undercoat into voxels: no hairs, but what of the volume lies in each texel of a slab (`docs/steps/shells.md`).

use super::deposit::{VoxelLayout, Voxels};
use crate::math::{Vec2, Vec3};
use crate::volume::medium::Medium;
use std::f32::consts::FRAC_PI_4;

/// Parts that a slab's height is looked at in.
const PARTS: usize = 4;

/// Undercoat by height where it is as dense as the preset says: what stands over every texel alike.
#[derive(Clone, Debug)]
pub struct Profile {
    parts: Vec<SlabPart>,
    /// Length of the mean direction, so that the law is exact along the hair and across it.
    upright: f32,
}

/// A part of a slab's height.
#[derive(Clone, Copy, Debug)]
pub struct SlabPart {
    /// The slab.
    slab: usize,
    /// Height of its middle over the tallest hair's.
    pub t: f32,
    /// The same, m above the middle of the slab.
    pub above_m: f32,
    /// What it adds to the slab's A, 1/m.
    extinction: f32,
    /// What it adds to the slab's κ.
    ends: f32,
    colour: Vec3,
}

impl Profile {
    /// Of the slabs of a layout, whose textures show hair without its lean.
    pub fn new(medium: &Medium, layout: &VoxelLayout) -> Self {
        let undercoat = medium.undercoat();
        let per_m = undercoat.density_per_m2 * undercoat.stretch * undercoat.diameter_m / PARTS as f32;
        let end = undercoat.density_per_m2 * FRAC_PI_4 * undercoat.diameter_m * undercoat.diameter_m;
        let slabs = &layout.slabs;
        let part = |i: usize| {
            let (slab, n) = (i / PARTS, i % PARTS);
            let [bottom, drawn] = slabs.span(slab);
            // What stands out above the last slab belongs to it.
            let top = if slab + 1 == slabs.count() { 1.0 } else { drawn };
            let at_m = |part: f32| (bottom + (top - bottom) * (n as f32 + part) / PARTS as f32) * layout.height_m;
            let [low, t, high] = [0.0, 0.5, 1.0].map(|part| at_m(part) / undercoat.height_m);
            let held = (top - bottom) / (drawn - bottom);
            SlabPart {
                slab,
                t,
                above_m: at_m(0.5) - slabs.middle(slab) * layout.height_m,
                extinction: per_m * held * medium.reaching(t),
                ends: end * (medium.reaching(low) - medium.reaching(high)),
                colour: medium.colour(t.min(1.0)),
            }
        };
        let parts = (0..slabs.count() * PARTS).map(part).filter(|part| part.extinction > 0.0 || part.ends > 0.0);
        let along = undercoat.mean_sine(0.0);
        Self { parts: parts.collect(), upright: (1.0 - along * along).sqrt() }
    }

    /// Adds what stands over a texel: `amount` times as much as the preset says in each part, in colour times `tint`.
    pub fn fill(
        &self,
        voxels: &mut Voxels,
        ends: &mut [f32],
        texel: usize,
        tint: Vec3,
        amount: impl Fn(&SlabPart) -> f32,
    ) {
        for part in &self.parts {
            let amount = amount(part);
            let v = part.slab * voxels.layout.texels() + texel;
            let extinction = amount * part.extinction;
            voxels.extinction[v] += extinction;
            voxels.tangent[v].z += extinction * self.upright;
            voxels.colour[v] += extinction * part.colour * tint;
            ends[v] += amount * part.ends;
        }
    }
}

/// Adds a tile's undercoat. As with guard hair, a texel of a slab holds what lies along the mean strand of slope `slopes[slab]`
/// through it.
pub fn add(medium: &Medium, slopes: &[Vec2], voxels: &mut Voxels, ends: &mut [f32]) {
    let layout = voxels.layout.clone();
    let profile = Profile::new(medium, &layout);
    // As many places along a texel's edge as there are cells.
    let across = medium.cells().div_ceil(layout.size[0]);
    let share = 1.0 / (across * across) as f32;
    for texel in 0..layout.texels() {
        let corner = Vec2::new((texel % layout.size[0]) as f32, (texel / layout.size[0]) as f32);
        let places: Vec<Vec2> = (0..across * across)
            .map(|i| (Vec2::new((i % across) as f32, (i / across) as f32) + 0.5) / across as f32)
            .map(|within| (corner + within) * layout.texel_m)
            .collect();
        profile.fill(voxels, ends, texel, Vec3::ONE, |part| {
            let aside_m = slopes[part.slab] * part.above_m;
            places.iter().map(|&at_m| medium.crowding(at_m + aside_m, part.t)).sum::<f32>() * share
        });
    }
}
