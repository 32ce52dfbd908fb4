//! One line of a pixel: what is seen on it, hair and undercoat in exact order.
//!
//! The line is cut where hairs begin and cease to be seen; each part is looked through at a random point of it, so that a cut
//! too few adds noise and no bias. Undercoat and skin change slowly: a part of the line takes them from one random point.

use super::along::{Along, ViewLeft};
use super::bvh::DRay;
use super::guard::{Candidate, Crossing, GuardCones, Strip};
use super::lens::{PARTS, PinholePixel};
use super::line::Line;
use super::medium::DMedium;
use super::point::DShellPoint;
use super::skin::SkinBvh;
use crate::math::hash::Stream;

/// What is seen.
#[derive(Clone, Copy, Debug)]
pub enum Seen {
    /// A guard hair.
    Guard {
        /// Which.
        strand: u32,
        /// Where along it, in its points.
        along_strand: f64,
    },
    /// Undercoat.
    Undercoat(DShellPoint),
    /// Skin.
    Skin(DShellPoint),
}

/// What rays may meet.
#[derive(Debug)]
pub struct Tracer<'a> {
    /// Skin.
    pub skin: &'a SkinBvh,
    /// Guard hair.
    pub guard: Option<&'a GuardCones<'a>>,
    /// Undercoat.
    pub medium: Option<&'a DMedium<'a>>,
}

/// How much of a strip has been seen, and that times where along its hair.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    share: f64,
    alongs: f64,
}

/// Lists that a thread keeps for their memory.
#[derive(Debug, Default)]
pub struct Scratch {
    strips: Vec<Strip>,
    tallies: Vec<Tally>,
    /// Strips of the part of the line that is looked at, nearest first.
    active: Vec<u32>,
    /// Hairs entered but not passed yet, farthest first, and those that are passed.
    waiting: Vec<(Crossing, u32)>,
    passed: Vec<Crossing>,
    /// All that is seen on a line, along which ray, and which share of the line it takes.
    seen: Vec<(Seen, DRay, f64)>,
    /// How far the line was looked along, m: infinite where part of it passes all.
    line_reached_m: f64,
    /// Of a pixel: its hair, nearest first, whether lines are columns, and how far they were looked along so far, m.
    candidates: Vec<Candidate>,
    column: bool,
    reached_m: Option<f64>,
}

/// Pieces of hair that tell how the hair of a pixel lies.
const TELLING: usize = 24;

/// Of the depth that a pixel's lines were looked along so far, by how much more hair is looked for.
const BEYOND: f64 = 0.1;

impl Tracer<'_> {
    /// Begins with a pixel; tells whether hair lies rather along its rows than along its columns, so that columns cut it
    /// shorter.
    pub fn begin(&self, pixel: &PinholePixel<'_>, scratch: &mut Scratch) -> bool {
        (scratch.reached_m, scratch.column) = (None, false);
        let Some(guard) = self.guard else { return false };
        guard.candidates(pixel, &mut scratch.candidates);
        let mut ways = [0.0_f64; 2];
        let steps = [pixel.row(0.5).step, pixel.column(0.5).step];
        for candidate in scratch.candidates.iter().take(TELLING) {
            let way = guard.way(candidate);
            (0..2).for_each(|i| ways[i] += way.dot(steps[i]).abs());
        }
        scratch.column = ways[0] > ways[1];
        scratch.column
    }

    /// Calls `visit` with all that is seen on the line at `at` of the pixel that was begun with, the ray that it is seen along
    /// and which share of the line it takes; gives Σ share × distance. Undercoat and skin are looked for at these points of
    /// it, one in each part.
    pub fn line(
        &self,
        line: &Line,
        at: f64,
        points: &[f64; PARTS],
        key: u64,
        scratch: &mut Scratch,
        mut visit: impl FnMut(&Seen, &DRay, f64),
    ) -> f64 {
        let parts = points.map(|x| Along::new(line.ray(x), self.skin));
        // Hair is looked for somewhat beyond where earlier lines of the pixel ended; seldom, that is too near.
        let nearest_m = scratch.candidates.first().map_or(0.0, |candidate| candidate.near_m);
        let far_m = scratch.reached_m.map_or(f64::INFINITY, |reached_m| reached_m + BEYOND * (reached_m - nearest_m));
        let mut depth_m = self.look_along(line, at, parts.clone(), key, far_m, scratch);
        if scratch.line_reached_m > far_m {
            depth_m = self.look_along(line, at, parts, key, f64::INFINITY, scratch);
        }
        scratch.reached_m = Some(scratch.reached_m.unwrap_or(0.0).max(scratch.line_reached_m));
        for (seen, ray, share) in &scratch.seen {
            visit(seen, ray, *share);
        }
        depth_m
    }

    /// Fills the list of all that is seen on a line, where hair beyond `hair_m` is left out.
    fn look_along(
        &self,
        line: &Line,
        at_line: f64,
        mut parts: [Along; PARTS],
        key: u64,
        hair_m: f64,
        scratch: &mut Scratch,
    ) -> f64 {
        let mut random = Stream::new(key);
        let mut unit = || f64::from(random.unit());
        scratch.strips.clear();
        scratch.active.clear();
        scratch.seen.clear();
        scratch.line_reached_m = 0.0;
        if let Some(guard) = self.guard {
            let far_m = parts.iter().map(Along::far_m).fold(0.0, f64::max) * 1.001;
            let Scratch { strips, candidates, column, .. } = &mut *scratch;
            guard.strips(line, *column, at_line, candidates, far_m.min(hair_m), strips);
        }
        scratch.tallies.clear();
        scratch.tallies.resize(scratch.strips.len(), Tally::default());
        let (mut at, mut next, mut opaque_m, mut depth_m) = (0.0, 0, f64::INFINITY, 0.0);
        for (i, part) in parts.iter_mut().enumerate() {
            let end = (i + 1) as f64 / PARTS as f64;
            while at < end {
                let Scratch { strips, active, .. } = &mut *scratch;
                active.retain(|&strip| strips[strip as usize].x[1] > at);
                // Hairs behind all that was seen last cut nothing.
                let counts = |strip: &Strip| strip.near_m < opaque_m;
                let mut to = end;
                for &strip in active.iter() {
                    let strip = &strips[strip as usize];
                    if strip.x[1] < to && counts(strip) {
                        to = strip.x[1];
                    }
                }
                while let Some(strip) = strips.get(next).filter(|strip| strip.x[0] < to) {
                    if strip.x[0] > at && counts(strip) {
                        to = strip.x[0];
                        break;
                    }
                    if strip.x[1] > at {
                        if strip.x[1] < to && counts(strip) {
                            to = strip.x[1];
                        }
                        let point = active.partition_point(|&a| strips[a as usize].near_m <= strip.near_m);
                        active.insert(point, next as u32);
                    }
                    next += 1;
                }
                let ray = line.ray(at + (to - at) * unit());
                let view = self.see(&ray, part, to - at, scratch);
                opaque_m = if view.left > 0.0 { f64::INFINITY } else { view.at_m + part.farther_m(&ray) };
                scratch.line_reached_m = scratch.line_reached_m.max(opaque_m);
                depth_m += view.depth_m;
                at = to;
            }
            let Scratch { strips, tallies, seen, .. } = &mut *scratch;
            // Hairs in order of x.
            for (tally, strip) in tallies.iter_mut().zip(strips).filter(|(tally, _)| tally.share > 0.0) {
                let along_strand = tally.alongs / tally.share;
                seen.push((Seen::Guard { strand: strip.strand, along_strand }, part.ray, tally.share));
                *tally = Tally::default();
            }
            for interval in part.intervals.iter().filter(|interval| interval.seen > 0.0) {
                seen.push((Seen::Undercoat(interval.point), part.ray, interval.seen));
            }
            if let Some((_, point)) = part.skin.filter(|_| part.skin_seen > 0.0) {
                seen.push((Seen::Skin(point), part.ray, part.skin_seen));
            }
        }
        depth_m
    }

    /// Looks along a ray through the active strips and a part's undercoat, and adds up what is seen.
    fn see(&self, ray: &DRay, part: &mut Along, width: f64, scratch: &mut Scratch) -> ViewLeft {
        let mut view = ViewLeft::new(width);
        let Scratch { strips, tallies, active, waiting, passed, .. } = scratch;
        waiting.clear();
        passed.clear();
        // Skin and undercoat slant as the skin does.
        let farther_m = part.farther_m(ray);
        let far_m = part.far_m() + farther_m;
        if let Some(guard) = self.guard {
            let mut pass = |view: &mut ViewLeft, passed: &mut Vec<Crossing>, (crossing, strip): (Crossing, u32)| {
                part.see(self.medium, view, crossing.enter_m - farther_m);
                let share = view.take(guard.opacity(crossing.along_strand));
                let tally = &mut tallies[strip as usize];
                tally.share += share;
                tally.alongs += share * crossing.along_strand;
                view.depth_m += share * crossing.enter_m;
                passed.push(crossing);
            };
            for &index in active.iter() {
                let strip = &strips[index as usize];
                while waiting.last().is_some_and(|(first, _)| first.enter_m <= strip.near_m) && view.left > 0.0 {
                    waiting.pop().into_iter().for_each(|first| pass(&mut view, passed, first));
                }
                if view.left <= 0.0 {
                    break;
                }
                let Some(crossing) = guard.cross(ray, strip.strand, strip.segment) else { continue };
                if crossing.enter_m >= far_m {
                    continue;
                }
                // Where two intervals meet, a ray may be in both: that is one entry into one hair.
                let same = |other: &Crossing| {
                    other.strand == crossing.strand
                        && other.segment.abs_diff(crossing.segment) == 1
                        && crossing.enter_m <= other.leave_m
                        && other.enter_m <= crossing.leave_m
                };
                if passed.iter().any(same) {
                    continue;
                }
                if let Some(other) = waiting.iter().position(|(other, _)| same(other)) {
                    if waiting[other].0.enter_m <= crossing.enter_m {
                        continue;
                    }
                    waiting.remove(other);
                }
                let key = |c: &Crossing| (c.enter_m, guard.id(c.strand));
                let point = waiting.partition_point(|(other, _)| key(other) > key(&crossing));
                waiting.insert(point, (crossing, index));
            }
            while view.left > 0.0 {
                let Some(first) = waiting.pop() else { break };
                pass(&mut view, passed, first);
            }
        }
        part.see(self.medium, &mut view, f64::INFINITY);
        if let Some((at_m, _)) = part.skin.filter(|_| view.left > 0.0) {
            let share = view.take(1.0);
            part.skin_seen += share;
            view.depth_m += share * at_m;
        }
        view
    }
}
