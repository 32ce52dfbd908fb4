//! Guard hair as round cones in f64: every segment that is seen on a line, and where rays enter it.

use super::bvh::{Bounds, DBvh, DRay};
use super::cone;
use super::lens::PinholePixel;
use super::line::Line;
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
    pub along_strand: f64,
    /// Which segment of it.
    pub segment: u32,
}

/// A segment of hair that may be seen in a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// Between which columns, and which rows, it lies.
    pub across: [[f64; 2]; 2],
    /// No ray enters it before, m.
    pub near_m: f64,
    /// The hair.
    pub strand: u32,
    /// Which segment of it.
    pub segment: u32,
}

/// Where on a line a segment of hair is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strip {
    /// From and to, in [0, 1].
    pub x: [f64; 2],
    /// No ray enters it before, m.
    pub near_m: f64,
    /// The hair.
    pub strand: u32,
    /// Which segment of it.
    pub segment: u32,
}

/// All guard hair in one hierarchy.
#[derive(Debug)]
pub struct GuardCones<'a> {
    strands: &'a Strands,
    skin: &'a Mesh,
    bvh: DBvh,
    /// Transparency of the tip over e^k − 1.
    transparency: f64,
}

impl<'a> GuardCones<'a> {
    /// Builds the hierarchy.
    pub fn new(strands: &'a Strands, skin: &'a Mesh) -> Self {
        let segments = strands.points_per_strand - 1;
        let bounds: Vec<Bounds> = (0..strands.len() * segments)
            .into_par_iter()
            .map(|item| {
                let radius_m = f64::from(strands.root_radius_m[item / segments]);
                let at = item / segments * (segments + 1) + item % segments;
                Bounds::of(strands.points_m[at..=at + 1].iter().map(|p| p.as_dvec3()), radius_m)
            })
            .collect();
        Self { bvh: DBvh::new(&bounds), ..Self::unsorted(strands, skin) }
    }

    /// For who looks hairs up by other means: no pixel has candidates.
    pub fn unsorted(strands: &'a Strands, skin: &'a Mesh) -> Self {
        let profile = &strands.profile;
        let transparency = f64::from(profile.tip_transparency) / libm::expm1(f64::from(profile.tip_exponent));
        Self { strands, skin, bvh: DBvh::default(), transparency }
    }

    /// The segments that may be seen in a pixel, nearest first.
    pub fn candidates(&self, pixel: &PinholePixel<'_>, out: &mut Vec<Candidate>) {
        out.clear();
        let segments = self.segments();
        self.bvh.visit_beam(&pixel.beam(), |item| {
            let (strand, segment) = (item / segments, item % segments);
            let (ends_m, radius_m) = self.ends(strand, segment);
            let [(near_m, a), (far_m, b)] = [0, 1].map(|i| pixel.bounds(ends_m[i], radius_m[i]));
            let across = [0, 1].map(|i| [a[i][0].min(b[i][0]), a[i][1].max(b[i][1])]);
            if across.iter().all(|&[from, to]| from < 1.0 && to > 0.0) {
                out.push(Candidate { across, near_m: near_m.min(far_m), strand, segment });
            }
        });
        let key = |c: &Candidate| (self.id(c.strand), c.segment);
        out.sort_unstable_by(|a, b| a.near_m.total_cmp(&b.near_m).then_with(|| key(a).cmp(&key(b))));
    }

    /// Of candidates nearer than `far_m`, those that are seen on the line at `at`, a column or a row, from its beginning to its end.
    pub fn strips(&self, line: &Line, column: bool, at: f64, some: &[Candidate], far_m: f64, out: &mut Vec<Strip>) {
        out.clear();
        let (plane, ahead) = (line.base.cross(line.step).normalize(), (line.base + 0.5 * line.step).normalize());
        for candidate in some.iter().take_while(|candidate| candidate.near_m < far_m) {
            let Candidate { across, strand, segment, .. } = *candidate;
            let [from, to] = across[usize::from(!column)];
            if at < from || at > to {
                continue;
            }
            let ([from_m, to_m], radius_m) = self.ends(strand, segment);
            // The line's rays meet it where its axis is no farther from their plane than it is thick.
            let ends = [from_m, to_m].map(|end_m| end_m - line.eye_m);
            let widest_m = radius_m[0].max(radius_m[1]);
            let [a, b] = ends.map(|end| end.dot(plane));
            let [first, last] = [-widest_m, widest_m].map(|beside_m| (beside_m - a) / (b - a));
            let [first, last] = [first.min(last).max(0.0), first.max(last).min(1.0)];
            if first > last {
                continue;
            }
            let near_m =
                [first, last].map(|s| ends[0].lerp(ends[1], s).dot(ahead)).into_iter().fold(f64::INFINITY, f64::min)
                    - widest_m;
            let Some([from, to]) = line.extent(from_m, to_m, radius_m) else { continue };
            let x = [from.max(0.0), to.min(1.0)];
            if x[0] < x[1] {
                out.push(Strip { x, near_m, strand, segment });
            }
        }
        // The nearer of two that begin as one goes first.
        out.sort_by(|a, b| a.x[0].total_cmp(&b.x[0]));
    }

    /// From end to end of a candidate, unit.
    pub fn way(&self, candidate: &Candidate) -> DVec3 {
        let ([from_m, to_m], _) = self.ends(candidate.strand, candidate.segment);
        (to_m - from_m).normalize_or_zero()
    }

    /// Source index of a hair.
    pub fn id(&self, strand: u32) -> u32 {
        self.strands.id[strand as usize]
    }

    /// The hairs.
    pub fn strands(&self) -> &'a Strands {
        self.strands
    }

    /// Where along the hair, in [0, 1].
    pub fn s(&self, along_strand: f64) -> f64 {
        along_strand / (self.strands.points_per_strand - 1) as f64
    }

    /// The hair's own opacity there: 1 − (e^{ks} − 1)/(e^k − 1)·transparency.
    pub fn opacity(&self, along_strand: f64) -> f64 {
        let profile = &self.strands.profile;
        let k = f64::from(profile.tip_exponent);
        1.0 - libm::expm1(k * self.s(along_strand)) * self.transparency
    }

    /// Out of the skin at a hair's root, of no particular length.
    fn up(&self, strand: u32) -> DVec3 {
        let [a, b, c] =
            self.skin.corners_m(self.strands.roots[strand as usize].triangle as usize).map(|p| p.as_dvec3());
        (b - a).cross(c - a)
    }

    /// Whether all hair is opaque from root to tip.
    pub fn is_opaque(&self) -> bool {
        self.transparency == 0.0
    }

    /// Segments of each hair.
    pub fn segments(&self) -> u32 {
        self.strands.points_per_strand as u32 - 1
    }

    /// Ends of a segment, m, and its radii there, m.
    pub fn ends(&self, strand: u32, segment: u32) -> ([DVec3; 2], [f64; 2]) {
        let points = self.strands.points_of_m(strand as usize);
        let last = (points.len() - 1) as f64;
        let root_radius_m = f64::from(self.strands.root_radius_m[strand as usize]);
        let taper = f64::from(self.strands.profile.taper);
        let ends = [segment, segment + 1];
        (
            ends.map(|i| points[i as usize].as_dvec3()),
            ends.map(|i| root_radius_m * (1.0 + (taper - 1.0) * f64::from(i) / last)),
        )
    }

    /// Where a ray enters a segment.
    pub fn cross(&self, ray: &DRay, strand: u32, segment: u32) -> Option<Crossing> {
        let ([from_m, to_m], radius_m) = self.ends(strand, segment);
        let (from, to) = (from_m - ray.origin_m, to_m - ray.origin_m);
        let [enter_m, leave_m, along] = cone::enter_and_leave(from, to, radius_m, ray.direction)?;
        // The root's round end lies under the skin: none is seen through the bare side of the skin.
        if enter_m < 0.0 || segment == 0 && (ray.direction * enter_m - from).dot(self.up(strand)) < 0.0 {
            return None;
        }
        Some(Crossing { enter_m, leave_m, strand, along_strand: f64::from(segment) + along, segment })
    }
}
