//! What fills the shell, at every point exactly: undercoat with its crowding, and guard hair in the mean.

use super::bvh::Ray;
use super::kind::{BRIM, Kind};
use super::quadrature::{gauss, integrate};
use super::shell::{Place, Slabs, Span};
use crate::fur::groom::clump::Nearby;
use crate::fur::undercoat::{Pattern, Undercoat};
use crate::math::{DVec3, Vec3};
use crate::render::pelt::Pelt;
use crate::render::shell::Shell;
use std::cell::RefCell;

/// Where Gauss's and Kronrod's optical depths of a stretch agree so far, the latter's error is far less.
const TOLERANCE: f64 = 0.05;

/// Slabs of the shell up to the undercoat's tips, and from there to the guard hair's.
const SLABS: [usize; 2] = [6, 3];

thread_local! {
    /// Clump centres around the last point: the next one mostly shares them.
    static NEARBY: RefCell<Nearby> = RefCell::default();
}

/// The shell's content.
#[derive(Debug)]
pub struct Medium<'a> {
    /// The shell's prisms.
    pub slabs: Slabs,
    /// What varies over the skin.
    pub shell: Shell<'a>,
    normals: &'a [Vec3],
    /// Normals of the rest pose, where the skin is in another: patterns keep to it.
    rest_normals: Option<Vec<Vec3>>,
    undercoat: Option<Kind>,
    guard: Option<Kind>,
    /// Longest stretch that is integrated at once, m.
    detail_m: f64,
}

/// Which hair counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Counted {
    /// Undercoat: guard hair is met hair by hair.
    Undercoat,
    /// Both: what shades a point.
    Both,
}

impl<'a> Medium<'a> {
    /// Of a pelt; none where nothing grows.
    pub fn new(pelt: &Pelt<'a>, normals: &'a [Vec3], pattern: Option<Pattern>) -> Option<Self> {
        let fibre = pelt.undercoat.or(pelt.guard.map(|(_, fibre)| fibre))?;
        let undercoat = Undercoat::new(fibre, pattern);
        let height_m = f64::from(undercoat.height_m);
        if height_m <= 0.0 {
            return None;
        }
        let detail_m = 5.0 * f64::from(undercoat.detail_m());
        let rest_normals = pelt.skin.rest_m.as_ref().map(|_| pelt.skin.at_rest().smooth_normals());
        let shell = Shell::new(pelt.skin, pelt.fields, undercoat);
        let undercoat = pelt.undercoat.map(|fibre| Kind::undercoat(fibre, height_m));
        let guard = pelt.guard.map(|(_, fibre)| Kind::guard(fibre, height_m));
        let top = guard.as_ref().map_or(1.0, |kind| kind.top.max(1.0));
        let [below, beyond] = SLABS;
        let mut heights: Vec<f64> = (0..=below).map(|i| i as f64 / below as f64).collect();
        // The tallest hairs' ends fill a thin slab of their own, which no rule may step over.
        heights.insert(below, 1.0 - BRIM);
        if top > 1.0 {
            heights.extend((1..=beyond).map(|i| 1.0 + (top - 1.0) * i as f64 / beyond as f64));
        }
        Some(Self { slabs: Slabs::new(&shell, heights), shell, normals, rest_normals, undercoat, guard, detail_m })
    }

    /// A field's value at a place.
    pub fn scalar(&self, values: &[f32], place: &Place) -> f64 {
        let v = self.shell.skin.triangles[place.triangle as usize].map(|v| f64::from(values[v as usize]));
        v[0] * place.b.x + v[1] * place.b.y + v[2] * place.b.z
    }

    /// A field's value at a place.
    pub fn vector(&self, values: &[Vec3], place: &Place) -> DVec3 {
        let v = self.shell.skin.triangles[place.triangle as usize].map(|v| values[v as usize].as_dvec3());
        v[0] * place.b.x + v[1] * place.b.y + v[2] * place.b.z
    }

    /// Unit normal of the skin under a place.
    pub fn normal(&self, place: &Place) -> DVec3 {
        self.vector(self.normals, place).normalize_or(DVec3::Y)
    }

    /// Mean direction of hair at a place, unit.
    pub fn hair(&self, place: &Place) -> DVec3 {
        self.slabs.frame(place).0.normalize_or(DVec3::Y)
    }

    /// Blocked share per length of a ray along `direction`, 1/m.
    fn extinction(&self, place: &Place, direction: DVec3, counted: Counted) -> f64 {
        let (up, determinant) = self.slabs.frame(place);
        let up_m = up.length();
        let hair = up / up_m;
        let (sine, cosine) = (hair.cross(direction).length(), hair.dot(direction));
        let fields = self.shell.fields;
        let foot_m = self.shell.skin.rest_corners_m(place.triangle as usize).map(|p| p.as_dvec3());
        let area2_m2 = (foot_m[1] - foot_m[0]).cross(foot_m[2] - foot_m[0]).length();
        let standing = self.scalar(&fields.density, place) * area2_m2 / determinant;
        let mut sum = 0.0;
        if let Some(kind) = &self.undercoat {
            let bare = kind.per_m2 * kind.extinction(place.t, up_m, sine, cosine);
            if bare > 0.0 {
                let clump = self.scalar(&fields.clump, place) as f32;
                let root_m = foot_m[0] * place.b.x + foot_m[1] * place.b.y + foot_m[2] * place.b.z;
                let normals = self.rest_normals.as_deref().unwrap_or(self.normals);
                let normal = self.vector(normals, place).normalize_or(DVec3::Y);
                let undercoat = &self.shell.undercoat;
                let crowding = NEARBY.with_borrow_mut(|nearby| {
                    undercoat.column_near(nearby, root_m.as_vec3(), normal.as_vec3(), clump).crowding(place.t as f32)
                });
                sum += bare * f64::from(crowding);
            }
        }
        if let (Counted::Both, Some(kind)) = (counted, &self.guard) {
            sum += kind.per_m2 * kind.extinction(place.t, up_m, sine, cosine);
        }
        let sum = sum * standing;
        if sum.is_finite() { sum } else { 0.0 }
    }

    /// Where a ray is in slabs that hold what is counted, between two distances.
    pub fn spans(&self, ray: &Ray, from_m: f64, to_m: f64, counted: Counted, out: &mut Vec<Span>) {
        let below = match counted {
            Counted::Undercoat if self.undercoat.is_none() => return out.clear(),
            Counted::Undercoat => 1.0,
            Counted::Both => f64::INFINITY,
        };
        self.slabs.spans(ray, from_m, to_m, below, out);
    }

    /// Cuts a ray between two distances where spans begin and end and into short pieces, and calls `visit` with each piece
    /// and its optical depth until that returns false.
    pub fn pieces(
        &self,
        ray: &Ray,
        spans: &[Span],
        [from_m, to_m]: [f64; 2],
        counted: Counted,
        mut visit: impl FnMut([f64; 2], f64) -> bool,
    ) {
        let mut at_m = from_m;
        while at_m < to_m {
            let ends = spans.iter().flat_map(|span| [span.from_m, span.to_m]).filter(|&end| end > at_m);
            let end_m = ends.fold(to_m, f64::min);
            let middle = 0.5 * (at_m + end_m);
            let here = |span: &&Span| span.from_m <= middle && span.to_m >= middle;
            // Above undercoat, nothing is small.
            let detailed = spans.iter().filter(here).any(|span| self.slabs.slab(span.slab).1[0] < 1.0);
            let wanted = if detailed { (end_m - at_m) / self.detail_m } else { 1.0 };
            let parts = wanted.ceil().clamp(1.0, 64.0);
            let step = (end_m - at_m) / parts;
            if spans.iter().any(|span| here(&span)) {
                let mut extinction = |at_m: f64| -> f64 {
                    spans.iter().filter(here).map(|span| self.extinction_at(ray, span, at_m, counted)).sum()
                };
                for part in 0..parts as usize {
                    let begin = at_m + step * part as f64;
                    let depth = if detailed {
                        integrate(begin, begin + step, TOLERANCE, &mut extinction)
                    } else {
                        gauss(begin, begin + step, &mut extinction)
                    };
                    if !visit([begin, begin + step], depth) {
                        return;
                    }
                }
            }
            at_m = end_m;
        }
    }

    /// Blocked share per length where a ray is in a span, 1/m.
    pub fn extinction_at(&self, ray: &Ray, span: &Span, at_m: f64, counted: Counted) -> f64 {
        let places = self.slabs.places(span.slab, ray.at(at_m));
        places.map(|place| self.extinction(&place, ray.direction, counted)).sum()
    }

    /// Optical depth of hair along a ray from `from_m` up to `to_m`, or as much of it as passes `enough`.
    pub fn depth_along(&self, ray: &Ray, from_m: f64, to_m: f64, counted: Counted, enough: f64) -> f64 {
        let mut spans = Vec::new();
        let (mut sum, mut at_m) = (0.0, from_m);
        while sum < enough {
            // Boxes are looked for only where the last stretch was empty.
            if spans.is_empty() {
                at_m = self.slabs.first(ray, at_m);
            }
            if at_m >= to_m {
                break;
            }
            let end_m = (at_m + 2.0 * self.stride_m()).min(to_m);
            self.spans(ray, at_m, end_m, counted, &mut spans);
            self.pieces(ray, &spans, [at_m, end_m], counted, |_, depth| {
                sum += depth;
                sum < enough
            });
            at_m = end_m;
        }
        sum
    }

    /// How far a ray is followed at a time, m.
    pub fn stride_m(&self) -> f64 {
        0.25 * f64::from(self.shell.undercoat.height_m)
    }

    /// The place that a ray is at, in a span that holds it: the densest where a prism folds.
    pub fn place(&self, ray: &Ray, span: &Span, at_m: f64) -> Option<Place> {
        let at = |place: &Place| self.extinction(place, ray.direction, Counted::Undercoat);
        self.slabs.places(span.slab, ray.at(at_m)).max_by(|a, b| at(a).total_cmp(&at(b)))
    }
}
