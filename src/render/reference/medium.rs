//! What fills the shell, at every point exactly: undercoat with its crowding, and guard hair in the mean.

use super::bvh::Ray;
use super::crowd::Points;
use super::kind::{BRIM, Kind};
use super::quadrature::{gauss, integrate};
use super::shell::{Place, Slabs, Span, Spot};
use crate::fur::groom::clump::Nearby;
use crate::fur::undercoat::{Pattern, Undercoat};
use crate::math::lanes::MOST;
use crate::math::{DVec3, Vec3};
use crate::render::pelt::Pelt;
use crate::render::shell::Shell;
use std::cell::RefCell;

/// Where Gauss's and Kronrod's optical depths of a stretch agree so far, the latter's error is far less.
pub const TOLERANCE: f64 = 0.1;

/// The same for shadows, of which many make up a pixel.
const ROUGHLY: f64 = 0.2;

/// Of the longest stretch, shorter ones than this share are smooth enough for Gauss's rule alone.
const SHORT: f64 = 0.3;

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
    /// Twice the area of each triangle at rest, m².
    twice_area_m2: Vec<f64>,
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
        let twice_area_m2 = (0..pelt.skin.triangles.len())
            .map(|t| pelt.skin.rest_corners_m(t).map(|p| p.as_dvec3()))
            .map(|[a, b, c]| (b - a).cross(c - a).length())
            .collect();
        let slabs = Slabs::new(&shell, heights);
        Some(Self { slabs, shell, normals, rest_normals, undercoat, guard, twice_area_m2, detail_m })
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
        self.slabs.up_m(place).normalize_or(DVec3::Y)
    }

    /// Blocked shares per length at places of a ray that lie in some spans, 1/m.
    pub fn extinctions<'s, const N: usize>(
        &self,
        spans: impl Iterator<Item = &'s Span>,
        direction: DVec3,
        at_m: [f64; N],
        counted: Counted,
    ) -> [f64; N] {
        let mut found = [0.0; N];
        NEARBY.with_borrow_mut(|nearby| {
            let mut points = Points::default();
            let mut waiting = [(0, 0.0); MOST];
            let mut count = 0;
            let mut crowd = |points: &mut Points, waiting: &[(usize, f64)], found: &mut [f64; N]| {
                let crowding = points.crowding(&self.shell.undercoat, nearby);
                for (&(i, bare), crowding) in waiting.iter().zip(crowding) {
                    found[i] += bare * f64::from(crowding);
                }
            };
            for span in spans {
                for (i, &at_m) in at_m.iter().enumerate() {
                    for spot in span.sight.spots(at_m) {
                        let [bare, guard] = self.uncrowded(&spot, direction, counted);
                        found[i] += guard;
                        if bare > 0.0 {
                            self.push(&spot.place, &mut points);
                            waiting[count] = (i, bare);
                            count += 1;
                        }
                        if points.is_full() {
                            crowd(&mut points, &waiting, &mut found);
                            count = 0;
                        }
                    }
                }
            }
            if count > 0 {
                crowd(&mut points, &waiting[..count], &mut found);
            }
        });
        found
    }

    /// Adds a place to those whose crowding is asked for.
    fn push(&self, place: &Place, points: &mut Points) {
        let foot_m = self.shell.skin.rest_corners_m(place.triangle as usize).map(|p| p.as_dvec3());
        let root_m = foot_m[0] * place.b.x + foot_m[1] * place.b.y + foot_m[2] * place.b.z;
        let normals = self.rest_normals.as_deref().unwrap_or(self.normals);
        let normal = self.vector(normals, place).normalize_or(DVec3::Y);
        let clump = self.scalar(&self.shell.fields.clump, place);
        points.push(root_m.as_vec3(), normal.as_vec3(), clump as f32, place.t as f32);
    }

    /// What undercoat blocks per length of a ray where it is as dense as in the mean, and what guard hair does, 1/m.
    fn uncrowded(&self, spot: &Spot, direction: DVec3, counted: Counted) -> [f64; 2] {
        let Spot { place, up_m, volume_m3 } = spot;
        let height_m = up_m.length();
        let cosine = up_m.dot(direction) / height_m;
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        let standing =
            self.scalar(&self.shell.fields.density, place) * self.twice_area_m2[place.triangle as usize] / volume_m3;
        let of = |kind: &Option<Kind>| {
            let blocked =
                kind.as_ref().map_or(0.0, |kind| kind.per_m2 * kind.extinction(place.t, height_m, sine, cosine));
            let blocked = blocked * standing;
            if blocked.is_finite() { blocked } else { 0.0 }
        };
        [of(&self.undercoat), if counted == Counted::Both { of(&self.guard) } else { 0.0 }]
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
        tolerance: f64,
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
                for part in 0..parts as usize {
                    let begin = at_m + step * part as f64;
                    let depth = if detailed && step > SHORT * self.detail_m {
                        integrate(begin, begin + step, tolerance, &mut |at_m| {
                            self.extinctions(spans.iter().filter(here), ray.direction, at_m, counted)
                        })
                    } else {
                        gauss(begin, begin + step, |at_m| {
                            self.extinctions(spans.iter().filter(here), ray.direction, at_m, counted)
                        })
                    };
                    if !visit([begin, begin + step], depth) {
                        return;
                    }
                }
            }
            at_m = end_m;
        }
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
            let end_m = (at_m + 4.0 * self.stride_m()).min(to_m);
            self.spans(ray, at_m, end_m, counted, &mut spans);
            self.pieces(ray, &spans, [at_m, end_m], counted, ROUGHLY, |_, depth| {
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

    /// The place that a ray is at, in spans that hold it: the densest where prisms fold.
    pub fn place<'s>(&self, spans: impl Iterator<Item = &'s Span>, direction: DVec3, at_m: f64) -> Option<Place> {
        let dense = |spot: &Spot| self.uncrowded(spot, direction, Counted::Undercoat)[0];
        let densest = spans.flat_map(|span| span.sight.spots(at_m)).max_by(|a, b| dense(a).total_cmp(&dense(b)));
        densest.map(|spot| spot.place)
    }
}
