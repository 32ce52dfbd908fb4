//! Renders single hairs by casting rays through a hierarchy of their pieces: every crossing found, sorted by (depth,
//! id), composited front to back. Slow and plain, with no resolution of its own.

use super::bvh::Bvh;
use super::pieces::{self, Piece};
use super::rays::{Ray, Rays};
use super::{DepthRange, Scene};
use crate::data::film::Film;
use crate::data::strands::Strands;
use crate::math::Vec3;
use rayon::prelude::*;

/// Transmittance below which nothing behind can be seen.
const OPAQUE: f32 = 1e-4;

/// Where a ray meets a piece of the scene.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    depth_m: f32,
    alpha: f32,
    /// Index of the piece.
    piece: u32,
    /// Where along the hair, in [0, 1].
    s: f32,
}

/// Where a search for crossings may end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stop {
    /// Nothing behind the nearest opaque crossing matters.
    NearestOpaque,
    /// Once anything is opaque, nothing else matters.
    AnyOpaque,
}

/// What one ray sees; colour-like values are premultiplied by alpha.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Seen {
    /// 1 − transmittance.
    pub alpha: f32,
    /// Part of alpha from guard hair.
    pub guard: f32,
    /// Part of alpha from undercoat.
    pub undercoat: f32,
    /// Depth × alpha, m.
    pub depth_m: f32,
    /// Colour × alpha.
    pub albedo: Vec3,
    /// Hair direction × alpha.
    pub tangent: Vec3,
    /// Skin normal × alpha.
    pub normal: Vec3,
}

/// A scene made ready for rays.
pub struct Caster<'a> {
    scene: Scene<'a>,
    pieces: Vec<Piece>,
    bvh: Bvh,
}

impl<'a> Caster<'a> {
    /// Builds the hierarchy.
    pub fn new(scene: Scene<'a>) -> Self {
        let (pieces, bvh) = pieces::build(&scene);
        Self { scene, pieces, bvh }
    }

    /// Fills a film.
    pub fn render(&self, rays: &Rays<'_>, range: DepthRange) -> Film {
        let [width, height] = rays.size();
        let per_pixel = rays.per_pixel();
        let rows: Vec<Vec<Seen>> = (0..height)
            .into_par_iter()
            .map_init(Vec::new, |crossings, y| {
                let pixel = |x: usize, crossings: &mut Vec<Crossing>| {
                    let mut sum = Seen::default();
                    for sample in 0..per_pixel {
                        sum.add(&self.look(&rays.ray(x, y, sample), range, crossings));
                    }
                    sum.scaled(1.0 / per_pixel as f32)
                };
                (0..width).map(|x| pixel(x, crossings)).collect()
            })
            .collect();
        let mut film = Film::new(width, height);
        for (i, seen) in rows.into_iter().flatten().enumerate() {
            film.alpha[i] = seen.alpha;
            film.depth_m[i] = if seen.alpha > 0.0 { seen.depth_m / seen.alpha } else { 0.0 };
            film.albedo[i] = seen.albedo;
            film.tangent[i] = seen.tangent;
            film.normal[i] = seen.normal;
            film.guard[i] = seen.guard;
            film.undercoat[i] = seen.undercoat;
        }
        film
    }

    /// Mean transmittance over the rays of a film: quicker than [`Self::render`], since any opaque crossing will do.
    pub fn mean_transmittance(&self, rays: &Rays<'_>, range: DepthRange) -> f64 {
        let [width, height] = rays.size();
        let row = |crossings: &mut Vec<Crossing>, y: usize| -> f64 {
            let samples = (0..width).flat_map(|x| (0..rays.per_pixel()).map(move |sample| (x, sample)));
            samples.map(|(x, sample)| f64::from(self.through(&rays.ray(x, y, sample), range, crossings))).sum()
        };
        let rows: Vec<f64> = (0..height).into_par_iter().map_init(Vec::new, row).collect();
        rows.iter().sum::<f64>() / (width * height * rays.per_pixel()) as f64
    }

    fn through(&self, ray: &Ray, range: DepthRange, crossings: &mut Vec<Crossing>) -> f32 {
        crossings.clear();
        self.collect(ray, range, Stop::AnyOpaque, crossings);
        if crossings.iter().any(|c| c.alpha >= 1.0) {
            return 0.0;
        }
        self.sort(crossings);
        let mut through = 1.0;
        let mut last = None;
        for crossing in crossings.iter().filter(|c| !self.same_hair(&mut last, c)) {
            through *= 1.0 - crossing.alpha;
        }
        through
    }

    fn look(&self, ray: &Ray, range: DepthRange, crossings: &mut Vec<Crossing>) -> Seen {
        crossings.clear();
        self.collect(ray, range, Stop::NearestOpaque, crossings);
        self.sort(crossings);
        let mut seen = Seen::default();
        let mut through = 1.0_f32;
        let mut last = None;
        for crossing in crossings.iter() {
            if self.same_hair(&mut last, crossing) {
                continue;
            }
            let weight = through * crossing.alpha;
            self.shade(crossing, weight, &mut seen);
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
        let piece = &self.pieces[crossing.piece as usize];
        let id = self.strands(piece).map_or(piece.index, |strands| strands.id[piece.index as usize]);
        (piece.set, id, piece.span[0].to_bits())
    }

    /// Whether this crossing is of the same hair as the one before: neighbouring pieces overlap at their joint, where
    /// the hair counts once.
    fn same_hair(&self, last: &mut Option<(u8, u32)>, crossing: &Crossing) -> bool {
        let piece = &self.pieces[crossing.piece as usize];
        let hair = Some((piece.set, piece.index));
        let same = piece.set < 2 && hair == *last;
        *last = hair;
        same
    }

    /// The set of strands that a piece is from; none for the skin.
    fn strands(&self, piece: &Piece) -> Option<&'a Strands> {
        [self.scene.guard, self.scene.undercoat, None][usize::from(piece.set)]
    }

    fn shade(&self, crossing: &Crossing, weight: f32, seen: &mut Seen) {
        seen.depth_m += weight * crossing.depth_m;
        let piece = &self.pieces[crossing.piece as usize];
        if let Some(strands) = self.strands(piece) {
            let colour = strands.tint[piece.index as usize] * strands.profile.ramp_at(crossing.s);
            seen.albedo += weight * colour;
            seen.tangent += weight * (piece.cone.to_m - piece.cone.from_m).normalize_or_zero();
            *(if piece.set == 0 { &mut seen.guard } else { &mut seen.undercoat }) += weight;
        } else {
            let normal = self.scene.skin.map_or(Vec3::Z, |m| m.area_vector_m2(piece.index as usize));
            seen.normal += weight * normal.normalize_or_zero();
        }
    }

    /// All crossings up to where `stop` says.
    fn collect(&self, ray: &Ray, range: DepthRange, stop: Stop, crossings: &mut Vec<Crossing>) {
        let Some((low, high)) = self.bvh.bounds() else { return };
        let Some(edge) = self.scene.torus_m else {
            self.collect_image(ray, range.near_m, range.far_m, stop, crossings);
            return;
        };
        // The images of the tile that the ray passes over, nearest first.
        let upright = self.scene.upright_from_world;
        let (start, step) = (upright * ray.origin_m, upright * ray.direction);
        let ends = [start + step * range.near_m, start + step * range.far_m];
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
                far = self.collect_image(&image, range.near_m, far, stop, crossings);
                if far < range.near_m {
                    return;
                }
            }
        }
    }

    /// Adds the crossings of one image of the scene; returns how far the ray still sees.
    fn collect_image(&self, ray: &Ray, near_m: f32, far_m: f32, stop: Stop, crossings: &mut Vec<Crossing>) -> f32 {
        let upright = self.scene.upright_from_world;
        let mut limit = far_m;
        self.bvh.traverse(upright * ray.origin_m, upright * ray.direction, near_m, far_m, |item, far| {
            let Some(crossing) = self.cross(item, ray, near_m, far) else { return far };
            crossings.push(crossing);
            limit = match stop {
                _ if crossing.alpha < 1.0 => far,
                Stop::NearestOpaque => far.min(crossing.depth_m),
                Stop::AnyOpaque => f32::NEG_INFINITY,
            };
            limit
        });
        limit
    }

    fn cross(&self, item: u32, ray: &Ray, near_m: f32, far_m: f32) -> Option<Crossing> {
        let piece = &self.pieces[item as usize];
        let Some(strands) = self.strands(piece) else {
            let depth_m = triangle_depth(self.scene.skin?.corners_m(piece.index as usize), ray)?;
            return (near_m..=far_m).contains(&depth_m).then_some(Crossing {
                depth_m,
                alpha: 1.0,
                piece: item,
                s: 0.0,
            });
        };
        let hit = piece.cone.hit(ray, near_m, far_m)?;
        let s = piece.span[0] + (piece.span[1] - piece.span[0]) * hit.s;
        Some(Crossing { depth_m: hit.depth_m, alpha: strands.profile.opacity_at(s), piece: item, s })
    }
}

impl Seen {
    fn add(&mut self, other: &Self) {
        self.alpha += other.alpha;
        self.guard += other.guard;
        self.undercoat += other.undercoat;
        self.depth_m += other.depth_m;
        self.albedo += other.albedo;
        self.tangent += other.tangent;
        self.normal += other.normal;
    }

    fn scaled(self, f: f32) -> Self {
        Self {
            alpha: self.alpha * f,
            guard: self.guard * f,
            undercoat: self.undercoat * f,
            depth_m: self.depth_m * f,
            albedo: self.albedo * f,
            tangent: self.tangent * f,
            normal: self.normal * f,
        }
    }
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
