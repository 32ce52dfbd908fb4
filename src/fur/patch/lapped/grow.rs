//! Growth: triangles join from the seed outwards in an irregular outline, while the patch still lies flat.

use super::Surface;
use super::flatten::{Effort, flatten};
use super::patch::{FREE, Limits, Patch, fits};
use crate::data::topology::NO_NEIGHBOUR;
use crate::math::DVec2;
use crate::math::hash::{Stream, combine, unit_f32};
use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashSet};

/// What a triangle must keep to when it joins and after each flattening. Stretch may go beyond `measure::WITHIN`: the few
/// triangles there cost less than the seams that narrower limits bring. A wider angle makes patches fewer, shortens their
/// seams little, and costs stretch where the mesh is coarse (tables in `docs/steps/patch.md`).
const LIMITS: Limits = Limits { least: 0.65, most: 1.5, angle_rad: 0.2 };
/// Triangles joined between two flattenings: as many as the patch has, so that all flattenings together cost about
/// twice the last one.
const LEAST_BATCH: usize = 12;
/// A batch that brings less than this share of the patch is the last.
const ENOUGH: f64 = 0.05;
/// Triangles that a patch may have: keeps the time for large meshes proportional to their size, at 60 patches and more
/// for a million triangles.
const MOST_FACES: usize = 16_000;

/// Grows the patch `id` from `seed` over triangles that `owner` shows free, and enters them there.
pub(super) fn grow(surface: &Surface, seed: usize, id: u32, random: u64, owner: &mut [u32]) -> Patch {
    let mut patch = Patch::new(surface, seed, by_chance(random, seed));
    owner[seed] = id;
    let outline = Outline::new(random, seed);
    let mut refused = HashSet::new();
    loop {
        let before = patch.faces.len();
        let batch = LEAST_BATCH.max(before).min(MOST_FACES.saturating_sub(before));
        extend(surface, &mut patch, id, batch, &outline, &refused, owner);
        let added = patch.faces.len() - before;
        if added as f64 <= ENOUGH * before as f64 {
            break;
        }
        flatten(surface, &mut patch, Effort::Sketch);
        peel(surface, &mut patch, &mut refused, owner);
    }
    flatten(surface, &mut patch, Effort::Final);
    peel(surface, &mut patch, &mut refused, owner);
    patch
}

/// How a patch lies where there is no comb: neighbours shall not have a direction in common that shows.
fn by_chance(random: u64, seed: usize) -> DVec2 {
    let angle = f64::from(unit_f32(combine(combine(random, seed as u64), 0x7475_726e))) * std::f64::consts::TAU;
    DVec2::new(libm::cos(angle), libm::sin(angle))
}

/// Lets up to `batch` triangles join, nearest first.
fn extend(
    surface: &Surface,
    patch: &mut Patch,
    id: u32,
    batch: usize,
    outline: &Outline,
    refused: &HashSet<u32>,
    owner: &mut [u32],
) {
    let mut queue = BinaryHeap::new();
    let candidates = |patch: &Patch, slot: usize, owner: &[u32], queue: &mut BinaryHeap<Reverse<(u64, u32)>>| {
        let middle = patch.flat(slot).iter().sum::<DVec2>() / 3.0;
        // Positive floats order as their bits do.
        let priority = outline.distance(middle).to_bits();
        for k in 0..3 {
            let across = surface.topology.across[3 * patch.faces[slot] as usize + k];
            if across != NO_NEIGHBOUR && owner[across as usize / 3] == FREE && !refused.contains(&(across / 3)) {
                queue.push(Reverse((priority, across)));
            }
        }
    };
    for slot in 0..patch.faces.len() {
        candidates(patch, slot, owner, &mut queue);
    }
    let end = patch.faces.len() + batch;
    while patch.faces.len() < end
        && let Some(Reverse((_, edge))) = queue.pop()
    {
        let (t, k) = (edge as usize / 3, edge as usize % 3);
        if owner[t] == FREE
            && patch.has_room(surface, t, 1.0)
            && let Some(joining) = patch.joining(surface, t, k)
            && fits(surface, t, joining.uv, LIMITS)
        {
            patch.join(surface, t, &joining);
            owner[t] = id;
            candidates(patch, patch.faces.len() - 1, owner, &mut queue);
        }
    }
}

/// Takes triangles beyond the limits off the rim, again and again, and what thereby loses its way to the seed. Those
/// beyond the limits are refused for good.
fn peel(surface: &Surface, patch: &mut Patch, refused: &mut HashSet<u32>, owner: &mut [u32]) {
    let count = patch.faces.len();
    let bad: Vec<bool> = (0..count)
        .map(|slot| slot > 0 && !fits(surface, patch.faces[slot] as usize, patch.flat(slot), LIMITS))
        .collect();
    let mut keep = vec![true; count];
    let beside = |slot: usize| (0..3).map(move |k| (slot, k));
    let mut waiting: Vec<usize> = (0..count)
        .filter(|&slot| bad[slot] && beside(slot).any(|(s, k)| patch.beside(surface, s, k).is_none()))
        .collect();
    while let Some(slot) = waiting.pop() {
        if std::mem::replace(&mut keep[slot], false) {
            refused.insert(patch.faces[slot]);
            waiting
                .extend(beside(slot).filter_map(|(s, k)| patch.beside(surface, s, k)).filter(|&s| bad[s] && keep[s]));
        }
    }
    if keep.iter().all(|&k| k) {
        return;
    }
    let mut reached = vec![false; count];
    reached[0] = true;
    let mut waiting = vec![0];
    while let Some(slot) = waiting.pop() {
        for next in beside(slot).filter_map(|(s, k)| patch.beside(surface, s, k)) {
            if keep[next] && !std::mem::replace(&mut reached[next], true) {
                waiting.push(next);
            }
        }
    }
    for (slot, _) in reached.iter().enumerate().filter(|(_, reached)| !**reached) {
        owner[patch.faces[slot] as usize] = FREE;
    }
    patch.retain(surface, &reached);
}

/// A splotch: distances from the seed, longer in some directions than in others.
struct Outline {
    /// Amplitude and phase of waves 2, 3, 4, … around the seed.
    waves: [(f64, f64); 4],
}

impl Outline {
    fn new(random: u64, seed: usize) -> Self {
        let mut stream = Stream::new(combine(random, seed as u64));
        let waves = std::array::from_fn(|_| {
            (0.12 * f64::from(stream.unit()), f64::from(stream.unit()) * std::f64::consts::TAU)
        });
        Self { waves }
    }

    /// Distance from the seed in units of the outline's radius in that direction.
    fn distance(&self, p: DVec2) -> f64 {
        let angle = libm::atan2(p.y, p.x);
        let wave =
            |(i, (amplitude, phase)): (usize, &(f64, f64))| amplitude * libm::cos((i + 2) as f64 * angle + phase);
        p.length() / (1.0 + self.waves.iter().enumerate().map(wave).sum::<f64>())
    }
}
