//! Renders single hairs by casting rays through a hierarchy of their segments: every crossing found, sorted by (depth,
//! id), composited front to back with the volume between them. Slow and plain, with no resolution of its own.

use super::Geometry;
use super::bvh::Bvh;
use super::rays::Rays;
use super::seen::Seen;
use super::segments::{self, Segment};
use crate::data::film::Film;
use crate::data::ray::DepthRange;
use crate::data::ray::Ray;
use crate::data::strands::Strands;
use crate::math::Vec3;
use crate::volume::medium::{Medium, MediumStep};
use rayon::prelude::*;

/// Transmittance below which nothing behind can be seen.
const OPAQUE: f32 = 1e-4;

/// Where a ray meets a segment of the geometry.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    depth_m: f32,
    /// Where it leaves it.
    leave_m: f32,
    alpha: f32,
    /// Index of the segment.
    segment: u32,
    /// Where along the hair, in [0, 1].
    s: f32,
}

/// Optical depth at which nothing behind can be seen.
const OPAQUE_DEPTH: f32 = 9.2;

/// What a ray meets: lists that a thread keeps for their memory.
#[derive(Debug, Default)]
struct Met {
    crossings: Vec<Crossing>,
    steps: Vec<MediumStep>,
}

/// A geometry made ready for rays.
pub struct Caster<'a> {
    geometry: Geometry<'a>,
    segments: Vec<Segment>,
    bvh: Bvh,
}

impl<'a> Caster<'a> {
    /// Builds the hierarchy.
    pub fn new(geometry: Geometry<'a>) -> Self {
        let (segments, bvh) = segments::build(&geometry);
        Self { geometry, segments, bvh }
    }

    /// Fills a film.
    pub fn render(&self, rays: &Rays<'_>, range: DepthRange) -> Film {
        let [width, height] = rays.size();
        let per_pixel = rays.per_pixel();
        let rows: Vec<Vec<Seen>> = (0..height)
            .into_par_iter()
            .map_init(Met::default, |met, y| {
                let pixel = |x: usize, met: &mut Met| {
                    let mut sum = Seen::default();
                    for sample in 0..per_pixel {
                        sum.add(&self.trace(&rays.ray(x, y, sample), range, met));
                    }
                    sum.scaled(1.0 / per_pixel as f32)
                };
                (0..width).map(|x| pixel(x, met)).collect()
            })
            .collect();
        let mut film = Film::new(width, height);
        for (i, seen) in rows.into_iter().flatten().enumerate() {
            seen.into_film(&mut film, i);
        }
        film
    }

    /// Mean transmittance over the rays of a film up to each of the rising distances `ends_m`.
    pub fn seen_through(&self, rays: &Rays<'_>, ends_m: &[f32]) -> Vec<f64> {
        let [width, height] = rays.size();
        let range = DepthRange { near_m: 0.0, far_m: ends_m.last().copied().unwrap_or(0.0) };
        let row = |met: &mut Met, y: usize| {
            let mut sums = vec![0.0; ends_m.len()];
            for i in 0..width * rays.per_pixel() {
                let (x, sample) = (i / rays.per_pixel(), i % rays.per_pixel());
                self.add_through(&rays.ray(x, y, sample), range, ends_m, met, &mut sums);
            }
            sums
        };
        let rows: Vec<Vec<f64>> = (0..height).into_par_iter().map_init(Met::default, row).collect();
        let rays = (width * height * rays.per_pixel()) as f64;
        (0..ends_m.len()).map(|end| rows.iter().map(|row| row[end]).sum::<f64>() / rays).collect()
    }

    fn add_through(&self, ray: &Ray, mut range: DepthRange, ends_m: &[f32], met: &mut Met, sums: &mut [f64]) {
        self.meet(ray, &mut range, met);
        let (mut hairs, mut depth, mut last) = (1.0, 0.0, None);
        let mut crossings = met.crossings.iter().peekable();
        let mut steps = met.steps.iter().peekable();
        for (&end_m, sum) in ends_m.iter().zip(sums) {
            while let Some(crossing) = crossings.next_if(|crossing| crossing.depth_m <= end_m) {
                if !self.same_hair(&mut last, crossing) {
                    hairs *= 1.0 - crossing.alpha;
                }
            }
            while let Some(step) = steps.next_if(|step| step.to_m <= end_m) {
                depth += step.depth;
            }
            let begun =
                steps.peek().filter(|step| step.from_m < end_m).map_or(0.0, |&&(mut step)| step.before(end_m).depth);
            let through = hairs * libm::expf(-depth - begun);
            if through < OPAQUE {
                return;
            }
            *sum += f64::from(through);
        }
    }

    /// Share of each pixel's rays that single hairs are the first to block before each of the rising distances `ends_m`, and
    /// not before the one before it: `[pixel][distance]`. A hair counts in each interval that it is met in, as far as what is before
    /// lets it be seen.
    pub fn first_blocked(&self, rays: &Rays<'_>, ends_m: &[f32]) -> Vec<f32> {
        let [width, height] = rays.size();
        let range = DepthRange { near_m: 0.0, far_m: ends_m.last().copied().unwrap_or(0.0) };
        let share = 1.0 / rays.per_pixel() as f32;
        let row = |(all, parts): &mut (Vec<Crossing>, Vec<Crossing>), y: usize| {
            let mut blocked = vec![0.0; width * ends_m.len()];
            for i in 0..width * rays.per_pixel() {
                let (x, sample) = (i / rays.per_pixel(), i % rays.per_pixel());
                all.clear();
                self.collect(&rays.ray(x, y, sample), range, all);
                let (mut through, mut near_m) = (1.0, 0.0);
                for (blocked, &end_m) in blocked[x * ends_m.len()..].iter_mut().zip(ends_m) {
                    let inside = all.iter().filter(|c| c.leave_m > near_m && c.depth_m <= end_m);
                    parts.clear();
                    parts.extend(inside.map(|c| Crossing { depth_m: c.depth_m.max(near_m), ..*c }));
                    self.sort(parts);
                    let before = through;
                    let mut last = None;
                    for part in parts.iter().filter(|part| !self.same_hair(&mut last, part)) {
                        through *= 1.0 - part.alpha;
                    }
                    *blocked += (before - through) * share;
                    near_m = end_m;
                }
            }
            blocked
        };
        let rows: Vec<Vec<f32>> = (0..height).into_par_iter().map_init(Default::default, row).collect();
        rows.concat()
    }

    /// Finds what a ray meets, in order, as far as it sees.
    fn meet(&self, ray: &Ray, range: &mut DepthRange, met: &mut Met) {
        let Met { crossings, steps } = met;
        crossings.clear();
        steps.clear();
        if let Some(medium) = self.geometry.medium {
            let mut depth = 0.0;
            medium.walk(ray, *range, |step| {
                steps.push(step);
                depth += step.depth;
                depth < OPAQUE_DEPTH
            });
            if depth >= OPAQUE_DEPTH {
                range.far_m = steps.last().map_or(range.far_m, |step| step.to_m);
            }
        }
        self.collect(ray, *range, crossings);
        self.sort(crossings);
    }

    fn trace(&self, ray: &Ray, mut range: DepthRange, met: &mut Met) -> Seen {
        self.meet(ray, &mut range, met);
        let Met { crossings, steps } = met;
        let mut seen = Seen::default();
        let mut through = 1.0_f32;
        let mut last = None;
        let mut steps = steps.iter().copied().peekable();
        for crossing in crossings.iter().map(Some).chain([None]) {
            let at_m = crossing.map_or(f32::INFINITY, |crossing| crossing.depth_m);
            while let (Some(step), Some(medium)) = (steps.peek_mut(), self.geometry.medium) {
                if step.from_m >= at_m {
                    break;
                }
                let before = step.before(at_m);
                let clear = libm::expf(-before.depth);
                shade_step(medium, &before, through * (1.0 - clear), &mut seen);
                through *= clear;
                if before.to_m < at_m {
                    steps.next();
                }
            }
            let Some(crossing) = crossing else { break };
            if self.same_hair(&mut last, crossing) {
                continue;
            }
            self.shade(crossing, through * crossing.alpha, &mut seen);
            through *= 1.0 - crossing.alpha;
            if through < OPAQUE {
                through = 0.0;
                break;
            }
        }
        seen.alpha = 1.0 - through;
        seen
    }

    /// Depth first, then kind and source index: equal depths composite alike in any order of discovery.
    fn sort(&self, crossings: &mut [Crossing]) {
        crossings.sort_unstable_by(|a, b| a.depth_m.total_cmp(&b.depth_m).then_with(|| self.key(a).cmp(&self.key(b))));
    }

    /// Kind, source index and place along the hair.
    fn key(&self, crossing: &Crossing) -> (u8, u32, u32) {
        let segment = &self.segments[crossing.segment as usize];
        let id = self.strands(segment).map_or(segment.index, |strands| strands.id[segment.index as usize]);
        (segment.set, id, segment.span[0].to_bits())
    }

    /// Whether this crossing is of the same hair as the one before: neighbouring segments overlap at their joint, where
    /// the hair counts once.
    fn same_hair(&self, last: &mut Option<(u8, u32)>, crossing: &Crossing) -> bool {
        let segment = &self.segments[crossing.segment as usize];
        let hair = Some((segment.set, segment.index));
        let same = segment.set < 2 && hair == *last;
        *last = hair;
        same
    }

    /// The set of strands that a segment is from; none for the skin.
    fn strands(&self, segment: &Segment) -> Option<&'a Strands> {
        [self.geometry.guard, self.geometry.undercoat, None][usize::from(segment.set)]
    }

    fn shade(&self, crossing: &Crossing, weight: f32, seen: &mut Seen) {
        seen.depth_m += weight * crossing.depth_m;
        let segment = &self.segments[crossing.segment as usize];
        if let Some(strands) = self.strands(segment) {
            let colour = strands.tint[segment.index as usize] * strands.profile.ramp_at(crossing.s);
            seen.albedo += weight * colour;
            seen.tangent += weight * (segment.cone.to_m - segment.cone.from_m).normalize_or_zero();
            *(if segment.set == 0 { &mut seen.guard } else { &mut seen.undercoat }) += weight;
        } else {
            let normal = self.geometry.skin.map_or(Vec3::Z, |m| m.area_vector_m2(segment.index as usize));
            seen.normal += weight * normal.normalize_or_zero();
        }
    }

    /// All crossings up to the nearest that is opaque.
    fn collect(&self, ray: &Ray, range: DepthRange, crossings: &mut Vec<Crossing>) {
        let Some((low, high)) = self.bvh.bounds() else { return };
        let Some(edge) = self.geometry.torus_m else {
            self.collect_image(ray, range.near_m, range.far_m, crossings);
            return;
        };
        // The images of the tile that the ray passes over, nearest first.
        let upright = self.geometry.upright_from_world;
        let (start, step) = (upright * ray.origin_m, upright * ray.direction);
        // Nothing is met above or below all hair.
        let [down, up] = [low.z, high.z].map(|z| if step.z == 0.0 { f32::NAN } else { (z - start.z) / step.z });
        let ends = [range.near_m.max(down.min(up)), range.far_m.min(down.max(up))].map(|at_m| start + step * at_m);
        let span = |axis: usize| {
            let (a, b) = (ends[0][axis].min(ends[1][axis]), ends[0][axis].max(ends[1][axis]));
            let first = ((a - high[axis]) / edge).ceil() as i32;
            let last = ((b - low[axis]) / edge).floor() as i32;
            let forward = step[axis] >= 0.0;
            (first..=last).map(move |i| if forward { i } else { first + last - i })
        };
        let mut far = range.far_m;
        for ix in span(0) {
            for iy in span(1) {
                let shift = Vec3::new(ix as f32 * edge, iy as f32 * edge, 0.0);
                let image = Ray { origin_m: ray.origin_m - shift, direction: ray.direction };
                far = self.collect_image(&image, range.near_m, far, crossings);
            }
        }
    }

    /// Adds the crossings of one image of the geometry; returns how far the ray still sees.
    fn collect_image(&self, ray: &Ray, near_m: f32, far_m: f32, crossings: &mut Vec<Crossing>) -> f32 {
        let upright = self.geometry.upright_from_world;
        let mut limit = far_m;
        self.bvh.traverse(upright * ray.origin_m, upright * ray.direction, near_m, far_m, |item, far| {
            let Some(crossing) = self.cross(item, ray, near_m, far) else { return far };
            crossings.push(crossing);
            limit = if crossing.alpha < 1.0 { far } else { far.min(crossing.depth_m) };
            limit
        });
        limit
    }

    fn cross(&self, item: u32, ray: &Ray, near_m: f32, far_m: f32) -> Option<Crossing> {
        let segment = &self.segments[item as usize];
        let Some(strands) = self.strands(segment) else {
            let depth_m = triangle_depth(self.geometry.skin?.corners_m(segment.index as usize), ray)?;
            return (near_m..=far_m).contains(&depth_m).then_some(Crossing {
                depth_m,
                leave_m: depth_m,
                alpha: 1.0,
                segment: item,
                s: 0.0,
            });
        };
        let hit = segment.cone.hit(ray, near_m, far_m)?;
        let s = segment.span[0] + (segment.span[1] - segment.span[0]) * hit.s;
        Some(Crossing {
            depth_m: hit.depth_m,
            leave_m: hit.leave_m,
            alpha: strands.profile.opacity_at(s),
            segment: item,
            s,
        })
    }
}

/// Adds what is seen of a volume's step.
fn shade_step(medium: &Medium, step: &MediumStep, weight: f32, seen: &mut Seen) {
    seen.depth_m += weight * step.middle_m();
    seen.albedo += weight * medium.colour(step.t);
    seen.tangent += weight * medium.hair();
    seen.undercoat += weight;
}

/// Distance at which a ray meets a triangle from either side (Möller and Trumbore 1997).
fn triangle_depth([a, b, c]: [Vec3; 3], ray: &Ray) -> Option<f32> {
    let (e1, e2) = (b - a, c - a);
    let p = ray.direction.cross(e2);
    let determinant = e1.dot(p);
    if determinant == 0.0 {
        return None;
    }
    let to = (ray.origin_m - a) / determinant;
    let u = to.dot(p);
    let q = to.cross(e1);
    let v = ray.direction.dot(q);
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0).then(|| e2.dot(q))
}
