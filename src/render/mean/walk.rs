//! Rays towards the key light through hair in the mean, some heights of one vertex side by side.

use super::{DARK, LAYERS, MeanShadow};
use crate::math::Vec3;
use crate::math::lanes::{self, F32s, Isa, MOST, Mask, Row, Vec3Row, Vec3s};
use crate::render::march::prisms::{Places, Prisms};
use crate::render::march::volume::Vertex;
use crate::render::march::{across, next_side};
use crate::render::shell::prism::Place;

/// Longest step, as a share of the tips' height over the skin.
const STEP: f32 = 1.0 / 16.0;

/// No march takes more steps.
const MOST_STEPS: usize = 512;

/// A ray from inside the shell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ray {
    pub(super) triangle: u32,
    /// Where in the prism over the triangle it begins.
    pub(super) place: Place,
    /// The same, m.
    pub(super) origin_m: Vec3,
    /// Whether it goes to the light or away from it.
    pub(super) to_light: bool,
    /// Where it ends at the latest, m.
    pub(super) far_m: f32,
}

/// What a ray has met.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Found {
    /// Optical depths of undercoat and guard hair.
    pub(super) depths: [f32; 2],
    /// How far it went, m.
    pub(super) end_m: f32,
}

/// Rays that are followed together; none where no hair is on the way.
pub(super) type Rays = [Option<Ray>; MOST];

/// Follows rays to the tips, the skin, an open border or a fold, where prisms turn inside out.
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
                    walkers.along.0[lane] = if ray.to_light { 1.0 } else { -1.0 };
                    walkers.far_m.0[lane] = ray.far_m;
                    walkers.enter(self.mean, lane, ray.triangle, ray.place);
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
                *found = Found { depths, end_m: walkers.at_m.0[lane] };
            }
        }
        found
    }
}

/// Rays under way.
#[derive(Default)]
struct Walkers {
    /// A bit per lane.
    on: u32,
    origin_m: Vec3Row,
    /// 1 towards the light, −1 away from it.
    along: Row,
    far_m: Row,
    at_m: Row,
    /// Sign of the determinant at the last place, which changes at folds.
    sign: Row,
    b: [Row; 2],
    t: Row,
    sum: [Row; 2],
    triangles: [u32; MOST],
    prisms: Prisms,
}

impl Walkers {
    #[inline(always)]
    fn enter(&mut self, mean: &MeanShadow<'_>, lane: usize, triangle: u32, place: Place) {
        let [a, b, c] = mean.shell.skin.triangles[triangle as usize].map(|v| v as usize);
        let (a, b, c) = (vertex(mean, a), vertex(mean, b), vertex(mean, c));
        self.prisms.set(lane, [&a, &b, &c], mean.twice_area_m2[triangle as usize]);
        self.triangles[lane] = triangle;
        self.b[0].0[lane] = place.b[0];
        self.b[1].0[lane] = place.b[1];
        self.t.0[lane] = place.t;
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
        let direction = Vec3s::splat(mean.to_light) * F32s::of(&walkers.along);
        let at_m = F32s::of(&walkers.at_m);
        let places = Places { b: [F32s::of(&walkers.b[0]), F32s::of(&walkers.b[1])], t: F32s::of(&walkers.t) };
        let j = walkers.prisms.jacobians(&places);
        let places = places.moved(j.rates(Vec3s::of(&walkers.origin_m) + direction * at_m - j.at_m), F32s::splat(1.0));
        let rates = j.rates(direction);
        let fastest = rates.x.abs() + rates.y.abs() + rates.z.abs();
        let sum = [F32s::of(&walkers.sum[0]), F32s::of(&walkers.sum[1])];
        let light = !(sum[0] + sum[1]).gt(F32s::splat(DARK));
        let left_m = F32s::of(&walkers.far_m) - at_m;
        let sign = j.determinant.lt(zero).select(F32s::splat(-1.0), F32s::splat(1.0));
        let folded = (F32s::of(&walkers.sign) * sign).lt(zero);
        let moving = Mask::from_bits(walkers.on)
            & fastest.gt(zero)
            & fastest.lt(F32s::splat(f32::INFINITY))
            & left_m.gt(zero)
            & light
            & !folded;
        walkers.sign = sign.row();
        let up_m = j.up_m.length();
        let tips_m = up_m * mean.tips;
        let (side, after_m) = next_side(&places, rates, mean.tips);
        let length_m = after_m.max(zero).min(tips_m * STEP).min(left_m);
        let middle = places.moved(rates, length_m * 0.5);
        let sine = (j.up_m * (F32s::splat(1.0) / up_m)).cross(direction).length();
        let standing =
            walkers.prisms.density(middle.barycentric()) * walkers.prisms.twice_area_m2() / j.determinant.abs();
        let share = (middle.t * (1.0 / mean.tips)).within(0.0, 1.0) * (LAYERS * 4) as f32;
        for (k, kind) in mean.kinds.iter().enumerate() {
            let Some(kind) = kind else { continue };
            let depth = standing * up_m * width(&kind.width_per_m, share) * kind.slopes.mean_sines(sine) * length_m;
            let finite = moving & depth.lt(F32s::splat(f32::INFINITY));
            walkers.sum[k] = (sum[k] + finite.keep(depth)).row();
        }
        let walked_m = moving.keep(length_m);
        let places = places.moved(rates, walked_m);
        let crossing = (moving & !length_m.lt(after_m)).bits();
        walkers.on = moving.bits();
        walkers.at_m = (at_m + walked_m).row();
        walkers.b = [places.b[0].row(), places.b[1].row()];
        walkers.t = places.t.row();
        if crossing == 0 {
            return;
        }
        let (side, tips_m) = (side.row(), tips_m.row());
        for lane in 0..I::LANES {
            if crossing >> lane & 1 == 0 {
                continue;
            }
            let corner = side.0[lane] as usize;
            match mean.beyond(walkers.triangles[lane], corner) {
                Some((triangle, opposite)) => {
                    let place = Place { b: [walkers.b[0].0[lane], walkers.b[1].0[lane]], t: walkers.t.0[lane] };
                    walkers.enter(mean, lane, triangle, across(&place, corner, opposite));
                    walkers.at_m.0[lane] += 1e-8 * tips_m.0[lane];
                }
                None => walkers.on &= !(1 << lane),
            }
        }
    }
}

/// Values of a table at `share` in [0, its last index].
#[inline(always)]
fn width<I: Isa>(table: &[f32; LAYERS * 4 + 1], share: F32s<I>) -> F32s<I> {
    let low = share.floor().min(F32s::splat((LAYERS * 4 - 1) as f32));
    let at = low.to_whole();
    let (from, to) = (at.gather(table), at.plus_splat(1).gather(table));
    from + (share - low) * (to - from)
}
