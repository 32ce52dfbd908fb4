//! What a ray meets next, and what light is left along it.

use super::hairs::{Hairs, Leaving, Wanted};
use crate::fur::groom::clump::Nearby;
use crate::math::hash::{Stream, unit_f64};
use crate::reference::bvh::DRay;
use crate::reference::guard::Crossing;
use crate::reference::interval::MediumInterval;
use crate::reference::medium::{Counted, DMedium};
use crate::reference::point::DShellPoint;
use crate::reference::skin::SkinBvh;

/// Optical depth beyond which no light is left.
const DARK: f64 = 16.0;

/// How far a ray gets before it may meet skin again, m: what rounding leaves of the skin that it begins at.
const OFF_SKIN_M: f64 = 1e-9;

/// A random number in [0, 1).
pub fn unit(random: &mut Stream) -> f64 {
    unit_f64(random.bits())
}

/// What a ray meets.
#[derive(Clone, Copy, Debug)]
pub enum Met {
    /// A guard hair.
    Guard(Crossing),
    /// Undercoat, in an interval with this middle.
    Undercoat(DShellPoint),
    /// Skin.
    Skin(DShellPoint),
}

/// Lists that a thread keeps for their memory.
#[derive(Debug, Default)]
pub struct Scratch {
    intervals: Vec<MediumInterval>,
}

/// What rays walk through.
#[derive(Debug)]
pub struct Space<'a> {
    /// Skin.
    pub skin: &'a SkinBvh,
    /// Guard hair.
    pub guard: Option<&'a Hairs<'a>>,
    /// Undercoat.
    pub medium: Option<&'a DMedium<'a>>,
}

impl Space<'_> {
    /// What a ray meets first, and where along it, m; none where it leaves the scene. Hair that is partly transparent is met as
    /// often as it is opaque, undercoat at a random depth.
    pub fn next(
        &self,
        ray: &DRay,
        leaving: Option<Leaving>,
        random: &mut Stream,
        scratch: &mut Scratch,
    ) -> Option<(f64, Met)> {
        let mut first = self.skin.meet(ray, OFF_SKIN_M).map(|(at_m, point)| (at_m, Met::Skin(point)));
        let far_m = |first: &Option<(f64, Met)>| first.map_or(f64::INFINITY, |(at_m, _)| at_m);
        if let Some(guard) = self.guard {
            let (mut near_m, mut leaving) = (0.0, leaving);
            while let Some(crossing) = guard.meet(ray, [near_m, far_m(&first)], leaving, Wanted::First) {
                if guard.cones.is_opaque() || unit(random) < guard.cones.opacity(crossing.along_strand) {
                    first = Some((crossing.enter_m, Met::Guard(crossing)));
                    break;
                }
                (near_m, leaving) = (crossing.enter_m, Some(crossing.into()));
            }
        }
        if let Some(medium) = self.medium
            && let Some((at_m, point)) = free_flight(medium, ray, far_m(&first), random, scratch)
        {
            first = Some((at_m, Met::Undercoat(point)));
        }
        first
    }

    /// The share of light that comes along a ray from `to_m` away.
    pub fn open(&self, ray: &DRay, to_m: f64, leaving: Option<Leaving>) -> f64 {
        let mut left = 1.0;
        if let Some(guard) = self.guard {
            let wanted = if guard.cones.is_opaque() { Wanted::Any } else { Wanted::First };
            let (mut near_m, mut leaving) = (0.0, leaving);
            while let Some(crossing) = guard.meet(ray, [near_m, to_m], leaving, wanted) {
                left *= 1.0 - guard.cones.opacity(crossing.along_strand);
                if left <= 0.0 || guard.cones.is_opaque() {
                    return 0.0;
                }
                (near_m, leaving) = (crossing.enter_m, Some(crossing.into()));
            }
        }
        if self.skin.meet(ray, OFF_SKIN_M).is_some_and(|(at_m, _)| at_m < to_m) {
            return 0.0;
        }
        let through = |medium: &DMedium<'_>| libm::exp(-medium.depth_along(ray, 0.0, to_m, Counted::Undercoat, DARK));
        left * self.medium.map_or(1.0, through)
    }
}

/// Where light that comes along a ray meets undercoat before `far_m`: where a random optical depth is reached.
fn free_flight(
    medium: &DMedium<'_>,
    ray: &DRay,
    far_m: f64,
    random: &mut Stream,
    scratch: &mut Scratch,
) -> Option<(f64, DShellPoint)> {
    let mut left = -libm::log1p(-unit(random));
    let (mut at_m, mut empty) = (0.0, true);
    let mut nearby = Nearby::default();
    loop {
        // Boxes are looked for only where the last interval was empty.
        if empty {
            at_m = medium.slabs.first(ray, at_m).max(at_m);
        }
        if at_m >= far_m {
            return None;
        }
        let end_m = (at_m + medium.stride_m()).min(far_m);
        scratch.intervals.clear();
        empty = !medium.intervals(ray, [at_m, end_m], &mut nearby, &mut scratch.intervals);
        for interval in &scratch.intervals {
            if interval.depth > left {
                let share = left / interval.depth;
                return Some((interval.from_m + share * (interval.to_m - interval.from_m), interval.point));
            }
            left -= interval.depth;
        }
        at_m = end_m;
    }
}
