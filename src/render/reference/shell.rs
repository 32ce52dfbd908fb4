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

/// Where a ray is in a slab of a prism.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// Which slab.
    pub slab: u32,
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
    bvh: Bvh,
}

impl Slabs {
    /// Cuts a shell at these heights, the lowest first.
    pub fn new(shell: &Shell<'_>, heights: Vec<f64>) -> Self {
        let triangles = shell.skin.triangles.clone();
        let feet_m: Vec<DVec3> = shell.skin.positions_m.iter().map(|p| p.as_dvec3()).collect();
        let offsets_m: Vec<DVec3> = shell.offsets_m.iter().map(|o| o.as_dvec3()).collect();
        let mut slabs = Self { triangles, feet_m, offsets_m, heights, bvh: Bvh::default() };
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

    /// The way from skin to t = 1 at a place, m, and |∂x/∂(b₁, b₂, t)|, m³.
    pub fn frame(&self, place: &Place) -> (DVec3, f64) {
        let (feet, offsets) = self.corners(place.triangle);
        let q = [0, 1, 2].map(|i| feet[i] + offsets[i] * place.t);
        let up = offsets[0] * place.b.x + offsets[1] * place.b.y + offsets[2] * place.b.z;
        (up, (q[1] - q[0]).cross(q[2] - q[0]).dot(up).abs())
    }

    /// Where, from `near_m` on, a ray first comes close to the shell.
    pub fn first(&self, ray: &Ray, near_m: f64) -> f64 {
        self.bvh.first(ray, near_m)
    }

    /// Where a ray is in the slabs that begin below height `below`, between two distances.
    pub fn spans(&self, ray: &Ray, from_m: f64, to_m: f64, below: f64, out: &mut Vec<Span>) {
        out.clear();
        self.bvh.visit(ray, from_m, to_m, |slab, far| {
            if self.slab(slab).1[0] < below {
                self.cross(ray, slab, from_m, to_m, out);
            }
            far
        });
        out.sort_unstable_by(|a, b| a.from_m.total_cmp(&b.from_m).then(a.slab.cmp(&b.slab)));
    }

    fn cross(&self, ray: &Ray, slab: u32, near_m: f64, far_m: f64, out: &mut Vec<Span>) {
        let (triangle, [t0, t1]) = self.slab(slab);
        let (feet, offsets) = self.corners(triangle);
        let p = feet.map(|p| p - ray.origin_m);
        // Distances at which the ray passes the slab's faces: those beyond its borders do no harm, each part between two
        // is tried by its middle.
        let mut cuts = [0.0_f64; 10];
        let mut count = 0;
        let mut offer = |t: f64| {
            let q = [0, 1, 2].map(|i| p[i] + offsets[i] * t);
            let normal = (q[1] - q[0]).cross(q[2] - q[0]);
            let at_m = normal.dot(q[0]) / normal.dot(ray.direction);
            if at_m > near_m && at_m < far_m {
                cuts[count] = at_m;
                count += 1;
            }
        };
        offer(t0);
        offer(t1);
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            let a = ray.direction.dot(offsets[j].cross(offsets[k]));
            let b = ray.direction.dot(p[j].cross(offsets[k]) + offsets[j].cross(p[k]));
            let c = ray.direction.dot(p[j].cross(p[k]));
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
            let middle = ray.at(0.5 * (pair[0] + pair[1]));
            if pair[1] > pair[0] && self.places(slab, middle).next().is_some() {
                out.push(Span { slab, from_m: pair[0], to_m: pair[1] });
            }
        }
    }

    /// The places of a slab that lie at a point: one, or more where a prism folds over itself.
    pub fn places(&self, slab: u32, point_m: DVec3) -> impl Iterator<Item = Place> {
        let (triangle, ends) = self.slab(slab);
        let (feet, o) = self.corners(triangle);
        let p = feet.map(|p| p - point_m);
        let triple = |a: DVec3, b: DVec3, c: DVec3| a.dot(b.cross(c));
        let cubic = [
            triple(p[0], p[1], p[2]),
            triple(o[0], p[1], p[2]) + triple(p[0], o[1], p[2]) + triple(p[0], p[1], o[2]),
            triple(p[0], o[1], o[2]) + triple(o[0], p[1], o[2]) + triple(o[0], o[1], p[2]),
            triple(o[0], o[1], o[2]),
        ];
        roots(cubic, ends).into_iter().flatten().filter_map(move |t| {
            let q = [0, 1, 2].map(|i| p[i] + o[i] * t);
            let normal = (q[1] - q[0]).cross(q[2] - q[0]);
            let b =
                DVec3::new(normal.dot(q[1].cross(q[2])), normal.dot(q[2].cross(q[0])), normal.dot(q[0].cross(q[1])))
                    / normal.length_squared();
            (b.min_element() >= 0.0).then_some(Place { triangle, b, t })
        })
    }
}

/// Roots of a t² + b t + c; NaN where there is none.
fn quadratic(a: f64, b: f64, c: f64) -> [f64; 2] {
    // The stable form, so that a small `a` loses nothing.
    let q = -0.5 * (b + (b * b - 4.0 * a * c).sqrt().copysign(b));
    [q / a, c / q]
}

/// Roots within two ends of c₀ + c₁ t + c₂ t² + c₃ t³: the stretches between its extremes are bracketed, then halved by
/// Newton's step where that stays inside.
fn roots(c: [f64; 4], [low, high]: [f64; 2]) -> [Option<f64>; 3] {
    let value = |t: f64| c[0] + t * (c[1] + t * (c[2] + t * c[3]));
    let slope = |t: f64| c[1] + t * (2.0 * c[2] + t * 3.0 * c[3]);
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
        *found = bracketed(&value, &slope, from, to);
        from = to;
        if to == high {
            break;
        }
    }
    found
}

fn bracketed(value: &impl Fn(f64) -> f64, slope: &impl Fn(f64) -> f64, from: f64, to: f64) -> Option<f64> {
    let (mut low, mut high) = (from, to);
    let rising = value(high) > value(low);
    if (value(low) > 0.0) == (value(high) > 0.0) {
        return None;
    }
    let mut t = 0.5 * (low + high);
    for _ in 0..60 {
        let v = value(t);
        if (v > 0.0) == rising {
            high = t;
        } else {
            low = t;
        }
        let next = t - v / slope(t);
        let next = if next > low && next < high { next } else { 0.5 * (low + high) };
        if (next - t).abs() < 1e-13 {
            return Some(next);
        }
        t = next;
    }
    Some(t)
}
