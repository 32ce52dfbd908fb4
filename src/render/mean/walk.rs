//! Rays towards the key light through hair in the mean, some heights of one vertex side by side.

use super::{DARK, LAYERS, MeanShadow};
use crate::math::Vec3;
use crate::math::lanes::{self, F32s, Isa, MOST, Mask, Row, Vec3Row, Vec3s};
use crate::render::march::prisms::{Places, Prisms};
use crate::render::march::volume::Vertex;
use crate::render::shell::prism::Place;

/// Longest step, as a share of the tips' height over the skin.
const STEP: f32 = 1.0 / 16.0;

/// No march takes more steps.
const MOST_STEPS: usize = 512;

/// Where rays begin: prism, place and position, m; none where no hair is on the way.
pub(super) type Starts = [Option<(u32, Place, Vec3)>; MOST];

/// Follows rays to the tips or an open border; gives the optical depths of undercoat and guard hair.
pub(super) struct Walk<'m, 'a> {
    pub(super) mean: &'m MeanShadow<'a>,
    pub(super) starts: &'m Starts,
}

impl lanes::Work for Walk<'_, '_> {
    type Output = [[f32; 2]; MOST];

    #[inline(always)]
    fn run<I: Isa>(self) -> Self::Output {
        let mut depths = [[0.0; 2]; MOST];
        for (depths, starts) in depths.chunks_mut(I::LANES).zip(self.starts.chunks(I::LANES)) {
            let mut walkers = Walkers::default();
            for (lane, start) in starts.iter().enumerate() {
                if let Some((triangle, place, origin_m)) = *start {
                    walkers.on |= 1 << lane;
                    walkers.origin_m.set(lane, origin_m);
                    walkers.enter(self.mean, lane, triangle, place);
                }
            }
            for _ in 0..MOST_STEPS {
                if walkers.on == 0 {
                    break;
                }
                self.step::<I>(&mut walkers);
            }
            for (lane, depths) in depths.iter_mut().enumerate() {
                *depths = [walkers.sum[0].0[lane], walkers.sum[1].0[lane]];
            }
        }
        depths
    }
}

/// Rays under way.
#[derive(Default)]
struct Walkers {
    /// A bit per lane.
    on: u32,
    origin_m: Vec3Row,
    at_m: Row,
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
        let direction = Vec3s::splat(mean.to_light);
        let at_m = F32s::of(&walkers.at_m);
        let places = Places { b: [F32s::of(&walkers.b[0]), F32s::of(&walkers.b[1])], t: F32s::of(&walkers.t) };
        let j = walkers.prisms.jacobians(&places);
        let places = places.moved(j.rates(Vec3s::of(&walkers.origin_m) + direction * at_m - j.at_m), F32s::splat(1.0));
        let rates = j.rates(direction);
        let fastest = rates.x.abs() + rates.y.abs() + rates.z.abs();
        let sum = [F32s::of(&walkers.sum[0]), F32s::of(&walkers.sum[1])];
        let light = !(sum[0] + sum[1]).gt(F32s::splat(DARK));
        let moving = Mask::from_bits(walkers.on) & fastest.gt(zero) & fastest.lt(F32s::splat(f32::INFINITY)) & light;
        let up_m = j.up_m.length();
        let tips_m = up_m * mean.tips;
        let (side, after_m) = next_side(&places, rates, mean.tips);
        let length_m = after_m.max(zero).min(tips_m * STEP);
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
    let at = low.to_whole().row();
    let (mut from, mut to) = (Row::default(), Row::default());
    for lane in 0..I::LANES {
        let at = (at[lane] as usize).min(LAYERS * 4 - 1);
        (from.0[lane], to.0[lane]) = (table[at], table[at + 1]);
    }
    F32s::of(&from) + (share - low) * (F32s::of(&to) - F32s::of(&from))
}

/// The sides passed first: opposite to corners 0, 1 and 2, then the tips and the skin; and after what distance, m.
#[inline(always)]
fn next_side<I: Isa>(places: &Places<I>, rates: Vec3s<I>, tips: f32) -> (F32s<I>, F32s<I>) {
    let b = places.barycentric();
    let (mut side, mut after) = (F32s::splat(3.0), F32s::splat(f32::INFINITY));
    let left =
        [(b.x, -rates.x - rates.y), (b.y, rates.x), (b.z, rates.y), (-places.t + tips, -rates.z), (places.t, rates.z)];
    for (i, (left, rate)) in left.into_iter().enumerate() {
        let distance = left / -rate;
        let first = rate.lt(F32s::splat(0.0)) & distance.lt(after);
        side = first.select(F32s::splat(i as f32), side);
        after = first.select(distance, after);
    }
    (side, after)
}

/// A place on the edge opposite to `corner`, in the neighbour whose `opposite` corner lies beyond it: it runs through the
/// shared edge the other way around.
fn across(place: &Place, corner: usize, opposite: usize) -> Place {
    let b = place.barycentric().to_array();
    let mut next = [0.0; 3];
    next[(opposite + 1) % 3] = b[(corner + 2) % 3];
    next[(opposite + 2) % 3] = b[(corner + 1) % 3];
    let whole = next[0] + next[1] + next[2];
    Place { b: [next[1] / whole, next[2] / whole], t: place.t }
}
