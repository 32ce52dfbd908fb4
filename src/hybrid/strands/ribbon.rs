//! One ribbon to fragments: the exact share of every pixel's area, row by row (or column by column where it lies flat).

use super::RibbonPoint;
use crate::math::lanes::{F32s, Isa, MOST, Row};

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
    /// Where the middle of the covered segment lies between the ribbon points on the picture.
    pub linear: f32,
    /// The same along the hair: perspective undone.
    pub along: f32,
}

/// Calls `emit` for each pixel of `window` that the ribbon between two ribbon points covers.
///
/// The ribbon is cut across its major axis at its ends, so segments of a strand that share an end and an axis neither
/// overlap nor gap, and the coverages of a whole ribbon sum to its area.
#[inline(always)]
pub fn rasterise(a: &RibbonPoint, b: &RibbonPoint, window: Window, emit: impl FnMut(Share)) {
    let (dx, dy) = (b.x - a.x, b.y - a.y);
    if dy.abs() >= dx.abs() {
        let at = |k: &RibbonPoint| Point { minor: k.x, major: k.y, half: k.half_px, z_m: k.z_m };
        let bounds = Bounds { minor: [window.from[0], window.to[0]], major: [window.from[1], window.to[1]] };
        sweep::<false>(at(a), at(b), bounds, emit);
    } else {
        let at = |k: &RibbonPoint| Point { minor: k.y, major: k.x, half: k.half_px, z_m: k.z_m };
        let bounds = Bounds { minor: [window.from[1], window.to[1]], major: [window.from[0], window.to[0]] };
        sweep::<true>(at(a), at(b), bounds, emit);
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

/// Goes along the major axis, which is x where the ribbon is `FLAT`, else y.
#[inline(always)]
fn sweep<const FLAT: bool>(a: Point, b: Point, bounds: Bounds, mut emit: impl FnMut(Share)) {
    let run = b.major - a.major;
    if run == 0.0 {
        return;
    }
    let per_run = 1.0 / run;
    let slope = (b.minor - a.minor) * per_run;
    // A ribbon of width 2·half, cut parallel to the minor axis, is this much wider along it.
    let widen = (1.0 + slope * slope).sqrt();
    let (low, high) = if run > 0.0 { (a.major, b.major) } else { (b.major, a.major) };
    let first = floor(low).max(bounds.major[0]);
    let last = floor(-high).saturating_neg().min(bounds.major[1]);
    // How far the middle moves along the minor axis while the ribbon passes a whole row.
    let full_drift = slope.abs();
    let per_full_drift = 1.0 / full_drift;
    for row in first..last {
        let from = low.max(row as f32);
        let to = high.min((row + 1) as f32);
        let share = to - from;
        if share <= 0.0 {
            continue;
        }
        let linear = (0.5 * (from + to) - a.major) * per_run;
        let centre = a.minor + linear * (b.minor - a.minor);
        let half = (a.half + linear * (b.half - a.half)) * widen;
        // Linear on the picture is not linear along the hair: undo the perspective.
        let along = linear * a.z_m / (b.z_m + linear * (a.z_m - b.z_m));
        let (drift, per_drift) =
            if share == 1.0 { (full_drift, per_full_drift) } else { (full_drift * share, per_full_drift / share) };
        let reach = half + 0.5 * drift;
        let begin = floor(centre - reach).max(bounds.minor[0]);
        let end = floor(-(centre + reach)).saturating_neg().min(bounds.minor[1]);
        let (low_edge, high_edge) = (centre - half, centre + half);
        let covered_up_to = |x: f32| ramp(x - low_edge, drift, per_drift) - ramp(x - high_edge, drift, per_drift);
        let mut before = covered_up_to(begin as f32);
        for x in begin..end {
            let after = covered_up_to((x + 1) as f32);
            let coverage = (after - before) * share;
            before = after;
            if coverage > 0.0 {
                let pixel = if FLAT { [row, x] } else { [x, row] };
                emit(Share { pixel, coverage: coverage.min(1.0), linear, along });
            }
        }
    }
}

/// The lanes' numbers.
const RAMP: Row = Row([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);

/// Most pixels of a row that [`rows`] can tell of.
pub const NARROW: usize = 4;

/// What a narrow ribbon covers of some rows next to one another; of columns, where it lies flat.
#[derive(Clone, Copy, Debug)]
pub struct Rows {
    /// First pixel of each row.
    pub begin: [u32; MOST],
    /// How many pixels it covers, at most [`NARROW`].
    pub count: [u32; MOST],
    /// Of the first pixels, a bit for each row where something is covered.
    pub covered: [u32; NARROW],
    /// Covered shares of the first pixels' areas.
    pub coverage: [Row; NARROW],
    /// As [`Share::linear`].
    pub linear: Row,
    /// As [`Share::along`].
    pub along: Row,
}

/// A ribbon of which no row is wider than [`NARROW`] pixels.
#[derive(Clone, Copy, Debug)]
pub struct Narrow {
    /// Whether it goes along x rather than y: its rows are columns.
    pub flat: bool,
    /// First row and one past the last.
    pub rows: [i32; 2],
    within: [i32; 2],
    minor: [f32; 2],
    major: [f32; 2],
    half: [f32; 2],
    z_m: [f32; 2],
}

impl Narrow {
    /// Of the ribbon between two ribbon points; none where it is too wide.
    #[inline(always)]
    pub fn new(a: &RibbonPoint, b: &RibbonPoint, window: Window) -> Option<Self> {
        let flat = (b.y - a.y).abs() < (b.x - a.x).abs();
        let axes = if flat { [1, 0] } else { [0, 1] };
        let (from, to) = ([a.x, a.y], [b.x, b.y]);
        let (minor, major) = ([from[axes[0]], to[axes[0]]], [from[axes[1]], to[axes[1]]]);
        // At 45 degrees a row is √2 as wide as the ribbon, and drifts by 1.
        let reach = a.half_px.max(b.half_px) * std::f32::consts::SQRT_2 + 0.5;
        if 2.0 * reach > (NARROW - 1) as f32 {
            return None;
        }
        let first = floor(major[0].min(major[1])).max(window.from[axes[1]]);
        let last = floor(-major[0].max(major[1])).saturating_neg().min(window.to[axes[1]]);
        let within = [window.from[axes[0]], window.to[axes[0]]];
        let [first, last] = beside(within, reach, minor, major, [first, last]);
        Some(Self {
            flat,
            rows: [first, last],
            within,
            minor,
            major,
            half: [a.half_px, b.half_px],
            z_m: [a.z_m, b.z_m],
        })
    }

    /// The rows from `first` on, one per lane: what [`rasterise`] finds, bit by bit.
    #[inline(always)]
    pub fn rows<I: Isa>(&self, first: i32) -> Rows {
        let run = self.major[1] - self.major[0];
        let per_run = 1.0 / run;
        let across = self.minor[1] - self.minor[0];
        let slope = across * per_run;
        let widen = (1.0 + slope * slope).sqrt();
        let (low, high) = if run > 0.0 { (self.major[0], self.major[1]) } else { (self.major[1], self.major[0]) };
        let full_drift = slope.abs();
        let row = F32s::<I>::of(&RAMP) + first as f32;
        let (from, to) = (row.max(F32s::splat(low)), (row + 1.0).min(F32s::splat(high)));
        let share = to - from;
        let linear = ((from + to) * 0.5 - self.major[0]) * per_run;
        let centre = linear * across + self.minor[0];
        let half = (linear * (self.half[1] - self.half[0]) + self.half[0]) * widen;
        let along = linear * self.z_m[0] / (linear * (self.z_m[0] - self.z_m[1]) + self.z_m[1]);
        let (drift, per_drift) = (share * full_drift, F32s::splat(1.0 / full_drift) / share);
        let reach = half + drift * 0.5;
        let begin = (centre - reach).floor().max(F32s::splat(self.within[0] as f32));
        let end = (-(-(centre + reach)).floor()).min(F32s::splat(self.within[1] as f32));
        let (low_edge, high_edge) = (centre - half, centre + half);
        let zero = F32s::splat(0.0);
        let count = share.gt(zero).keep((end - begin).max(zero).min(F32s::splat(NARROW as f32)));
        let (mut coverage, mut covered) = ([Row::default(); NARROW], [0; NARROW]);
        let mut before = ramps(begin - low_edge, drift, per_drift) - ramps(begin - high_edge, drift, per_drift);
        for k in 0..NARROW {
            let wanted = count.gt(F32s::splat(k as f32));
            if wanted.bits() == 0 {
                break;
            }
            let x = begin + (k + 1) as f32;
            let after = ramps(x - low_edge, drift, per_drift) - ramps(x - high_edge, drift, per_drift);
            let part = ((after - before) * share).min(F32s::splat(1.0));
            (coverage[k], covered[k]) = (part.row(), (wanted & part.gt(zero)).bits());
            before = after;
        }
        Rows {
            begin: begin.to_whole().row(),
            count: count.to_whole().row(),
            covered,
            coverage,
            linear: linear.row(),
            along: along.row(),
        }
    }
}

/// Rows among `rows` on which a ribbon that reaches as far as `reach` may lie between the minor sides `within`.
#[inline(always)]
fn beside(within: [i32; 2], reach: f32, minor: [f32; 2], major: [f32; 2], rows: [i32; 2]) -> [i32; 2] {
    let per_minor = (major[1] - major[0]) / (minor[1] - minor[0]);
    if per_minor.is_nan() || per_minor.abs() >= STEEPEST {
        return rows;
    }
    // With a row to spare for rounding.
    let at = |side: f32| major[0] + (side - minor[0]) * per_minor;
    let (a, b) = (at(within[0] as f32 - reach), at(within[1] as f32 + reach));
    let [first, last] = [floor(a.min(b)) - 1, floor(a.max(b)) + 2];
    [rows[0].max(first), rows[1].min(last)]
}

/// Rows per pixel across above which a ribbon is not looked at for where it passes the sides.
const STEEPEST: f32 = 1e3;

/// [`ramp`] in lanes.
#[inline(always)]
fn ramps<I: Isa>(v: F32s<I>, drift: F32s<I>, per_drift: F32s<I>) -> F32s<I> {
    let half = drift * 0.5;
    let inside = (v + half) * 0.5 * (v + half) * per_drift;
    v.lt(half).select((-half).lt(v).keep(inside), v)
}

/// The whole number at or below; without a call, which `f32::floor` is on machines of the oldest kind.
#[inline(always)]
fn floor(v: f32) -> i32 {
    let cut = v as i32;
    cut.saturating_sub(i32::from(cut as f32 > v))
}

/// max(v, 0), averaged over a window of width `drift` around v; `per_drift` is one over it.
#[inline(always)]
fn ramp(v: f32, drift: f32, per_drift: f32) -> f32 {
    let half = 0.5 * drift;
    if v <= -half {
        0.0
    } else if v >= half {
        v
    } else {
        0.5 * (v + half) * (v + half) * per_drift
    }
}
