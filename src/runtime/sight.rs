//! What of a coat can be seen from somewhere: triangles of shells that neither the skin nor the hair before them surely hides, and fins
//! that count.

use super::detail::Detail;
use super::draw_list::Frame;
use crate::data::shell::gain_at;
use crate::math::{Vec3, Vec4};

/// Optical depth behind which hair is not looked at: a four-hundredth of what is there would be seen.
const UNSEEN: f32 = 6.0;
/// Cosine between normal and view below which neither hair nor skin hides anything for sure: what is seen on a slant comes in from the side.
const SLANTING: f32 = 0.1;
/// Share of a hair's length that stands up, below which it hides nothing.
const LYING: f32 = 0.05;

/// Cosines between normal and view up to which fins stand for their share of hair, from afar and near by; from twice as much on they stand
/// for none.
pub const OUTLINE: [f32; 2] = [0.16, 0.5];
/// Pixels along a tile's edge from which on single hairs are told apart.
pub const TOLD_APART: f32 = 24.0;

/// Where a picture is seen from.
#[derive(Clone, Copy, Debug)]
pub struct Eye {
    /// As [`Frame::eye`].
    eye: Vec4,
    /// The matrix' row of w, and pixels (of those that are shaded) per metre where w is 1.
    w: Vec4,
    pixels_per_m: f32,
}

impl Eye {
    /// That of a picture with `samples` along a pixel's edge.
    pub fn of(frame: &Frame, samples: u32) -> Self {
        let across = frame.clip_from_world.row(0).truncate().length();
        let pixels_per_m = 0.5 * across * (frame.size[0] * samples) as f32;
        Self { eye: frame.eye, w: frame.clip_from_world.row(3), pixels_per_m }
    }

    /// Unit vector along the ray that sees `p`, away from the viewer.
    fn ray(&self, p: Vec3) -> Vec3 {
        (p * self.eye.w - self.eye.truncate()).normalize_or_zero()
    }

    /// How far away `p` is, along the rays where they are parallel, m.
    fn away_m(&self, p: Vec3) -> f32 {
        let to = p * self.eye.w - self.eye.truncate();
        if self.eye.w > 0.0 { to.length() } else { -p.dot(self.eye.truncate()) }
    }

    /// Length of a pixel within `around_m` of `p` at the least, m; 0 at the eye.
    fn pixel_m(&self, p: Vec3, around_m: f32) -> f32 {
        let w = self.w.dot(p.extend(1.0)) - around_m * self.w.truncate().length();
        w.max(0.0) / self.pixels_per_m
    }
}

/// A coat vertex as far as sight goes.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// Position on the skin, m.
    pub position_m: Vec3,
    /// Root to the top of the stack, m.
    pub offset_m: Vec3,
    /// Unit normal of the skin.
    pub normal: Vec3,
    /// Density factor.
    pub density: f32,
    /// Sum of the skin's principal curvatures, 1/m; outwards positive.
    pub bend_per_m: f32,
    /// How far it is from where the coat ends, m.
    pub away_m: f32,
}

/// The hair before a layer.
#[derive(Clone, Copy, Debug)]
pub struct Before {
    /// Hair area above the layer's top times gain, in the mean of the tile, at [`GAIN_ANGLES_DEG`](crate::data::coat::GAIN_ANGLES_DEG).
    pub above_top: [f32; 9],
    /// Height over which the hair area above falls to 1/e, over the stack's.
    pub scale: f32,
}

/// One level of a tile as far as sight goes.
#[derive(Clone, Debug)]
pub struct LevelSight {
    /// Height of each layer's top over the stack's, the skin's first.
    pub tops: Vec<f32>,
    /// Of each layer, the skin counted; empty where hair of a tile's mean does not stand everywhere, and so hides nothing for sure.
    pub before: Vec<Before>,
    /// Which look each layer has.
    pub looks: Vec<usize>,
    /// Height of the stack up to which it suffices, pixels.
    pub most_px: f32,
}

impl LevelSight {
    /// Layers, the skin counted.
    pub fn layers(&self) -> u32 {
        self.tops.len() as u32
    }
}

/// A coat as far as sight goes.
#[derive(Clone, Debug)]
pub struct Sighted {
    /// Vertices.
    pub points: Vec<Point>,
    /// Their triangles.
    pub triangles: Vec<[u32; 3]>,
    /// Ends of each fin, and how much of the fin texture a metre of it holds.
    pub fins: Vec<([u32; 2], f32)>,
    /// Height of the tile's stack, m.
    pub height_m: f32,
    /// The stacks that the tile has of it, the finest first.
    pub levels: Vec<LevelSight>,
    /// Length of an edge of its outermost shell, m: the median.
    pub edge_m: f32,
    /// As [`CoatMesh::over_last`](super::draw_list::CoatMesh::over_last).
    pub over_last: bool,
}

/// Which side of a shell is seen, and from how far, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// Whether it is seen from inside.
    pub far: bool,
    /// Distance of its middle, m.
    pub away_m: f32,
}

impl Sighted {
    /// How high the longest hair is in the picture, seen from the side at the middle of the coat, pixels.
    pub fn height_px(&self, eye: &Eye) -> f32 {
        let furred = || self.points.iter().filter(|point| point.offset_m != Vec3::ZERO);
        let hair_m = furred().map(|point| point.offset_m.length()).fold(0.0, f32::max);
        let middle_m = furred().map(|point| point.position_m).sum::<Vec3>() / furred().count().max(1) as f32;
        hair_m / eye.pixel_m(middle_m, 0.0).max(f32::MIN_POSITIVE)
    }

    /// Which levels are drawn: one that is given, or the coarsest there is, else by how high the longest hair is.
    pub fn detail(&self, height_px: f32, level: Option<usize>) -> Detail {
        match level {
            Some(level) => Detail::fixed(level.min(self.levels.len() - 1)),
            None => Detail::of(height_px, self.levels[1..].iter().map(|level| level.most_px)),
        }
    }

    /// How far away a fin is, m, if it counts.
    pub fn fin(&self, eye: &Eye, &([start, end], per_m): &([u32; 2], f32)) -> Option<f32> {
        let [start, end] = [start, end].map(|v| self.points[v as usize]);
        let edge = end.position_m - start.position_m;
        let rise = (start.offset_m + end.offset_m) * 0.5;
        let middle = (start.position_m + end.position_m + rise) * 0.5;
        let across = edge.cross(rise);
        // Lengyel et al. 2001 §2.3: 2|p| - 1.
        if across.dot(eye.ray(middle)).abs() <= 0.5 * across.length() {
            return None;
        }
        let pixel_m = eye.pixel_m(middle, 0.5 * (edge.length() + rise.length()));
        let near = 1.0 - (pixel_m * per_m * TOLD_APART).clamp(0.0, 1.0);
        let edge_cos = OUTLINE[0] + (OUTLINE[1] - OUTLINE[0]) * near;
        let cos_view = (start.normal + end.normal).normalize_or_zero().dot(eye.ray(middle));
        (cos_view.abs() < 2.0 * edge_cos).then(|| eye.away_m(middle))
    }

    /// Which side of a triangle of a level's layer is seen, if any.
    pub fn slab(&self, eye: &Eye, level: &LevelSight, triangle: usize, layer: u32) -> Option<Seen> {
        let corners = self.corners(triangle);
        let [a, b, c] = at_height(&corners, level.tops[layer as usize]);
        let face = (b - a).cross(c - a);
        if corners.iter().all(|p| p.offset_m == Vec3::ZERO) || self.out_of_sight(eye, level, &corners, layer, face) {
            return None;
        }
        Some(Seen { far: !outside(eye, &corners, a, face), away_m: eye.away_m((a + b + c) / 3.0) })
    }

    /// Whether a triangle of a level's layer faces the eye; one of the skin, layer 0, by its normals.
    pub fn faces(&self, eye: &Eye, level: &LevelSight, triangle: usize, layer: u32) -> bool {
        let corners = self.corners(triangle);
        let [a, b, c] = at_height(&corners, level.tops[layer as usize]);
        if layer == 0 {
            // Hair that leans behind its skin counts as missing.
            return corners.iter().map(|p| p.normal).sum::<Vec3>().dot(eye.ray(a)) < 0.0;
        }
        outside(eye, &corners, a, (b - a).cross(c - a))
    }

    fn corners(&self, triangle: usize) -> [Point; 3] {
        self.triangles[triangle].map(|v| self.points[v as usize])
    }

    /// Whether hair before a triangle of a layer, or the skin, surely hides it. The coat goes on around it as far as the eye's ray runs
    /// through it, or what is seen of it from the side at a border would be missing.
    fn out_of_sight(&self, eye: &Eye, level: &LevelSight, corners: &[Point; 3], layer: u32, face: Vec3) -> bool {
        let least = |of: fn(&Point) -> f32| corners.iter().map(of).fold(f32::INFINITY, f32::min);
        let offset_m = corners.iter().map(|p| p.offset_m).sum::<Vec3>() / 3.0;
        let hair_m = offset_m.length();
        let to_eye = -eye.ray(corners[0].position_m + offset_m);
        let normals: Vec3 = corners.iter().map(|p| p.normal).sum();
        let facet = face.normalize_or_zero() * face.dot(normals).signum();
        let (rise, upright_m) = (facet.dot(to_eye), facet.dot(offset_m));
        let lying = upright_m <= LYING * hair_m;
        let slanting = rise.abs() < SLANTING;
        if hair_m <= 0.0 || slanting || lying || least(|p| p.away_m) < 2.0 * hair_m / rise.abs().max(2.0 * SLANTING) {
            return false;
        }
        // The stronger of both curvatures is no more than their sum, where neither is hollow.
        let most_bend = corners.iter().map(|p| p.bend_per_m).fold(0.0, f32::max);
        let bend_per_m = 0.5 * most_bend * (1.0 - rise * rise);
        if rise < 0.0 {
            // The body is before it, unless its skin bends away sooner.
            return rise * rise >= 4.0 * bend_per_m * upright_m * level.tops[layer as usize];
        }
        let Some(before) = level.before.get(layer as usize) else { return false };
        let along = offset_m.dot(to_eye) / hair_m;
        let above_top = gain_at(&before.above_top, along.clamp(0.0, 1.0).acos().to_degrees());
        let area = above_top * least(|p| p.density) * hair_m / self.height_m * (1.0 - along * along).max(0.0).sqrt();
        // As `way_up` of shaders/shared/shading.wgsl.
        let bent = 16.0 / std::f32::consts::PI * bend_per_m * before.scale * upright_m;
        area * 2.0 / (rise + (rise * rise + bent).sqrt()) > UNSEEN
    }
}

/// A triangle at a height over the stack's.
fn at_height(corners: &[Point; 3], height: f32) -> [Vec3; 3] {
    corners.map(|p| p.position_m + p.offset_m * height)
}

/// Whether a triangle at a height, with a corner `at` and a normal `face` of either direction, is seen from outside. Which side that is
/// follows from the offsets, not from the winding, so mirrored parts need no care.
fn outside(eye: &Eye, corners: &[Point; 3], at: Vec3, face: Vec3) -> bool {
    let offsets_m: Vec3 = corners.iter().map(|p| p.offset_m).sum();
    face.dot(eye.ray(at)) * face.dot(offsets_m) < 0.0
}
