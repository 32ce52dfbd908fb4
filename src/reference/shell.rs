//! The prismatic shell in f64: slabs of prisms in a hierarchy. A point is x = Σ bᵢ (pᵢ + t oᵢ).

use super::bvh::{Bounds, DBvh, DRay};
use super::point::{DShellPoint, Spots};
use super::sight::PrismRay;
use crate::math::DVec3;
use crate::volume::shell::Shell;
use rayon::prelude::*;

/// Skin and offsets in f64, cut into slabs by height.
#[derive(Debug)]
pub struct Slabs {
    /// Of each triangle, its corners and their offsets, m.
    corners: Vec<([DVec3; 3], [DVec3; 3])>,
    /// Heights between slabs.
    heights: Vec<f64>,
    bounds: Vec<Bounds>,
    bvh: DBvh,
}

impl Slabs {
    /// Cuts a shell at these heights, the lowest first.
    pub fn new(shell: &Shell<'_>, heights: Vec<f64>) -> Self {
        let corners = (0..shell.skin.triangles.len())
            .map(|t| {
                let offsets_m = shell.skin.triangles[t].map(|v| shell.offsets_m[v as usize].as_dvec3());
                (shell.skin.corners_m(t).map(|p| p.as_dvec3()), offsets_m)
            })
            .collect();
        let mut slabs = Self { corners, heights, bounds: Vec::new(), bvh: DBvh::default() };
        let layers = slabs.heights.len() - 1;
        let bounds: Vec<Bounds> = (0..slabs.corners.len() * layers)
            .into_par_iter()
            .map(|i| {
                let (feet, offsets) = &slabs.corners[i / layers];
                let ends = [slabs.heights[i % layers], slabs.heights[i % layers + 1]];
                Bounds::of(ends.into_iter().flat_map(|t| (0..3).map(move |c| feet[c] + offsets[c] * t)), 0.0)
            })
            .collect();
        slabs.bvh = DBvh::new(&bounds);
        slabs.bounds = bounds;
        slabs
    }

    /// Triangle and heights of a slab.
    pub fn slab(&self, slab: u32) -> (u32, [f64; 2]) {
        let layers = self.heights.len() as u32 - 1;
        let layer = (slab % layers) as usize;
        (slab / layers, [self.heights[layer], self.heights[layer + 1]])
    }

    /// Position of a point, m.
    pub fn position_m(&self, point: &DShellPoint) -> DVec3 {
        let (feet, offsets) = &self.corners[point.triangle as usize];
        (0..3).map(|i| (feet[i] + offsets[i] * point.t) * point.b[i]).sum()
    }

    /// The way from skin to t = 1 at a point, m.
    pub fn up_m(&self, point: &DShellPoint) -> DVec3 {
        let (_, offsets) = &self.corners[point.triangle as usize];
        offsets[0] * point.b.x + offsets[1] * point.b.y + offsets[2] * point.b.z
    }

    /// Where, from `near_m` on, a ray first comes close to the shell.
    pub fn first(&self, ray: &DRay, near_m: f64) -> f64 {
        self.bvh.first(ray, near_m)
    }

    /// Calls `visit` with every part of a ray between two distances that lies in a slab which begins below height `below`: the
    /// slab as the ray passes it, the slab, the part, and the points at its middle.
    pub fn visit(
        &self,
        ray: &DRay,
        [from_m, to_m]: [f64; 2],
        below: f64,
        mut visit: impl FnMut(&PrismRay, u32, [f64; 2], &Spots),
    ) {
        self.bvh.visit(ray, from_m, to_m, |slab, far| {
            let (triangle, ends) = self.slab(slab);
            if ends[0] < below
                && let Some(inside) = self.bounds[slab as usize].span(ray, from_m, to_m)
            {
                let sight = PrismRay::new(ray, triangle, &self.corners[triangle as usize], ends);
                sight.spans([from_m, to_m], inside, |part, middle| visit(&sight, slab, part, middle));
            }
            far
        });
    }
}
