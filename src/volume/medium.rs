//! Undercoat over a flat square that repeats, as a volume: the law of [`super::march`] where the skin is level, so that a ray
//! needs no prisms.

use crate::data::ray::DepthRange;
use crate::data::ray::Ray;
use crate::fur::groom::fibre::Fibre;
use crate::fur::undercoat::{Columns, Pattern, Undercoat};
use crate::math::lanes::Scalar;
use crate::math::table::Table;
use crate::math::{Mat3, Vec2, Vec3};
use rayon::prelude::*;
use std::f32::consts::FRAC_PI_4;

/// Layers between skin and top in which crowding is stored.
const LAYERS: usize = 16;
/// Fewest and most cells along the square's edge in which it is stored.
const CELLS: (usize, usize) = (64, 512);
/// Steps of a ray through a layer's thickness, at least.
const STEPS: f32 = 2.0;
/// No ray takes more steps.
const MOST_STEPS: f32 = 65_536.0;

/// Undercoat of a square.
#[derive(Clone, Debug)]
pub struct Medium {
    undercoat: Undercoat,
    ramp: [Vec3; 3],
    edge_m: f32,
    cells: usize,
    /// Density over its mean, `[y][x][layer]`.
    crowding: Vec<f32>,
    reaching: Table,
    world_from_square: Mat3,
}

/// A part of a ray's way through it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MediumStep {
    /// Where it begins, m along the ray.
    pub from_m: f32,
    /// Where it ends, m along the ray.
    pub to_m: f32,
    /// Optical depth.
    pub depth: f32,
    /// Height of its middle, in [0, 1].
    pub t: f32,
}

impl MediumStep {
    /// Where its middle is, m along the ray.
    pub fn middle_m(&self) -> f32 {
        0.5 * (self.from_m + self.to_m)
    }

    /// Cuts off the part before `at_m` and returns it; what is behind stays.
    pub fn before(&mut self, at_m: f32) -> Self {
        let share = ((at_m - self.from_m) / (self.to_m - self.from_m)).clamp(0.0, 1.0);
        let before = Self { to_m: at_m.min(self.to_m), depth: self.depth * share, ..*self };
        *self = Self { from_m: before.to_m, depth: self.depth - before.depth, ..*self };
        before
    }
}

impl Medium {
    /// Of a kind of hair on a square with edge `edge_m`, which crowds as it would on level skin there; none where there is no
    /// such hair.
    pub fn new(fibre: &Fibre, pattern: Option<Pattern>, edge_m: f32) -> Option<Self> {
        let undercoat = Undercoat::new(fibre, pattern).on_torus(edge_m);
        Self::of_columns(undercoat, fibre, edge_m, |at| undercoat.column(at.extend(0.0), Vec3::Z, 1.0))
    }

    /// Crowding as `column` says, which is asked for places on the square, m.
    pub fn of_columns(
        undercoat: Undercoat,
        fibre: &Fibre,
        edge_m: f32,
        column: impl Fn(Vec2) -> Columns<Scalar> + Sync,
    ) -> Option<Self> {
        if undercoat.density_per_m2 <= 0.0 || undercoat.height_m <= 0.0 {
            return None;
        }
        // Two to the finest detail.
        let wanted = (2.0 * edge_m / undercoat.detail_m()).clamp(CELLS.0 as f32, CELLS.1 as f32);
        let cells = (wanted.ceil() as usize).next_power_of_two();
        let crowding = (0..cells * cells)
            .into_par_iter()
            .flat_map_iter(|i| {
                let at = Vec2::new((i % cells) as f32 + 0.5, (i / cells) as f32 + 0.5) * (edge_m / cells as f32);
                let column = column(at);
                (0..LAYERS).map(move |layer| column.crowding((layer as f32 + 0.5) / LAYERS as f32))
            })
            .collect();
        Some(Self {
            ramp: fibre.profile.ramp,
            edge_m,
            cells,
            crowding,
            reaching: Table::new(|t| undercoat.reaching(t)),
            world_from_square: Mat3::IDENTITY,
            undercoat,
        })
    }

    /// The same undercoat as a skin carries it, every hair mapped by `world_from_square` and as thick as before.
    pub fn mapped(&self, world_from_square: Mat3) -> Self {
        Self { world_from_square, ..self.clone() }
    }

    /// The hair.
    pub fn undercoat(&self) -> &Undercoat {
        &self.undercoat
    }

    /// Cells along the edge.
    pub fn cells(&self) -> usize {
        self.cells
    }

    /// Density over its mean at height `t` over a place of the square, m.
    pub fn crowding(&self, at_m: Vec2, t: f32) -> f32 {
        let at = (at_m * (self.cells as f32 / self.edge_m)).floor();
        let wrapped = |c: f32| (c as i32).rem_euclid(self.cells as i32) as usize;
        let layer = ((t * LAYERS as f32) as usize).min(LAYERS - 1);
        self.crowding[(wrapped(at.y) * self.cells + wrapped(at.x)) * LAYERS + layer]
    }

    /// Share of the hairs that reach height `t`; all have ended at 1.
    pub fn reaching(&self, t: f32) -> f32 {
        if t < 1.0 - 1e-4 { self.reaching.at(t) } else { 0.0 }
    }

    /// Colour of the hair at height `t`.
    pub fn colour(&self, t: f32) -> Vec3 {
        let [root, middle, tip] = self.ramp;
        if t < 0.5 { root.lerp(middle, 2.0 * t) } else { middle.lerp(tip, 2.0 * t - 1.0) }
    }

    /// Mean direction of the hair in the world, unit.
    pub fn hair(&self) -> Vec3 {
        self.world_from_square.z_axis.normalize_or(Vec3::Z)
    }

    /// Follows a ray as far as it is in the undercoat and in `range`, until `visit` returns false.
    ///
    /// Extinction is ρ⊥ D |sin∠|, ρ⊥ being hair length per volume; the ends of hairs between a step's heights add
    /// (π/4) D² |cos∠| each.
    pub fn walk(&self, ray: &Ray, range: DepthRange, mut visit: impl FnMut(MediumStep) -> bool) {
        let undercoat = &self.undercoat;
        let square_from_world = self.world_from_square.inverse();
        let (origin_m, rate) = (square_from_world * ray.origin_m, square_from_world * ray.direction);
        let (begin_t, rate_t) = (origin_m.z / undercoat.height_m, rate.z / undercoat.height_m);
        let (mut near_m, mut far_m) = (range.near_m, range.far_m);
        if rate_t == 0.0 {
            if !(0.0..=1.0).contains(&begin_t) {
                return;
            }
        } else {
            let (a, b) = (-begin_t / rate_t, (1.0 - begin_t) / rate_t);
            (near_m, far_m) = (near_m.max(a.min(b)), far_m.min(a.max(b)));
        }
        let cell_m = self.edge_m / self.cells as f32;
        let longest_m = (cell_m / rate.truncate().length()).min(1.0 / (STEPS * LAYERS as f32 * rate_t.abs()));
        let count = ((far_m - near_m) / longest_m).ceil().min(MOST_STEPS);
        let step_m = if count < MOST_STEPS { (far_m - near_m) / count } else { longest_m };
        let (hair, rise) = (self.hair(), self.world_from_square.z_axis.length());
        let standing = undercoat.density_per_m2 / self.world_from_square.determinant();
        let diameter_m = undercoat.diameter_m;
        let sine = undercoat.mean_sine(hair.cross(ray.direction).length());
        let sides_per_m = standing * rise * undercoat.stretch * sine * diameter_m;
        let end_area_m2 = FRAC_PI_4 * diameter_m * diameter_m * hair.dot(ray.direction).abs();
        let per_end = if rate.z == 0.0 { 0.0 } else { standing * end_area_m2 / rate.z.abs() };
        let mut reach = self.reaching(begin_t + rate_t * near_m);
        for i in 0..count.max(0.0) as usize {
            let [from_m, middle_m, to_m] = [0.0, 0.5, 1.0].map(|part| near_m + (i as f32 + part) * step_m);
            let t = begin_t + rate_t * middle_m;
            let before = std::mem::replace(&mut reach, self.reaching(begin_t + rate_t * to_m));
            let blocked = sides_per_m * self.reaching.at(t) * step_m + per_end * (reach - before).abs();
            let crowding = self.crowding((origin_m + rate * middle_m).truncate(), t);
            if !visit(MediumStep { from_m, to_m, depth: blocked * crowding, t }) {
                return;
            }
        }
    }

    /// Optical depth along a ray, or as much of it as passes `enough`.
    pub fn depth_along(&self, ray: &Ray, range: DepthRange, enough: f32) -> f32 {
        let mut sum = 0.0;
        self.walk(ray, range, |step| {
            sum += step.depth;
            sum < enough
        });
        sum
    }
}
