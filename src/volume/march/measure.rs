//! Optical depth of undercoat along rays.

use super::volume::Volume;
use super::{MOST_STEP_GROWTH, MarchRay, MarchSteps, MarchVisitor, Stepping};
use crate::math::lanes::{self, F32s, Isa, MOST, Mask, Row};
use crate::volume::shell::prisms::Prisms;

impl Volume<'_> {
    /// Optical depths along rays, each up to `enough`, and the time spent on filling densities, ns. Steps lengthen by `step_growth`
    /// for each optical depth passed.
    pub fn depths_along(
        &self,
        rays: &[MarchRay],
        stepping: &Stepping,
        step_growth: f32,
        enough: f32,
    ) -> (Vec<f32>, u64) {
        lanes::run(Measure { volume: self, rays, stepping, step_growth, enough })
    }
}

/// Follows rays for their optical depth.
struct Measure<'v, 'a, 'j> {
    volume: &'v Volume<'a>,
    rays: &'j [MarchRay],
    stepping: &'j Stepping,
    step_growth: f32,
    enough: f32,
}

impl lanes::Work for Measure<'_, '_, '_> {
    type Output = (Vec<f32>, u64);

    #[inline(always)]
    fn run<I: Isa>(self) -> (Vec<f32>, u64) {
        let Self { volume, rays, stepping, step_growth, enough } = self;
        let found = vec![0.0; rays.len()];
        let mut depths = Depths { rays, next: 0, index: [0; MOST], sum: Row::default(), step_growth, enough, found };
        let filling_ns = super::march::<I, _>(volume, stepping, &mut depths);
        (depths.found, filling_ns)
    }
}

/// Sums optical depth.
struct Depths<'j> {
    rays: &'j [MarchRay],
    next: usize,
    index: [usize; MOST],
    sum: Row,
    step_growth: f32,
    enough: f32,
    found: Vec<f32>,
}

impl<I: Isa> MarchVisitor<I> for Depths<'_> {
    #[inline(always)]
    fn next(&mut self, lane: usize) -> Option<MarchRay> {
        let march_ray = *self.rays.get(self.next)?;
        self.index[lane] = self.next;
        self.sum.0[lane] = 0.0;
        self.next += 1;
        Some(march_ray)
    }

    #[inline(always)]
    fn step_scale(&self) -> F32s<I> {
        (F32s::of(&self.sum) * self.step_growth + 1.0).min(F32s::splat(MOST_STEP_GROWTH))
    }

    #[inline(always)]
    fn visit(&mut self, _: &Prisms, steps: &MarchSteps<I>, on: Mask<I>) -> Mask<I> {
        let sum = F32s::of(&self.sum) + on.keep(steps.depth);
        self.sum = sum.row();
        sum.lt(F32s::splat(self.enough))
    }

    #[inline(always)]
    fn end(&mut self, lane: usize) {
        self.found[self.index[lane]] = self.sum.0[lane];
    }
}
