//! A chart and what lies around it: its own triangles, and those across its borders unfolded into its plane, so that hair
//! that leans over a border is in both charts and filtering at a border meets the hair that is there.

use crate::data::mesh::Mesh;
use crate::data::patches::Patches;
use crate::data::topology::{NO_NEIGHBOUR, Topology};
use crate::math::Vec2;
use std::collections::{HashSet, VecDeque};

/// A triangle of the skin in a chart's plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChartTriangle {
    /// Triangle of the skin.
    pub triangle: usize,
    /// Its corners, in texels from the region's first.
    pub corners: [Vec2; 3],
}

impl ChartTriangle {
    fn holds(&self, p: Vec2) -> bool {
        let [a, b, c] = self.corners;
        let side = |a: Vec2, b: Vec2| (b - a).perp_dot(p - a);
        side(a, b) >= 0.0 && side(b, c) >= 0.0 && side(c, a) >= 0.0
    }

    fn middle(&self) -> Vec2 {
        (self.corners[0] + self.corners[1] + self.corners[2]) / 3.0
    }
}

/// A chart's region of the plane, with every triangle that has a place in it. No place belongs to two triangles: the
/// earlier one has it.
#[derive(Clone, Debug)]
pub struct ChartRegion {
    /// Texels along x and y.
    pub size: [usize; 2],
    /// The chart's own triangles, then those around it.
    pub placed: Vec<ChartTriangle>,
    /// How many of them are the chart's own.
    pub own: usize,
    /// Per texel: the triangles that may lie in it.
    cells: Vec<Vec<u32>>,
}

impl ChartRegion {
    /// The region around `rectangle` (first column and row, columns and rows) of chart `chart`, `margin` texels wider on
    /// every side. `own` are the chart's triangles, `texels` those along the square's edge.
    pub fn new(
        mesh: &Mesh,
        topology: &Topology,
        patches: &Patches,
        own: &[usize],
        texels: u32,
        rectangle: [u32; 4],
        margin: u32,
    ) -> Self {
        let first = [0, 1].map(|i| i64::from(rectangle[i]) - i64::from(margin));
        let size = [2, 3].map(|i| (rectangle[i] + 2 * margin) as usize);
        let mut region = Self { size, placed: Vec::new(), own: 0, cells: vec![Vec::new(); size[0] * size[1]] };
        let origin = Vec2::new(first[0] as f32, first[1] as f32);
        let corners = |t: usize| patches.triangles[t].map(|v| patches.uv[v as usize] * texels as f32 - origin);
        for &triangle in own {
            region.push(ChartTriangle { triangle, corners: corners(triangle) });
        }
        region.own = own.len();
        // Across every edge that the chart does not go on over, the neighbour; from there on, its neighbours.
        let mut edges: VecDeque<(usize, usize)> = (0..own.len()).flat_map(|i| (0..3).map(move |k| (i, k))).collect();
        let mut outside = HashSet::new();
        while let Some((i, k)) = edges.pop_front() {
            let here = region.placed[i];
            let across = topology.across[3 * here.triangle + k];
            if across == NO_NEIGHBOUR {
                continue;
            }
            let (triangle, edge) = (across as usize / 3, across as usize % 3);
            let (p, q) = (here.corners[k], here.corners[(k + 1) % 3]);
            let Some(placed) = unfolded(mesh, triangle, edge, q, p) else { continue };
            // What is there already is the same triangle, or one that came by a shorter way.
            let middle = placed.middle();
            let free =
                if region.cell(middle).is_some() { region.at(middle).is_none() } else { outside.insert(triangle) };
            if free && region.touches(&placed) {
                region.push(placed);
                let next = region.placed.len() - 1;
                edges.extend((0..3).filter(|&other| other != edge).map(|other| (next, other)));
            }
        }
        region
    }

    /// The first triangle that holds a point, in texels of the region.
    pub fn at(&self, p: Vec2) -> Option<usize> {
        self.cells[self.cell(p)?].iter().map(|&i| i as usize).find(|&i| self.placed[i].holds(p))
    }

    fn cell(&self, p: Vec2) -> Option<usize> {
        let (x, y) = (p.x.floor(), p.y.floor());
        let inside = x >= 0.0 && y >= 0.0 && x < self.size[0] as f32 && y < self.size[1] as f32;
        inside.then(|| y as usize * self.size[0] + x as usize)
    }

    fn bounds(&self, placed: &ChartTriangle) -> [[usize; 2]; 2] {
        let [a, b, c] = placed.corners;
        let clamp = |p: Vec2| {
            let edge = |v: f32, size: usize| (v.floor().max(0.0) as usize).min(size);
            [edge(p.x, self.size[0]), edge(p.y, self.size[1])]
        };
        [clamp(a.min(b).min(c)), clamp(a.max(b).max(c) + 1.0)]
    }

    fn touches(&self, placed: &ChartTriangle) -> bool {
        let [low, high] = self.bounds(placed);
        low[0] < high[0] && low[1] < high[1]
    }

    fn push(&mut self, placed: ChartTriangle) {
        let index = self.placed.len() as u32;
        let [low, high] = self.bounds(&placed);
        for y in low[1]..high[1] {
            for x in low[0]..high[0] {
                self.cells[y * self.size[0] + x].push(index);
            }
        }
        self.placed.push(placed);
    }
}

/// A triangle laid beside the edge from `from` to `to`, which is its edge `edge`, as it is on the skin, at the scale that
/// the edge has. `None` where it has no area or the edge no length.
fn unfolded(mesh: &Mesh, triangle: usize, edge: usize, from: Vec2, to: Vec2) -> Option<ChartTriangle> {
    let points_m = mesh.corners_m(triangle);
    let [a, b, c] = [0, 1, 2].map(|i| points_m[(edge + i) % 3]);
    let length_m = a.distance(b);
    let along = (b - a) / length_m;
    let x_m = (c - a).dot(along);
    let y_m = (c - a - along * x_m).length();
    let axis = (to - from) / length_m;
    let apex = from + axis * x_m + axis.perp() * y_m;
    let mut corners = [Vec2::ZERO; 3];
    (corners[edge], corners[(edge + 1) % 3], corners[(edge + 2) % 3]) = (from, to, apex);
    let area = (to - from).perp_dot(apex - from);
    (area.is_finite() && area > 0.0).then_some(ChartTriangle { triangle, corners })
}
