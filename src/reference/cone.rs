//! Segments of hair as round cones: unions of spheres whose centre and radius go linearly from end to end.
//!
//! The sphere at s is met by the line through the origin along unit d where g(s) = r² − D² ≥ 0, D the distance of its centre
//! from the line. With c(s) = from + s·axis, g(s) = γ + ed² + 2 s (β + ed·ad) + s² (α + ad²), where α = dr² − axis²,
//! β = r₀ dr − from·axis, γ = r₀² − from², ed = from·d and ad = axis·d.

use crate::math::DVec3;

/// Where the line through the origin along `direction` enters and leaves a round cone, and where along the segment its axis
/// passes the entry.
///
/// The sphere at s is entered and left at the distances p(s) ∓ √g(s), p the centre's projection. g is a quadratic; the first
/// entry is its interval's least p − √g, which lies at an end or where the derivative vanishes: p′ √g = g′/2.
pub fn enter_and_leave(from: DVec3, to: DVec3, radius: [f64; 2], direction: DVec3) -> Option<[f64; 3]> {
    let axis = to - from;
    let (p0, dp) = (from.dot(direction), axis.dot(direction));
    let (e0, de) = (from - direction * p0, axis - direction * dp);
    let dr = radius[1] - radius[0];
    let (a, b, c) =
        (dr * dr - de.length_squared(), radius[0] * dr - e0.dot(de), radius[0] * radius[0] - e0.length_squared());
    let g = |s: f64| c + s * (2.0 * b + a * s);
    let root = (b * b - a * c).sqrt();
    let (first, second) = ((-b + root) / a, (-b - root) / a);
    let (low, high) = match (g(0.0) > 0.0, g(1.0) > 0.0) {
        (true, true) => (0.0, 1.0),
        (true, false) => (0.0, if a < 0.0 { second } else { first.min(second) }),
        (false, true) => (if a < 0.0 { first } else { first.max(second) }, 1.0),
        (false, false) if a < 0.0 && first > 0.0 && second < 1.0 && first < second => (first, second),
        (false, false) => return None,
    };
    let end = |s: f64, sign: f64| p0 + s * dp + sign * g(s).max(0.0).sqrt();
    let mut best = [f64::INFINITY, f64::NEG_INFINITY, 0.0];
    let mut offer = |s: f64| {
        if end(s, -1.0) < best[0] {
            (best[0], best[2]) = (end(s, -1.0), s);
        }
        best[1] = best[1].max(end(s, 1.0));
    };
    offer(low);
    offer(high);
    // dp² g = (b + a s)²: a quadratic in s.
    let (qa, qb, qc) = (a * a - dp * dp * a, a * b - dp * dp * b, b * b - dp * dp * c);
    let root = (qb * qb - qa * qc).sqrt();
    for s in [(-qb - root) / qa, (-qb + root) / qa] {
        if s > low && s < high {
            offer(s);
        }
    }
    (best[0].is_finite()).then_some(best)
}

/// Where, in x, the lines through the origin along base + x·step begin and cease to meet a round cone.
///
/// A line touches an end's sphere where γ D + ed² = 0, D = (base + x·step)², and the cone between where g's discriminant
/// vanishes, which divided by D is (β² − α γ) D + 2 β ad·ed − α ed² − γ ad²: both quadratics in x. The cone's touch counts
/// where it lies between the ends.
pub fn extent(from: DVec3, to: DVec3, radius: [f64; 2], base: DVec3, step: DVec3) -> Option<[f64; 2]> {
    let axis = to - from;
    let dr = radius[1] - radius[0];
    // Polynomials in x, lowest power first.
    let linear = |v: DVec3| [v.dot(base), v.dot(step)];
    let times = |a: [f64; 2], b: [f64; 2]| [a[0] * b[0], a[0] * b[1] + a[1] * b[0], a[1] * b[1]];
    let d = [base.length_squared(), 2.0 * base.dot(step), step.length_squared()];
    let mut found = [f64::INFINITY, f64::NEG_INFINITY];
    let mut offer = |x: f64| found = [found[0].min(x), found[1].max(x)];
    for (centre, radius) in [(from, radius[0]), (to, radius[1])] {
        let gamma = radius * radius - centre.length_squared();
        let e = linear(centre);
        let ee = times(e, e);
        roots([0, 1, 2].map(|i| gamma * d[i] + ee[i])).into_iter().for_each(&mut offer);
    }
    let (alpha, beta, gamma) = (
        dr * dr - axis.length_squared(),
        radius[0] * dr - from.dot(axis),
        radius[0] * radius[0] - from.length_squared(),
    );
    let (e, a) = (linear(from), linear(axis));
    let (ee, ea, aa) = (times(e, e), times(e, a), times(a, a));
    let touch = roots(
        [0, 1, 2].map(|i| (beta * beta - alpha * gamma) * d[i] + 2.0 * beta * ea[i] - alpha * ee[i] - gamma * aa[i]),
    );
    for x in touch {
        let at = |p: [f64; 3]| p[0] + x * (p[1] + x * p[2]);
        let s = -(beta * at(d) + at(ea)) / (alpha * at(d) + at(aa));
        if (0.0..=1.0).contains(&s) {
            offer(x);
        }
    }
    (found[0] < found[1]).then_some(found)
}

/// Roots of c₀ + c₁ x + c₂ x²; NaN where there is none, which no minimum or maximum takes.
fn roots([c, b, a]: [f64; 3]) -> [f64; 2] {
    let q = -0.5 * (b + (b * b - 4.0 * a * c).sqrt().copysign(b));
    [q / a, c / q]
}
