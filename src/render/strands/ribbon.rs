//! One ribbon to fragments: the exact share of every pixel's area, row by row (or column by column where it lies flat).

use super::Knot;

/// A rectangle of pixels: first column and row, one past the last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// First column and row.
    pub from: [i32; 2],
    /// One past the last column and row.
    pub to: [i32; 2],
}

/// A pixel that a ribbon covers in part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share {
    /// Column and row.
    pub pixel: [i32; 2],
    /// Covered share of the pixel's area.
    pub coverage: f32,
    /// Where the middle of the covered piece lies between the knots on the picture.
    pub linear: f32,
    /// The same along the hair: perspective undone.
    pub along: f32,
}

/// Calls `emit` for each pixel of `window` that the ribbon between two knots covers.
///
/// The ribbon is cut across its major axis at its ends, so pieces of a strand that share an end and an axis neither
/// overlap nor gap, and the coverages of a whole ribbon sum to its area.
pub fn rasterise(a: &Knot, b: &Knot, window: Window, mut emit: impl FnMut(Share)) {
    let (dx, dy) = (b.x - a.x, b.y - a.y);
    if dy.abs() >= dx.abs() {
        let at = |k: &Knot| Point { minor: k.x, major: k.y, half: k.half_px, z_m: k.z_m };
        let bounds = Bounds { minor: [window.from[0], window.to[0]], major: [window.from[1], window.to[1]] };
        sweep(at(a), at(b), bounds, &mut emit);
    } else {
        let at = |k: &Knot| Point { minor: k.y, major: k.x, half: k.half_px, z_m: k.z_m };
        let bounds = Bounds { minor: [window.from[1], window.to[1]], major: [window.from[0], window.to[0]] };
        sweep(at(a), at(b), bounds, |share| {
            let [minor, major] = share.pixel;
            emit(Share { pixel: [major, minor], ..share });
        });
    }
}

struct Point {
    minor: f32,
    major: f32,
    half: f32,
    z_m: f32,
}

struct Bounds {
    minor: [i32; 2],
    major: [i32; 2],
}

fn sweep(a: Point, b: Point, bounds: Bounds, mut emit: impl FnMut(Share)) {
    let run = b.major - a.major;
    if run == 0.0 {
        return;
    }
    let slope = (b.minor - a.minor) / run;
    // A ribbon of width 2·half, cut parallel to the minor axis, is this much wider along it.
    let widen = (1.0 + slope * slope).sqrt();
    let (low, high) = if run > 0.0 { (a.major, b.major) } else { (b.major, a.major) };
    let first = floor(low).max(bounds.major[0]);
    let last = floor(-high).saturating_neg().min(bounds.major[1]);
    for row in first..last {
        let from = low.max(row as f32);
        let to = high.min((row + 1) as f32);
        let share = to - from;
        if share <= 0.0 {
            continue;
        }
        let linear = (0.5 * (from + to) - a.major) / run;
        let centre = a.minor + linear * (b.minor - a.minor);
        let half = (a.half + linear * (b.half - a.half)) * widen;
        // Linear on the picture is not linear along the hair: undo the perspective.
        let along = linear * a.z_m / (b.z_m + linear * (a.z_m - b.z_m));
        let drift = (slope * share).abs();
        let reach = half + 0.5 * drift;
        let begin = floor(centre - reach).max(bounds.minor[0]);
        let end = floor(-(centre + reach)).saturating_neg().min(bounds.minor[1]);
        let covered_up_to = |x: f32| ramp(x - (centre - half), drift) - ramp(x - (centre + half), drift);
        let mut before = covered_up_to(begin as f32);
        for x in begin..end {
            let after = covered_up_to((x + 1) as f32);
            let coverage = (after - before) * share;
            before = after;
            if coverage > 0.0 {
                emit(Share { pixel: [x, row], coverage: coverage.min(1.0), linear, along });
            }
        }
    }
}

/// The whole number at or below; without a call, which `f32::floor` is on machines of the oldest kind.
fn floor(v: f32) -> i32 {
    let cut = v as i32;
    cut.saturating_sub(i32::from(cut as f32 > v))
}

/// max(v, 0), averaged over a window of width `drift` around v.
fn ramp(v: f32, drift: f32) -> f32 {
    let half = 0.5 * drift;
    if v <= -half {
        0.0
    } else if v >= half {
        v
    } else {
        0.5 * (v + half) * (v + half) / drift
    }
}
