//! Crowding of undercoat at several points at once: the one part of the reference that runs in lanes.

use crate::fur::groom::clump::Nearby;
use crate::fur::undercoat::Undercoat;
use crate::math::Vec3;
use crate::math::lanes::{self, F32s, Isa, MOST, Row, Vec3Row, Vec3s};

/// A point of the shell, and what stands under it.
#[derive(Clone, Copy, Debug)]
pub struct Ground {
    /// The skin at rest, m.
    pub root_m: Vec3,
    /// Unit normal there.
    pub normal: Vec3,
    /// How strongly hair clumps there.
    pub clump: f32,
    /// Height of the point.
    pub t: f32,
}

/// Points of the shell, up to as many as there are lanes.
#[derive(Clone, Copy, Debug, Default)]
pub struct Points {
    /// Under each the skin at rest, m.
    root_m: Vec3Row,
    /// Unit normal there.
    normal: Vec3Row,
    /// How strongly hair clumps there.
    clump: Row,
    /// Heights.
    t: Row,
    count: usize,
}

impl Points {
    /// Adds a point; full at [`MOST`].
    pub fn push(&mut self, point: &Ground) {
        self.root_m.set(self.count, point.root_m);
        self.normal.set(self.count, point.normal);
        (self.clump.0[self.count], self.t.0[self.count]) = (point.clump, point.t);
        self.count += 1;
    }

    /// Whether no point fits.
    pub fn is_full(&self) -> bool {
        self.count == MOST
    }

    /// Density over its mean at each point; none are left. `nearby` may have been used for points close by.
    pub fn crowding(&mut self, undercoat: &Undercoat, nearby: &mut Nearby) -> [f32; MOST] {
        let found = lanes::run(Crowding { points: self, undercoat, nearby });
        self.count = 0;
        found
    }
}

/// Sums over crowded undercoat, asked for as many points at a time as there are lanes.
#[derive(Debug)]
pub struct Crowd<'p> {
    undercoat: &'p Undercoat,
    nearby: &'p mut Nearby,
    points: Points,
    /// What each point counts for where undercoat is as dense as in the mean.
    weights: [f64; MOST],
}

impl<'p> Crowd<'p> {
    /// An empty sum.
    pub fn new(undercoat: &'p Undercoat, nearby: &'p mut Nearby) -> Self {
        Self { undercoat, nearby, points: Points::default(), weights: [0.0; MOST] }
    }

    /// Adds a point; gives what those that are known by now count for, each once.
    pub fn push(&mut self, point: &Ground, weight: f64) -> f64 {
        self.weights[self.points.count] = weight;
        self.points.push(point);
        if self.points.is_full() { self.rest() } else { 0.0 }
    }

    /// What those count for that have not been counted yet.
    pub fn rest(&mut self) -> f64 {
        let count = self.points.count;
        if count == 0 {
            return 0.0;
        }
        let crowding = self.points.crowding(self.undercoat, self.nearby);
        self.weights[..count].iter().zip(crowding).map(|(weight, crowding)| weight * f64::from(crowding)).sum()
    }
}

struct Crowding<'p> {
    points: &'p Points,
    undercoat: &'p Undercoat,
    nearby: &'p mut Nearby,
}

impl lanes::Work for Crowding<'_> {
    type Output = [f32; MOST];

    #[inline(always)]
    fn run<I: Isa>(self) -> [f32; MOST] {
        let Self { points, undercoat, nearby } = self;
        let mut found = [0.0; MOST];
        for first in (0..points.count).step_by(I::LANES) {
            // Past the last point, lanes hold it again: no cell is looked up for nothing.
            let at = |lane: usize| (first + lane).min(points.count - 1);
            let mut rows = (Vec3Row::default(), Vec3Row::default());
            for lane in 0..I::LANES {
                rows.0.set(lane, points.root_m.lane(at(lane)));
                rows.1.set(lane, points.normal.lane(at(lane)));
            }
            let columns = undercoat.columns::<I>(
                nearby,
                Vec3s::of(&rows.0),
                Vec3s::of(&rows.1),
                F32s::each(|lane| points.clump.0[at(lane)]),
            );
            let row = columns.crowdings(F32s::each(|lane| points.t.0[at(lane)])).row();
            let count = I::LANES.min(points.count - first);
            found[first..first + count].copy_from_slice(&row.0[..count]);
        }
        found
    }
}
