//! What fills the shell, at every point exactly: undercoat with its crowding, and guard hair in the mean.

use super::bvh::DRay;
use super::crowd::{Crowd, Ground, Points};
use super::interval::{self, MediumInterval};
use super::kind::{BRIM, DHairKind};
use super::point::{DShellPoint, DShellSpot, Spots};
use super::shell::Slabs;
use super::sight::PrismRay;
use crate::fur::groom::clump::Nearby;
use crate::fur::undercoat::{Pattern, Undercoat};
use crate::math::lanes::MOST;
use crate::math::{DVec3, Vec3};
use crate::volume::scene::Scene;
use crate::volume::shell::Shell;

/// Optical depth of a interval of undercoat, where that is as dense as in the mean: its middle stands for all of it.
const MOST_STEP_DEPTH: f64 = 0.15;

/// Optical depth from which on a shadow is followed in short steps, not to be followed too far.
const DIM: f64 = 3.0;

/// Of the undercoat's height, the length for which one point stands where no pattern asks for a shorter one.
const SMOOTH: f64 = 0.1;

/// Gauss's rule of three points: weights in the middle and on both sides of it, where an interval is 2 long, and how far the
/// sides are off.
const GAUSS: [f64; 2] = [8.0 / 9.0, 5.0 / 9.0];
const OUTER: f64 = 0.774_596_669_241_483_4;

/// Slabs of the shell up to the undercoat's tips, and from there to the guard hair's.
const SLABS: [usize; 2] = [6, 3];

/// The shell's content.
#[derive(Debug)]
pub struct DMedium<'a> {
    /// The shell's prisms.
    pub slabs: Slabs,
    /// What varies over the skin.
    pub shell: Shell<'a>,
    normals: &'a [Vec3],
    /// Normals of the rest pose, where the skin is in another: patterns keep to it.
    rest_normals: Option<Vec<Vec3>>,
    undercoat: Option<DHairKind>,
    guard: Option<DHairKind>,
    /// Twice the area of each triangle at rest, m².
    twice_area_m2: Vec<f64>,
    /// Length for which one point of undercoat stands, m.
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

impl<'a> DMedium<'a> {
    /// Of a scene; none where nothing grows.
    pub fn new(scene: &Scene<'a>, normals: &'a [Vec3], pattern: Option<Pattern>) -> Option<Self> {
        let fibre = scene.undercoat.or(scene.guard.map(|(_, fibre)| fibre))?;
        let undercoat = Undercoat::new(fibre, pattern);
        let height_m = f64::from(undercoat.height_m);
        if height_m <= 0.0 {
            return None;
        }
        let detail_m = f64::from(undercoat.detail_m()).min(SMOOTH * height_m);
        let rest_normals = scene.skin.rest_m.as_ref().map(|_| scene.skin.at_rest().smooth_normals());
        let shell = Shell::new(scene.skin, scene.fields, undercoat);
        let undercoat = scene.undercoat.map(|fibre| DHairKind::undercoat(fibre, height_m));
        let guard = scene.guard.map(|(_, fibre)| DHairKind::guard(fibre, height_m));
        let top = guard.as_ref().map_or(1.0, |kind| kind.top.max(1.0));
        let [below, beyond] = SLABS;
        let mut heights: Vec<f64> = (0..=below).map(|i| i as f64 / below as f64).collect();
        // The tallest hairs' ends fill a thin slab of their own, which no rule may step over.
        heights.insert(below, 1.0 - BRIM);
        if top > 1.0 {
            heights.extend((1..=beyond).map(|i| 1.0 + (top - 1.0) * i as f64 / beyond as f64));
        }
        let twice_area_m2 = (0..scene.skin.triangles.len())
            .map(|t| scene.skin.rest_corners_m(t).map(|p| p.as_dvec3()))
            .map(|[a, b, c]| (b - a).cross(c - a).length())
            .collect();
        let slabs = Slabs::new(&shell, heights);
        Some(Self { slabs, shell, normals, rest_normals, undercoat, guard, twice_area_m2, detail_m })
    }

    /// A field's value at a point.
    pub fn scalar(&self, values: &[f32], point: &DShellPoint) -> f64 {
        let v = self.shell.skin.triangles[point.triangle as usize].map(|v| f64::from(values[v as usize]));
        v[0] * point.b.x + v[1] * point.b.y + v[2] * point.b.z
    }

    /// A field's value at a point.
    pub fn vector(&self, values: &[Vec3], point: &DShellPoint) -> DVec3 {
        let v = self.shell.skin.triangles[point.triangle as usize].map(|v| values[v as usize].as_dvec3());
        v[0] * point.b.x + v[1] * point.b.y + v[2] * point.b.z
    }

    /// Mean direction of hair at a point, unit.
    pub fn hair(&self, point: &DShellPoint) -> DVec3 {
        self.slabs.up_m(point).normalize_or(DVec3::Y)
    }

    /// What undercoat blocks per length of a ray where it is as dense as in the mean, and what guard hair does, 1/m.
    fn uncrowded(&self, spot: &DShellSpot, counted: Counted) -> [f64; 2] {
        let DShellSpot { point, height_m, cosine, volume_m3 } = *spot;
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        let standing =
            self.scalar(&self.shell.fields.density, &point) * self.twice_area_m2[point.triangle as usize] / volume_m3;
        let of = |kind: &Option<DHairKind>| {
            let blocked =
                kind.as_ref().map_or(0.0, |kind| kind.per_m2 * kind.extinction(point.t, height_m, sine, cosine));
            let blocked = blocked * standing;
            if blocked.is_finite() { blocked } else { 0.0 }
        };
        [of(&self.undercoat), if counted == Counted::Both { of(&self.guard) } else { 0.0 }]
    }

    /// Puts undercoat along a ray between two distances after `out`, in short intervals; tells whether there is shell at all.
    /// `nearby` may have been used for points close by.
    pub fn intervals(
        &self,
        ray: &DRay,
        [from_m, to_m]: [f64; 2],
        nearby: &mut Nearby,
        out: &mut Vec<MediumInterval>,
    ) -> bool {
        let Some(below) = self.below(Counted::Undercoat) else { return false };
        let (first, mut any) = (out.len(), false);
        self.slabs.visit(ray, [from_m, to_m], below, |sight, _, part, middle| {
            any = true;
            self.cut(sight, part, middle, out);
        });
        for some in out[first..].chunks_mut(MOST) {
            let mut points = Points::default();
            some.iter().for_each(|interval| points.push(&self.ground(&interval.point)));
            let crowding = points.crowding(&self.shell.undercoat, nearby);
            some.iter_mut().zip(crowding).for_each(|(interval, crowding)| interval.depth *= f64::from(crowding));
        }
        interval::put_in_order(out, first);
        any
    }

    /// Cuts part of a slab into intervals short enough for their middles to stand for them, as deep as where undercoat is as dense
    /// as in the mean.
    fn cut(&self, sight: &PrismRay, [from_m, to_m]: [f64; 2], middle: &Spots, out: &mut Vec<MediumInterval>) {
        let bare = |spots: &Spots| -> [f64; 3] {
            spots.map(|spot| spot.map_or(0.0, |spot| self.uncrowded(&spot, Counted::Undercoat)[0]))
        };
        let dense: f64 = bare(middle).iter().sum();
        let wanted = (to_m - from_m) * (dense / MOST_STEP_DEPTH).max(1.0 / self.detail_m);
        let parts = wanted.ceil().clamp(1.0, 256.0);
        let step_m = (to_m - from_m) / parts;
        for part in 0..parts as usize {
            let from_m = from_m + step_m * part as f64;
            let spots = if parts == 1.0 { *middle } else { sight.spots(from_m + 0.5 * step_m) };
            for (spot, bare) in spots.iter().zip(bare(&spots)) {
                if let Some(DShellSpot { point, .. }) = *spot {
                    out.push(MediumInterval {
                        from_m,
                        to_m: from_m + step_m,
                        depth: bare * step_m,
                        opacity: 0.0,
                        point,
                        seen: 0.0,
                    });
                }
            }
        }
    }

    /// Optical depth of hair along a ray from `from_m` up to `to_m`, or as much of it as passes `enough`.
    pub fn depth_along(&self, ray: &DRay, from_m: f64, to_m: f64, counted: Counted, enough: f64) -> f64 {
        let Some(below) = self.below(counted) else { return 0.0 };
        let (mut sum, mut at_m, mut empty) = (0.0, from_m, true);
        let mut nearby = Nearby::default();
        while sum < enough {
            // Boxes are looked for only where the last interval was empty.
            if empty {
                at_m = self.slabs.first(ray, at_m).max(at_m);
            }
            if at_m >= to_m {
                break;
            }
            // Where it gets dark, little more will be asked for.
            let strides = if at_m == from_m || sum > DIM { 1.5 } else { 4.0 };
            let end_m = (at_m + strides * self.stride_m()).min(to_m);
            empty = true;
            let mut crowd = Crowd::new(&self.shell.undercoat, &mut nearby);
            self.slabs.visit(ray, [at_m, end_m], below, |sight, slab, part, middle| {
                empty = false;
                sum += self.depth_of(sight, self.slabs.slab(slab).1[0] < 1.0, part, middle, counted, &mut crowd);
            });
            sum += crowd.rest();
            at_m = end_m;
        }
        sum
    }

    /// Optical depth of part of a slab, some of which may still wait in `crowd`.
    fn depth_of(
        &self,
        sight: &PrismRay,
        detailed: bool,
        [from_m, to_m]: [f64; 2],
        middle: &Spots,
        counted: Counted,
        crowd: &mut Crowd<'_>,
    ) -> f64 {
        let length_m = to_m - from_m;
        let mut sum = 0.0;
        let mut add = |spots: &Spots, weight_m: f64| {
            for spot in spots.iter().flatten() {
                let [bare, guard] = self.uncrowded(spot, counted);
                sum += guard * weight_m;
                if bare > 0.0 {
                    sum += crowd.push(&self.ground(&spot.point), bare * weight_m);
                }
            }
        };
        // Above undercoat, nothing is small.
        let parts = if detailed { (length_m / (3.0 * self.detail_m)).ceil().clamp(1.0, 64.0) } else { 1.0 };
        let half_m = 0.5 * length_m / parts;
        for part in 0..parts as usize {
            let middle_m = from_m + half_m * (2 * part + 1) as f64;
            if parts == 1.0 {
                add(middle, half_m * GAUSS[0]);
            } else {
                add(&sight.spots(middle_m), half_m * GAUSS[0]);
            }
            for side in [-1.0, 1.0] {
                add(&sight.spots(middle_m + side * half_m * OUTER), half_m * GAUSS[1]);
            }
        }
        sum
    }

    /// What crowding over a point depends on.
    fn ground(&self, point: &DShellPoint) -> Ground {
        let foot_m = self.shell.skin.rest_corners_m(point.triangle as usize).map(|p| p.as_dvec3());
        let root_m = foot_m[0] * point.b.x + foot_m[1] * point.b.y + foot_m[2] * point.b.z;
        let normals = self.rest_normals.as_deref().unwrap_or(self.normals);
        let normal = self.vector(normals, point).normalize_or(DVec3::Y);
        let clump = self.scalar(&self.shell.fields.clump, point);
        Ground { root_m: root_m.as_vec3(), normal: normal.as_vec3(), clump: clump as f32, t: point.t as f32 }
    }

    fn below(&self, counted: Counted) -> Option<f64> {
        match counted {
            Counted::Undercoat => self.undercoat.is_some().then_some(1.0),
            Counted::Both => Some(f64::INFINITY),
        }
    }

    /// How far a ray is followed at a time, m.
    pub fn stride_m(&self) -> f64 {
        0.25 * f64::from(self.shell.undercoat.height_m)
    }
}
