//! Undercoat and skin along one ray, found as far as somebody looks.

use super::bvh::DRay;
use super::interval::MediumInterval;
use super::medium::DMedium;
use super::point::DShellPoint;
use super::skin::{Plane, SkinBvh};
use crate::fur::groom::clump::Nearby;

/// Share of the distance by which skin may lie farther along a ray than along one of the same part of a pixel.
const GRAZING: f64 = 0.02;

/// What lies along a ray.
#[derive(Clone, Debug)]
pub struct Along {
    /// The ray.
    pub ray: DRay,
    /// Where it meets skin.
    pub skin: Option<(f64, DShellPoint)>,
    plane: Option<Plane>,
    /// Undercoat found so far, nearest first.
    pub intervals: Vec<MediumInterval>,
    /// How much of the skin has been seen.
    pub skin_seen: f64,
    done_m: f64,
    /// Whether the last interval was empty.
    empty: bool,
    /// Clump centres around the last point: the next one mostly shares them.
    nearby: Nearby,
}

impl Along {
    /// Of a ray.
    pub fn new(ray: DRay, skin: &SkinBvh) -> Self {
        let met = skin.meet(&ray, 0.0);
        let plane = met.map(|(_, point)| skin.plane(point.triangle));
        let (intervals, nearby) = (Vec::new(), Nearby::default());
        Self { ray, skin: met, plane, intervals, skin_seen: 0.0, done_m: 0.0, empty: true, nearby }
    }

    /// Where the skin ends it, m.
    pub fn far_m(&self) -> f64 {
        self.skin.map_or(f64::INFINITY, |(at_m, _)| at_m)
    }

    /// How much farther than along this ray all lies along one close by: as the skin does.
    pub fn farther_m(&self, ray: &DRay) -> f64 {
        let farther_m = self.plane.map_or(0.0, |plane| plane.meet_m(ray) - self.far_m());
        // A plane seen on edge tells nothing.
        if farther_m.abs() < self.far_m() * GRAZING { farther_m } else { 0.0 }
    }

    /// Sees undercoat up to `to_m`, from where `view` has come: less is left of it then.
    pub fn see(&mut self, medium: Option<&DMedium<'_>>, view: &mut ViewLeft, to_m: f64) {
        let to_m = to_m.min(self.far_m());
        while view.left > 0.0 {
            if view.next == self.intervals.len() {
                match medium {
                    Some(medium) if self.done_m < to_m => self.go_on(medium, to_m),
                    _ => break,
                }
                continue;
            }
            let interval = &mut self.intervals[view.next];
            let (from_m, end_m) = (view.at_m.max(interval.from_m), to_m.min(interval.to_m));
            if end_m > from_m {
                let share = view.take(interval.blocks(from_m, end_m));
                interval.seen += share;
                view.depth_m += share * 0.5 * (from_m + end_m);
                view.at_m = end_m;
                if view.left <= 0.0 {
                    return;
                }
            }
            if interval.to_m > to_m {
                break;
            }
            view.next += 1;
        }
        view.at_m = to_m;
    }

    /// Finds one more interval.
    fn go_on(&mut self, medium: &DMedium<'_>, to_m: f64) {
        // Boxes are looked for only where the last interval was empty.
        if self.empty {
            self.done_m = medium.slabs.first(&self.ray, self.done_m).max(self.done_m);
        }
        if self.done_m >= to_m {
            return;
        }
        let end_m = (self.done_m + medium.stride_m()).min(self.far_m());
        self.empty = !medium.intervals(&self.ray, [self.done_m, end_m], &mut self.nearby, &mut self.intervals);
        self.done_m = end_m;
    }
}

/// How far somebody has looked along a ray.
#[derive(Clone, Copy, Debug)]
pub struct ViewLeft {
    /// Share that is not blocked yet, times the part of the picture that is looked at.
    pub left: f64,
    /// Σ share × distance of all that was seen, m.
    pub depth_m: f64,
    /// Where the view is, m.
    pub at_m: f64,
    /// Of `left`, so little is given to what comes next, and the view ends.
    least: f64,
    next: usize,
}

/// Share of a view that is given to what comes next.
const LEAST: f64 = 5e-4;

impl ViewLeft {
    /// Of a part of the picture.
    pub fn new(part: f64) -> Self {
        Self { left: part, depth_m: 0.0, at_m: 0.0, least: LEAST * part, next: 0 }
    }

    /// What is seen of something that blocks `opacity`.
    pub fn take(&mut self, opacity: f64) -> f64 {
        let share = self.left * opacity;
        if self.left - share > self.least {
            self.left -= share;
            return share;
        }
        std::mem::take(&mut self.left)
    }
}
