//! The prismatic shell in f64: slabs of prisms in a hierarchy, met by exact roots of polynomials.
//!
//! A place is x = Σ bᵢ (pᵢ + t oᵢ). Seen from a point, the corners at height t are qᵢ(t) = pᵢ + t oᵢ − x; the point lies in
//! the triangle at t where q₀ · (q₁ × q₂) = 0, a cubic in t. A ray along d passes the side opposite to corner 0 where
//! d · (q₁ × q₂) = 0, a quadratic in t.

use super::bvh::{Bounds, Bvh, Ray};
use crate::math::DVec3;
use crate::render::shell::Shell;
use rayon::prelude::*;

/// A place in a prism.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Triangle of the skin.
    pub triangle: u32,
    /// Barycentric coordinates.
    pub b: DVec3,
    /// Height, 0 on the skin.
    pub t: f64,
}

/// A place and the shell around it.
#[derive(Clone, Copy, Debug)]
pub struct Spot {
    /// The place.
    pub place: Place,
    /// The way from skin to t = 1, m.
    pub up_m: DVec3,
    /// |∂x/∂(b₁, b₂, t)|, m³.
    pub volume_m3: f64,
}

/// Where a ray is in a slab of a prism.
#[derive(Clone, Copy, Debug)]
pub struct Span {
    /// Which slab.
    pub slab: u32,
    /// The slab as the ray passes it.
    pub sight: Sight,
    /// From, m along the ray.
    pub from_m: f64,
    /// To, m along the ray.
    pub to_m: f64,
}

/// Skin and offsets in f64, cut into slabs by height.
#[derive(Debug)]
pub struct Slabs {
    triangles: Vec<[u32; 3]>,
    feet_m: Vec<DVec3>,
    offsets_m: Vec<DVec3>,
    /// Heights between slabs.
    heights: Vec<f64>,
    bounds: Vec<Bounds>,
    bvh: Bvh,
}

impl Slabs {
    /// Cuts a shell at these heights, the lowest first.
    pub fn new(shell: &Shell<'_>, heights: Vec<f64>) -> Self {
        let triangles = shell.skin.triangles.clone();
        let feet_m: Vec<DVec3> = shell.skin.positions_m.iter().map(|p| p.as_dvec3()).collect();
        let offsets_m: Vec<DVec3> = shell.offsets_m.iter().map(|o| o.as_dvec3()).collect();
        let mut slabs = Self { triangles, feet_m, offsets_m, heights, bounds: Vec::new(), bvh: Bvh::default() };
        let layers = slabs.heights.len() - 1;
        let bounds: Vec<Bounds> = (0..slabs.triangles.len() * layers)
            .into_par_iter()
            .map(|i| {
                let (feet, offsets) = slabs.corners((i / layers) as u32);
                let ends = [slabs.heights[i % layers], slabs.heights[i % layers + 1]];
                Bounds::of(ends.into_iter().flat_map(|t| (0..3).map(move |c| feet[c] + offsets[c] * t)), 0.0)
            })
            .collect();
        slabs.bvh = Bvh::new(&bounds);
        slabs.bounds = bounds;
        slabs
    }

    fn corners(&self, triangle: u32) -> ([DVec3; 3], [DVec3; 3]) {
        let corners = self.triangles[triangle as usize].map(|v| v as usize);
        (corners.map(|v| self.feet_m[v]), corners.map(|v| self.offsets_m[v]))
    }

    /// Triangle and heights of a slab.
    pub fn slab(&self, slab: u32) -> (u32, [f64; 2]) {
        let layers = self.heights.len() as u32 - 1;
        let layer = (slab % layers) as usize;
        (slab / layers, [self.heights[layer], self.heights[layer + 1]])
    }

    /// Position of a place, m.
    pub fn position_m(&self, place: &Place) -> DVec3 {
        let (feet, offsets) = self.corners(place.triangle);
        (0..3).map(|i| (feet[i] + offsets[i] * place.t) * place.b[i]).sum()
    }

    /// The way from skin to t = 1 at a place, m.
    pub fn up_m(&self, place: &Place) -> DVec3 {
        let (_, offsets) = self.corners(place.triangle);
        offsets[0] * place.b.x + offsets[1] * place.b.y + offsets[2] * place.b.z
    }

    /// Where, from `near_m` on, a ray first comes close to the shell.
    pub fn first(&self, ray: &Ray, near_m: f64) -> f64 {
        self.bvh.first(ray, near_m)
    }

    /// Where a ray is in the slabs that begin below height `below`, between two distances.
    pub fn spans(&self, ray: &Ray, from_m: f64, to_m: f64, below: f64, out: &mut Vec<Span>) {
        out.clear();
        self.bvh.visit(ray, from_m, to_m, |slab, far| {
            let (triangle, ends) = self.slab(slab);
            if ends[0] < below && self.bounds[slab as usize].span(ray, from_m, to_m).is_some() {
                Sight::new(ray, triangle, self.corners(triangle), ends).spans(slab, [from_m, to_m], out);
            }
            far
        });
        out.sort_unstable_by(|a, b| a.from_m.total_cmp(&b.from_m).then(a.slab.cmp(&b.slab)));
    }
}

/// A slab of a prism as a ray passes it.
///
/// Seen from the point at distance s along d, the corners at height t are qᵢ = pᵢ + t oᵢ − s d, and the point lies in their
/// triangle where q₀ · (q₁ × q₂) = 0. All terms with two d vanish: a cubic in t whose coefficients are linear in s.
#[derive(Clone, Copy, Debug)]
pub struct Sight {
    triangle: u32,
    ends: [f64; 2],
    feet_m: [DVec3; 3],
    offsets_m: [DVec3; 3],
    direction: DVec3,
    /// The cubic at s = 0, lowest power first, and what a unit of s changes.
    still: [f64; 4],
    moving: [f64; 4],
}

impl Sight {
    fn new(ray: &Ray, triangle: u32, (feet, o): ([DVec3; 3], [DVec3; 3]), ends: [f64; 2]) -> Self {
        let p = feet.map(|foot_m| foot_m - ray.origin_m);
        let triple = |a: DVec3, b: DVec3, c: DVec3| a.dot(b.cross(c));
        let still = [
            triple(p[0], p[1], p[2]),
            triple(o[0], p[1], p[2]) + triple(p[0], o[1], p[2]) + triple(p[0], p[1], o[2]),
            triple(p[0], o[1], o[2]) + triple(o[0], p[1], o[2]) + triple(o[0], o[1], p[2]),
            triple(o[0], o[1], o[2]),
        ];
        // Σ over corners of aⱼ × bₖ: twice a triangle's area, where a = b.
        let area = |a: [DVec3; 3], b: [DVec3; 3]| a[0].cross(b[1]) + a[1].cross(b[2]) + a[2].cross(b[0]);
        let d = ray.direction;
        let moving = [-d.dot(area(p, p)), -d.dot(area(p, o) + area(o, p)), -d.dot(area(o, o)), 0.0];
        Self { triangle, ends, feet_m: p, offsets_m: o, direction: d, still, moving }
    }

    /// Parts of the ray between two distances that lie in the slab.
    fn spans(&self, slab: u32, [near_m, far_m]: [f64; 2], out: &mut Vec<Span>) {
        let ([t0, t1], p, o) = (self.ends, &self.feet_m, &self.offsets_m);
        // Distances at which the ray passes the slab's faces: those beyond its borders do no harm, each part between two
        // is tried by its middle.
        let mut cuts = [0.0_f64; 10];
        let mut count = 0;
        let mut offer = |t: f64| {
            let at_m = -self.still_at(t) / self.moving_at(t);
            if at_m > near_m && at_m < far_m {
                cuts[count] = at_m;
                count += 1;
            }
        };
        offer(t0);
        offer(t1);
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            let a = self.direction.dot(o[j].cross(o[k]));
            let b = self.direction.dot(p[j].cross(o[k]) + o[j].cross(p[k]));
            let c = self.direction.dot(p[j].cross(p[k]));
            for t in quadratic(a, b, c) {
                if t >= t0 && t <= t1 {
                    offer(t);
                }
            }
        }
        cuts[count] = near_m;
        cuts[count + 1] = far_m;
        let cuts = &mut cuts[..count + 2];
        cuts.sort_unstable_by(f64::total_cmp);
        for pair in cuts.windows(2) {
            if pair[1] > pair[0] && self.spots(0.5 * (pair[0] + pair[1])).next().is_some() {
                out.push(Span { slab, sight: *self, from_m: pair[0], to_m: pair[1] });
            }
        }
    }

    fn still_at(&self, t: f64) -> f64 {
        let c = &self.still;
        c[0] + t * (c[1] + t * (c[2] + t * c[3]))
    }

    fn moving_at(&self, t: f64) -> f64 {
        let c = &self.moving;
        c[0] + t * (c[1] + t * c[2])
    }

    /// The places that lie at a distance: one, or more where the prism folds over itself.
    pub fn spots(&self, at_m: f64) -> impl Iterator<Item = Spot> {
        let Self { triangle, ends, feet_m: p, offsets_m: o, direction, still, moving } = *self;
        let cubic = [0, 1, 2, 3].map(|i| still[i] + at_m * moving[i]);
        roots(cubic, ends).into_iter().flatten().filter_map(move |t| {
            let q = [0, 1, 2].map(|i| p[i] + o[i] * t - direction * at_m);
            let normal = (q[1] - q[0]).cross(q[2] - q[0]);
            let b =
                DVec3::new(normal.dot(q[1].cross(q[2])), normal.dot(q[2].cross(q[0])), normal.dot(q[0].cross(q[1])))
                    / normal.length_squared();
            let up_m = o[0] * b.x + o[1] * b.y + o[2] * b.z;
            let volume_m3 = normal.dot(up_m).abs();
            (b.min_element() >= 0.0).then_some(Spot { place: Place { triangle, b, t }, up_m, volume_m3 })
        })
    }
}

/// Roots of a t² + b t + c; NaN where there is none.
fn quadratic(a: f64, b: f64, c: f64) -> [f64; 2] {
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
    let mut extremes = quadratic(3.0 * c[3], 2.0 * c[2], c[1]);
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
    let value = |t: f64| c[0] + t * (c[1] + t * (c[2] + t * c[3]));
    let slope = |t: f64| c[1] + t * (2.0 * c[2] + t * 3.0 * c[3]);
    let (mut low, mut high) = (from, to);
    let [begin, end] = [value(low), value(high)];
    if (begin > 0.0) == (end > 0.0) {
        return None;
    }
    let rising = end > begin;
    // The chord's root: cubics here are nearly straight.
    let mut t = low + (high - low) * (begin / (begin - end));
    for _ in 0..60 {
        let v = value(t);
        if (v > 0.0) == rising {
            high = t;
        } else {
            low = t;
        }
        let next = t - v / slope(t);
        let next = if next > low && next < high { next } else { 0.5 * (low + high) };
        if (next - t).abs() < 1e-11 {
            return Some(next);
        }
        t = next;
    }
    Some(t)
}
