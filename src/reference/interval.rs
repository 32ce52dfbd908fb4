//! Undercoat along a ray in intervals, one behind the other.

use super::point::DShellPoint;

/// An interval of undercoat, as dense throughout.
#[derive(Clone, Copy, Debug)]
pub struct MediumInterval {
    /// From, m.
    pub from_m: f64,
    /// To, m.
    pub to_m: f64,
    /// Optical depth.
    pub depth: f64,
    /// Share of light that it blocks.
    pub opacity: f64,
    /// Its middle.
    pub point: DShellPoint,
    /// How much of it has been seen.
    pub seen: f64,
}

impl MediumInterval {
    /// Share of light that it blocks between two distances within it.
    pub fn blocks(&self, from_m: f64, to_m: f64) -> f64 {
        if from_m == self.from_m && to_m == self.to_m {
            return self.opacity;
        }
        -libm::expm1(-self.depth * (to_m - from_m) / (self.to_m - self.from_m))
    }
}

/// Sorts the intervals from `first` on by distance; where some lie over each other, as in creases, they become one as deep as
/// all, in place of the densest.
pub fn put_in_order(intervals: &mut Vec<MediumInterval>, first: usize) {
    intervals[first..].iter_mut().for_each(|interval| interval.opacity = -libm::expm1(-interval.depth));
    intervals[first..].sort_by(|a, b| a.from_m.total_cmp(&b.from_m));
    let apart = |pair: &[MediumInterval]| pair[0].to_m - pair[1].from_m <= ROUNDING * pair[1].to_m;
    if intervals[first..].windows(2).all(apart) {
        return;
    }
    let folded = intervals.split_off(first);
    let mut ends: Vec<f64> = folded.iter().flat_map(|interval| [interval.from_m, interval.to_m]).collect();
    ends.sort_unstable_by(f64::total_cmp);
    let (mut active, mut next): (Vec<&MediumInterval>, usize) = (Vec::new(), 0);
    for pair in ends.windows(2) {
        let (from_m, to_m) = (pair[0], pair[1]);
        if to_m - from_m <= ROUNDING * to_m {
            continue;
        }
        let middle_m = 0.5 * (from_m + to_m);
        active.retain(|interval| interval.to_m > middle_m);
        while let Some(interval) = folded.get(next).filter(|interval| interval.from_m < middle_m) {
            if interval.to_m > middle_m {
                active.push(interval);
            }
            next += 1;
        }
        let density = |interval: &MediumInterval| interval.depth / (interval.to_m - interval.from_m);
        if let Some(densest) = active.iter().max_by(|a, b| density(a).total_cmp(&density(b))) {
            let depth = active.iter().map(|interval| density(interval)).sum::<f64>() * (to_m - from_m);
            intervals.push(MediumInterval {
                from_m,
                to_m,
                depth,
                opacity: -libm::expm1(-depth),
                point: densest.point,
                seen: 0.0,
            });
        }
    }
}

/// Of a distance: intervals that lie over each other by less only seem to.
const ROUNDING: f64 = 1e-12;
