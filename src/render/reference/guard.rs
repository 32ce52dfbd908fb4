//! Guard hair as round cones in f64: every hair that a ray enters, once each.

use super::bvh::{Bounds, Bvh, Ray};
use crate::data::mesh::Mesh;
use crate::data::strands::Strands;
use crate::math::DVec3;
use rayon::prelude::*;

/// Where a ray enters a hair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Distance along the ray, m.
    pub enter_m: f64,
    /// Where the hair is left, m.
    pub leave_m: f64,
    /// The hair.
    pub strand: u32,
    /// Where along the hair, in its points.
    pub knot: f64,
    /// The last of its pieces that the ray is in before it leaves the hair.
    piece: u32,
}

/// All guard hair in one hierarchy.
#[derive(Debug)]
pub struct Guard<'a> {
    strands: &'a Strands,
    skin: &'a Mesh,
    bvh: Bvh,
    widest_m: f64,
}

impl<'a> Guard<'a> {
    /// Builds the hierarchy.
    pub fn new(strands: &'a Strands, skin: &'a Mesh) -> Self {
        let pieces = strands.points_per_strand - 1;
        let bounds: Vec<Bounds> = (0..strands.len() * pieces)
            .into_par_iter()
            .map(|item| {
                let radius_m = f64::from(strands.root_radius_m[item / pieces]);
                let at = item / pieces * (pieces + 1) + item % pieces;
                Bounds::of(strands.points_m[at..=at + 1].iter().map(|p| p.as_dvec3()), radius_m)
            })
            .collect();
        let widest_m = 2.0 * f64::from(strands.root_radius_m.iter().copied().fold(0.0, f32::max));
        Self { strands, skin, bvh: Bvh::new(&bounds), widest_m }
    }

    /// Where, from `near_m` on, a ray first comes close to hair.
    pub fn first(&self, ray: &Ray, near_m: f64) -> f64 {
        self.bvh.first(ray, near_m)
    }

    /// The hairs that a ray enters between two distances, nearest first.
    pub fn crossings(&self, ray: &Ray, from_m: f64, to_m: f64, out: &mut Vec<Crossing>) {
        out.clear();
        let pieces = self.strands.points_per_strand as u32 - 1;
        let near_m = from_m - 2.0 * self.widest_m;
        self.bvh.visit(ray, near_m, to_m, |item, far| {
            let (strand, piece) = (item / pieces, item % pieces);
            out.extend(self.cross(ray, strand, piece).filter(|c| c.leave_m >= near_m && c.enter_m <= to_m));
            far
        });
        // Where two pieces meet, a ray may be in both: that is one entry into one hair.
        out.sort_unstable_by_key(|c| (c.strand, c.piece));
        out.dedup_by(|next, kept| {
            let same = next.strand == kept.strand
                && next.piece <= kept.piece + 1
                && next.enter_m <= kept.leave_m
                && kept.enter_m <= next.leave_m;
            if same {
                if next.enter_m < kept.enter_m {
                    (kept.enter_m, kept.knot) = (next.enter_m, next.knot);
                }
                kept.leave_m = kept.leave_m.max(next.leave_m);
                kept.piece = next.piece;
            }
            same
        });
        out.retain(|c| c.enter_m >= from_m && c.enter_m < to_m);
        out.sort_unstable_by(|a, b| a.enter_m.total_cmp(&b.enter_m).then(self.id(a).cmp(&self.id(b))));
    }

    /// Source index of the hair.
    fn id(&self, crossing: &Crossing) -> u32 {
        self.strands.id[crossing.strand as usize]
    }

    /// Where along the hair, in [0, 1].
    pub fn s(&self, crossing: &Crossing) -> f64 {
        crossing.knot / (self.strands.points_per_strand - 1) as f64
    }

    /// The hair's own opacity there: 1 − (e^{ks} − 1)/(e^k − 1)·transparency.
    pub fn opacity(&self, crossing: &Crossing) -> f64 {
        let profile = &self.strands.profile;
        let k = f64::from(profile.tip_exponent);
        let share = libm::expm1(k * self.s(crossing)) / libm::expm1(k);
        1.0 - share * f64::from(profile.tip_transparency)
    }

    /// Out of the skin at a hair's root, of no particular length.
    fn up(&self, strand: u32) -> DVec3 {
        let [a, b, c] =
            self.skin.corners_m(self.strands.roots[strand as usize].triangle as usize).map(|p| p.as_dvec3());
        (b - a).cross(c - a)
    }

    fn cross(&self, ray: &Ray, strand: u32, piece: u32) -> Option<Crossing> {
        let points = self.strands.points_of_m(strand as usize);
        let last = (points.len() - 1) as f64;
        let profile = &self.strands.profile;
        let root_radius_m = f64::from(self.strands.root_radius_m[strand as usize]);
        let radius_m = |i: u32| root_radius_m * (1.0 + (f64::from(profile.taper) - 1.0) * f64::from(i) / last);
        let end = |i: u32| points[i as usize].as_dvec3();
        let (from, to) = (end(piece) - ray.origin_m, end(piece + 1) - ray.origin_m);
        let [enter_m, leave_m, along] = round_cone(from, to, [radius_m(piece), radius_m(piece + 1)], ray.direction)?;
        // The root's round end lies under the skin: none is seen through the bare side of a pelt.
        if piece == 0 && (ray.direction * enter_m - from).dot(self.up(strand)) < 0.0 {
            return None;
        }
        Some(Crossing { enter_m, leave_m, strand, knot: f64::from(piece) + along, piece })
    }
}

/// Where the line through the origin along `direction` enters and leaves the union of spheres whose centre and radius go
/// linearly from end to end, and where along the piece its axis passes the entry.
///
/// The sphere at s is met where g(s) = r² − D² ≥ 0, D the distance of its centre from the line, and then at the distances
/// p(s) ∓ √g(s), p the centre's projection. g is a quadratic; the first entry is its interval's least p − √g, which lies
/// at an end or where the derivative vanishes: p′ √g = g′/2.
fn round_cone(from: DVec3, to: DVec3, radius: [f64; 2], direction: DVec3) -> Option<[f64; 3]> {
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
