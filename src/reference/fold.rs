//! Where a prism folds back along a ray: heights at which their distance neither grows nor shrinks.
//!
//! The distance is s(t) = n(t) / a(t), n a cubic and a a quadratic, so it turns where n′a − n a′, a quartic, changes its sign. In
//! Bernstein's form over an interval, coefficients of one sign tell that there is no such point, which is nearly always so.

/// How often an interval is halved to tell its turns from each other; closer ones than that enclose nothing.
const HALVINGS: u32 = 24;

/// Calls `visit` with every height between two at which the distance n/a turns.
pub fn turns(n: &[f64; 4], a: &[f64; 3], [low, high]: [f64; 2], mut visit: impl FnMut(f64)) {
    let c = [
        n[1] * a[0] - n[0] * a[1],
        2.0 * (n[2] * a[0] - n[0] * a[2]),
        3.0 * n[3] * a[0] + n[2] * a[1] - n[1] * a[2],
        2.0 * n[3] * a[1],
        n[3] * a[2],
    ];
    // Taylor's coefficients at the lower end, times powers of the width.
    let mut d = c;
    for from in 0..4 {
        (from..4).rev().for_each(|i| d[i] += low * d[i + 1]);
    }
    let width = high - low;
    let mut power = 1.0;
    for d in &mut d {
        *d *= power;
        power *= width;
    }
    let b = [
        d[0],
        d[0] + d[1] / 4.0,
        d[0] + d[1] / 2.0 + d[2] / 6.0,
        d[0] + 0.75 * d[1] + 0.5 * d[2] + 0.25 * d[3],
        d.iter().sum(),
    ];
    isolate(b, [low, high], HALVINGS, &mut visit);
}

/// Calls `visit` with the points where a quartic in Bernstein's form changes its sign.
fn isolate(b: [f64; 5], [low, high]: [f64; 2], halvings: u32, visit: &mut impl FnMut(f64)) {
    if b.iter().all(|&b| b > 0.0) || b.iter().all(|&b| b < 0.0) {
        return;
    }
    let middle = 0.5 * (low + high);
    if halvings == 0 {
        if (b[0] > 0.0) != (b[4] > 0.0) {
            visit(middle);
        }
        return;
    }
    // De Casteljau's halves.
    let (mut left, mut right, mut row) = (b, b, b);
    for i in 1..5 {
        (0..5 - i).for_each(|j| row[j] = 0.5 * (row[j] + row[j + 1]));
        (left[i], right[4 - i]) = (row[0], row[4 - i]);
    }
    isolate(left, [low, middle], halvings - 1, visit);
    isolate(right, [middle, high], halvings - 1, visit);
}
