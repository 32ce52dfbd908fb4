//! Rays towards the key light through hair in the mean, some heights of one column side by side.

use super::kind::{HairKind, Table};
use super::{DARK, LAYERS, MeanShadow};
use crate::math::Vec3;
use crate::math::lanes::{self, F32s, Isa, MOST, Mask, Row, Vec3Row, Vec3s};
use crate::volume::shell::prism::ShellPoint;
use crate::volume::shell::prisms::{Prisms, ShellPoints, Vertex};
use crate::volume::shell::sides::{across, next_side};

/// Longest step, as a share of the tips' height over the skin.
const STEP: f32 = 1.0 / 12.0;

/// Farther from its line, in heights of the tips, nothing is followed.
const ASTRAY: f32 = 0.02;

/// How much shorter steps are in height than along the line: at folds heights change and distances do not.
const FOLDED: f32 = 8.0;

/// No point is set right by more, in its coordinates.
const MOST_BACK: f32 = 0.25;

/// No march takes more steps.
const MOST_STEPS: usize = 512;

/// A ray towards the light, and a point of the shell that it passes, from which it is followed through the shell.
#[derive(Clone, Copy, Debug)]
pub(super) struct ShadowRay {
    pub(super) triangle: u32,
    /// Where in the prism over the triangle following begins.
    pub(super) point: ShellPoint,
    /// Where the ray begins, m.
    pub(super) origin_m: Vec3,
    /// Where it ends at the latest, m from there.
    pub(super) far_m: f32,
    /// Whether it is followed the way on which it nears the light in prisms that are not inside out.
    pub(super) onwards: bool,
}

/// What a ray has met.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Found {
    /// Optical depths of undercoat and guard hair.
    pub(super) depths: [f32; 2],
    /// How far from its origin following ended, m; none where a fold led it back past that.
    pub(super) end_m: Option<f32>,
}

/// Rays that are followed together; none where no hair is on the way.
pub(super) type Rays = [Option<ShadowRay>; MOST];

/// Follows rays to the tips, the skin or an open border.
///
/// The points of the shell that lie on a line form curves. Along a curve points change by the adjugate of ∂x/∂(b₁, b₂, t) times
/// the line's direction, and the distance along the line by the determinant: nothing is divided, so a curve leads through a
/// fold, where prisms turn inside out and it turns back along the line, like through any other point.
pub(super) struct Walk<'m, 'a> {
    pub(super) mean: &'m MeanShadow<'a>,
    pub(super) rays: &'m Rays,
}

impl lanes::Work for Walk<'_, '_> {
    type Output = [Found; MOST];

    #[inline(always)]
    fn run<I: Isa>(self) -> Self::Output {
        let mut found = [Found::default(); MOST];
        for (found, rays) in found.chunks_mut(I::LANES).zip(self.rays.chunks(I::LANES)) {
            let mut walkers = Walkers::default();
            for (lane, ray) in rays.iter().enumerate() {
                if let Some(ray) = ray {
                    walkers.on |= 1 << lane;
                    walkers.origin_m.set(lane, ray.origin_m);
                    walkers.onwards.0[lane] = if ray.onwards { 1.0 } else { -1.0 };
                    walkers.far_m.0[lane] = ray.far_m;
                    walkers.enter(self.mean, lane, ray.triangle, ray.point);
                }
            }
            for _ in 0..MOST_STEPS {
                if walkers.on == 0 {
                    break;
                }
                self.step::<I>(&mut walkers);
            }
            for (lane, found) in found.iter_mut().enumerate() {
                let depths = [walkers.sum[0].0[lane], walkers.sum[1].0[lane]];
                let passed = walkers.passed >> lane & 1 == 1;
                *found = Found { depths, end_m: (!passed).then_some(walkers.at_m.0[lane]) };
            }
        }
        found
    }
}

/// Rays under way.
#[derive(Default)]
struct Walkers {
    /// A bit per lane: which are under way, and which have come back past their origins.
    on: u32,
    passed: u32,
    origin_m: Vec3Row,
    /// 1 or −1, as [`ShadowRay::onwards`].
    onwards: Row,
    far_m: Row,
    at_m: Row,
    b: [Row; 2],
    t: Row,
    sum: [Row; 2],
    triangles: [u32; MOST],
    prisms: Prisms,
}

impl Walkers {
    #[inline(always)]
    fn enter(&mut self, mean: &MeanShadow<'_>, lane: usize, triangle: u32, point: ShellPoint) {
        let [a, b, c] = mean.shell.skin.triangles[triangle as usize].map(|v| v as usize);
        let (a, b, c) = (vertex(mean, a), vertex(mean, b), vertex(mean, c));
        self.prisms.set(lane, [&a, &b, &c], mean.twice_area_m2[triangle as usize]);
        self.triangles[lane] = triangle;
        self.b[0].0[lane] = point.b[0];
        self.b[1].0[lane] = point.b[1];
        self.t.0[lane] = point.t;
    }
}

#[inline(always)]
fn vertex(mean: &MeanShadow<'_>, v: usize) -> Vertex {
    let shell = &mean.shell;
    Vertex {
        foot_m: shell.skin.positions_m[v],
        offset_m: shell.offsets_m[v],
        normal: Vec3::Y,
        tint: Vec3::ZERO,
        density: shell.fields.density[v],
        length: 1.0,
    }
}

impl Walk<'_, '_> {
    /// A step of all rays: to the next side, or as long as it may be.
    #[inline(always)]
    fn step<I: Isa>(&self, walkers: &mut Walkers) {
        let mean = self.mean;
        let zero = F32s::<I>::splat(0.0);
        let direction = Vec3s::splat(mean.to_light);
        let points = ShellPoints { b: [F32s::of(&walkers.b[0]), F32s::of(&walkers.b[1])], t: F32s::of(&walkers.t) };
        let j = walkers.prisms.jacobians(&points);
        let from_origin_m = j.at_m - Vec3s::of(&walkers.origin_m);
        let at_m = from_origin_m.dot(direction);
        // By how much points and distance change along the curve.
        let onwards = F32s::of(&walkers.onwards);
        let nearing = onwards * j.determinant;
        let rates = j.rates(direction) * nearing;
        // Back to the line by the shortest way across the curve, which folds leave as short as it is elsewhere.
        let off_m = direction * at_m - from_origin_m;
        let back = j.rates(off_m);
        let fastest = size(rates);
        // Rates have the size of areas, whose squares vanish on tiny skins.
        let way = rates * (F32s::splat(1.0) / fastest);
        let along = back.dot(way) / way.dot(way);
        let aside = back - way * along;
        let near = size(aside).lt(F32s::splat(MOST_BACK));
        let points = points.moved(aside, near.keep(F32s::splat(1.0)));
        let at_m = at_m - near.keep(along * (nearing / fastest));
        walkers.passed |= (Mask::from_bits(walkers.on) & !nearing.gt(zero) & !at_m.gt(zero)).bits();
        let left_m = nearing.gt(zero).select(F32s::of(&walkers.far_m) - at_m, at_m);
        let tips_m = j.up_m.length() * mean.tips;
        let sum = [F32s::of(&walkers.sum[0]), F32s::of(&walkers.sum[1])];
        let light = !(sum[0] + sum[1]).gt(F32s::splat(DARK));
        let moving = Mask::from_bits(walkers.on)
            & fastest.gt(zero)
            & fastest.lt(F32s::splat(f32::INFINITY))
            & left_m.gt(zero)
            & off_m.length().lt(tips_m * ASTRAY)
            & light;
        let pace = nearing.abs();
        let slowness = (pace / tips_m).max(rates.z.abs() * (FOLDED / mean.tips)) * (1.0 / STEP);
        let length = (F32s::splat(1.0) / slowness).min(left_m / pace);
        // On as it goes in the middle.
        let j = walkers.prisms.jacobians(&points.moved(rates, length * 0.5));
        let nearing = onwards * j.determinant;
        let rates = j.rates(direction) * nearing;
        let (side, after) = next_side(&points, rates, mean.tips);
        let length = length.min(after.max(zero));
        let middle = points.moved(rates, length * 0.5);
        let up_m = j.up_m.length();
        let sine = (j.up_m * (F32s::splat(1.0) / up_m)).cross(direction).length();
        let standing = walkers.prisms.density(middle.barycentric()) * walkers.prisms.twice_area_m2();
        let shares =
            [share(points.t, mean.tips), share(middle.t, mean.tips), share(points.t + rates.z * length, mean.tips)];
        for (k, kind) in mean.kinds.iter().enumerate() {
            let Some(kind) = kind else { continue };
            let depth = standing * up_m * width(kind, shares) * kind.slopes.mean_sines(sine) * length;
            let finite = moving & depth.lt(F32s::splat(f32::INFINITY));
            walkers.sum[k] = (sum[k] + finite.keep(depth)).row();
        }
        let walked = moving.keep(length);
        let points = points.moved(rates, walked);
        let crossing = (moving & !length.lt(after)).bits();
        walkers.at_m = moving.select(at_m + nearing * walked, F32s::of(&walkers.at_m)).row();
        walkers.on = moving.bits();
        walkers.b = [points.b[0].row(), points.b[1].row()];
        walkers.t = points.t.row();
        if crossing == 0 {
            return;
        }
        let side = side.row();
        for lane in 0..I::LANES {
            if crossing >> lane & 1 == 0 {
                continue;
            }
            let corner = side.0[lane] as usize;
            match mean.beyond(walkers.triangles[lane], corner) {
                Some((triangle, opposite)) => {
                    let point = ShellPoint { b: [walkers.b[0].0[lane], walkers.b[1].0[lane]], t: walkers.t.0[lane] };
                    walkers.enter(mean, lane, triangle, across(&point, corner, opposite));
                }
                None => walkers.on &= !(1 << lane),
            }
        }
    }
}

/// The largest of three sizes.
#[inline(always)]
fn size<I: Isa>(v: Vec3s<I>) -> F32s<I> {
    v.x.abs().max(v.y.abs()).max(v.z.abs())
}

/// Mean width of a kind of hair between two heights, the first and the last of three, in intervals of its tables.
#[inline(always)]
fn width<I: Isa>(kind: &HairKind, [from, middle, to]: [F32s<I>; 3]) -> F32s<I> {
    let rise = to - from;
    let steep = rise.abs().gt(F32s::splat(1.0));
    let mean = (at(&kind.width_below_per_m, to) - at(&kind.width_below_per_m, from)) / rise;
    steep.select(mean, at(&kind.width_per_m, middle))
}

/// A height in intervals of tables.
#[inline(always)]
fn share<I: Isa>(t: F32s<I>, tips: f32) -> F32s<I> {
    (t * (1.0 / tips)).within(0.0, 1.0) * (LAYERS * 4) as f32
}

/// Values of a table at points in [0, its last index].
#[inline(always)]
fn at<I: Isa>(table: &Table, point: F32s<I>) -> F32s<I> {
    let low = point.floor().min(F32s::splat((LAYERS * 4 - 1) as f32));
    let at = low.to_whole();
    let (from, to) = (at.gather(table), at.plus_splat(1).gather(table));
    from + (point - low) * (to - from)
}
