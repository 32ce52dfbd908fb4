//! A slab of a prism as a ray passes it, met by exact roots of polynomials.
//!
//! Seen along the ray, corner i is at height t at (xᵢ, yᵢ)(t) across it and at the distance zᵢ(t), all linear in t. The ray
//! passes the triangle at t where the shares cᵢ(t) = xⱼ yₖ − yⱼ xₖ have one sign, and there bᵢ = cᵢ / Σ c and its distance is
//! s = Σ zᵢ cᵢ / Σ c. So the heights at a distance s are roots of the cubic Σ zᵢ cᵢ − s Σ c, and the ray passes the side opposite to corner i at a
//! root of the quadratic cᵢ. Where it folds back along the ray, s turns (`fold`).

use super::bvh::DRay;
use super::fold;
use super::point::{DShellPoint, DShellSpot, Spots};
use crate::math::{DVec2, DVec3};

/// A slab of a prism along a ray.
#[derive(Clone, Copy, Debug)]
pub struct PrismRay {
    triangle: u32,
    ends: [f64; 2],
    feet_m: [DVec3; 3],
    offsets_m: [DVec3; 3],
    /// cᵢ(t), lowest power first; their sum, and Σ zᵢ cᵢ.
    shares: [[f64; 3]; 3],
    area: [f64; 3],
    depth: [f64; 4],
}

impl PrismRay {
    /// Of the slab between two heights over a triangle, whose corners stand there with these offsets.
    pub fn new(ray: &DRay, triangle: u32, (feet, offsets): &([DVec3; 3], [DVec3; 3]), ends: [f64; 2]) -> Self {
        let p = feet.map(|foot_m| ray.see(foot_m - ray.origin_m));
        let o = offsets.map(|offset_m| ray.see(offset_m));
        let cross = |a: DVec3, b: DVec3| a.x * b.y - a.y * b.x;
        let shares = [0, 1, 2].map(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            [cross(p[j], p[k]), cross(p[j], o[k]) + cross(o[j], p[k]), cross(o[j], o[k])]
        });
        let mut depth = [0.0; 4];
        for i in 0..3 {
            for n in 0..3 {
                depth[n] += p[i].z * shares[i][n];
                depth[n + 1] += o[i].z * shares[i][n];
            }
        }
        let area = [0, 1, 2].map(|n| shares[0][n] + shares[1][n] + shares[2][n]);
        Self { triangle, ends, feet_m: p, offsets_m: o, shares, area, depth }
    }

    /// Parts of the ray between two distances that lie in the slab, with the points at their middles. The slab lies between
    /// the distances `inside`.
    pub fn spans(&self, [near_m, far_m]: [f64; 2], inside: [f64; 2], mut visit: impl FnMut([f64; 2], &Spots)) {
        // Distances at which the ray passes the slab's faces.
        let mut cuts = [0.0_f64; 14];
        let mut count = 0;
        let mut offer = |at_m: f64| {
            if at_m > near_m && at_m < far_m {
                cuts[count] = at_m;
                count += 1;
            }
        };
        for t in self.ends {
            let shares = self.shares.map(|share| square(&share, t));
            let area = square(&self.area, t);
            // Beyond its borders, the face is not passed.
            let least = -SLACK * shares.iter().map(|share| share.abs()).sum::<f64>();
            if shares.iter().all(|share| share * area.signum() >= least) {
                offer(cube(&self.depth, t) / area);
            }
        }
        for i in 0..3 {
            for t in quadratic(self.shares[i]) {
                if t >= self.ends[0] && t <= self.ends[1] {
                    let [from, to] = [1, 2].map(|n| self.feet_m[(i + n) % 3] + self.offsets_m[(i + n) % 3] * t);
                    let edge = to - from;
                    let (across, begin) = (DVec2::new(edge.x, edge.y), DVec2::new(from.x, from.y));
                    let along = -begin.dot(across) / across.length_squared();
                    if (-SLACK..=1.0 + SLACK).contains(&along) {
                        offer(from.z + along * edge.z);
                    }
                }
            }
        }
        // Where the prism folds back, both of its sheets end.
        fold::turns(&self.depth, &self.area, self.ends, |t| offer(cube(&self.depth, t) / square(&self.area, t)));
        // Each part between two cuts is tried by its middle.
        let (begin, end) = (inside[0] <= near_m, inside[1] >= far_m);
        if begin {
            cuts[count] = near_m;
            count += 1;
        }
        if end {
            cuts[count] = far_m;
            count += 1;
        }
        let cuts = &mut cuts[..count];
        cuts.sort_unstable_by(f64::total_cmp);
        for pair in cuts.windows(2) {
            if pair[1] > pair[0] {
                let spots = self.spots(0.5 * (pair[0] + pair[1]));
                if spots.iter().any(Option::is_some) {
                    visit([pair[0], pair[1]], &spots);
                }
            }
        }
    }

    /// The points that lie at a distance.
    pub fn spots(&self, at_m: f64) -> Spots {
        let Self { area, depth, ends, .. } = self;
        let cubic = [depth[0] - at_m * area[0], depth[1] - at_m * area[1], depth[2] - at_m * area[2], depth[3]];
        roots(cubic, *ends).map(|t| t.and_then(|t| self.spot(t, at_m)))
    }

    fn spot(&self, t: f64, at_m: f64) -> Option<DShellSpot> {
        let (p, o) = (&self.feet_m, &self.offsets_m);
        let mut b = DVec3::from_array(self.shares.map(|share| square(&share, t)));
        let area = b.element_sum();
        let q = [0, 1, 2].map(|i| p[i] + o[i] * t);
        let normal = (q[1] - q[0]).cross(q[2] - q[0]);
        if area * area > GRAZING * normal.length_squared() {
            b /= area;
        } else {
            // Seen on edge: by areas in the triangle's own plane.
            let q = q.map(|q| q - DVec3::Z * at_m);
            b = DVec3::new(normal.dot(q[1].cross(q[2])), normal.dot(q[2].cross(q[0])), normal.dot(q[0].cross(q[1])))
                / normal.length_squared();
        }
        if b.min_element() < 0.0 || b.is_nan() {
            return None;
        }
        let up_m = o[0] * b.x + o[1] * b.y + o[2] * b.z;
        let height_m = up_m.length();
        let point = DShellPoint { triangle: self.triangle, b, t };
        Some(DShellSpot { point, height_m, cosine: up_m.z / height_m, volume_m3: normal.dot(up_m).abs() })
    }
}

/// By how much a ray may pass beside a face and still cut there: such a cut does no harm.
const SLACK: f64 = 1e-6;

/// Square of the cosine to a triangle's plane below which it is seen on edge.
const GRAZING: f64 = 1e-8;

fn square(c: &[f64; 3], t: f64) -> f64 {
    c[0] + t * (c[1] + t * c[2])
}

fn cube(c: &[f64; 4], t: f64) -> f64 {
    c[0] + t * (c[1] + t * (c[2] + t * c[3]))
}

/// Roots of c₀ + c₁ t + c₂ t²; NaN where there is none.
fn quadratic([c, b, a]: [f64; 3]) -> [f64; 2] {
    // The stable form, so that a small `a` loses nothing.
    let q = -0.5 * (b + (b * b - 4.0 * a * c).sqrt().copysign(b));
    [q / a, c / q]
}

/// Roots within two ends of c₀ + c₁ t + c₂ t² + c₃ t³: stretches that rise or fall throughout are bracketed, then halved by
/// Newton's step where that stays inside.
fn roots(c: [f64; 4], [low, high]: [f64; 2]) -> [Option<f64>; 3] {
    let slope = |t: f64| c[1] + t * (2.0 * c[2] + t * 3.0 * c[3]);
    // Where the slope at both ends and at its own extreme has one sign, there is no other.
    let turn = -c[2] / (3.0 * c[3]);
    let way = slope(low) > 0.0;
    if (slope(high) > 0.0) == way && (!(turn > low && turn < high) || (slope(turn) > 0.0) == way) {
        return [bracketed(&c, low, high), None, None];
    }
    let mut extremes = quadratic([c[1], 2.0 * c[2], 3.0 * c[3]]);
    extremes.sort_unstable_by(f64::total_cmp);
    let mut found = [None; 3];
    let mut from = low;
    for (found, to) in found.iter_mut().zip(extremes.into_iter().chain([high])) {
        // NaN and what lies outside bound nothing.
        let to = if to > from && to < high {
            to
        } else if to >= high {
            high
        } else {
            continue;
        };
        *found = bracketed(&c, from, to);
        from = to;
        if to == high {
            break;
        }
    }
    found
}

fn bracketed(c: &[f64; 4], from: f64, to: f64) -> Option<f64> {
    let slope = |t: f64| c[1] + t * (2.0 * c[2] + t * 3.0 * c[3]);
    let (mut low, mut high) = (from, to);
    let [begin, end] = [cube(c, low), cube(c, high)];
    if (begin > 0.0) == (end > 0.0) {
        return None;
    }
    let rising = end > begin;
    // The chord's root: cubics here are nearly straight.
    let mut t = low + (high - low) * (begin / (begin - end));
    for _ in 0..60 {
        let v = cube(c, t);
        if (v > 0.0) == rising {
            high = t;
        } else {
            low = t;
        }
        let next = t - v / slope(t);
        let next = if next > low && next < high { next } else { 0.5 * (low + high) };
        if (next - t).abs() < 1e-10 {
            return Some(next);
        }
        t = next;
    }
    Some(t)
}
