//! Faces that hair lies behind, as the light sees them: tips, open borders and skin.
//!
//! All rays to the light are parallel, so a ray is a point across them: faces are sorted into squares there, and a ray asks
//! one square.

use crate::math::Vec3;
use crate::volume::bins::{Bins, Reach, TILE, TileGrid};
use crate::volume::shell::Shell;
use crate::volume::shell::outer::{self, corner};
use crate::volume::shell::prism::ShellPoint;
use rayon::prelude::*;

/// Where a ray towards the light leaves hair, as far as prisms are not inside out: there it is the other way around.
#[derive(Clone, Copy, Debug)]
pub(super) struct Exit {
    /// Distance from the ray's origin, m.
    pub(super) at_m: f32,
    pub(super) triangle: u32,
    pub(super) point: ShellPoint,
}

/// Skin, tips and borders over all triangles, in this order.
#[derive(Debug)]
pub(super) struct Faces {
    /// Across the light twice, and towards it, right-handed.
    axes: [Vec3; 3],
    /// Least coordinates across the light, m.
    low_m: [f32; 2],
    /// Squares' edges over tiles' pixels.
    px_per_m: f32,
    grid: TileGrid,
    bins: Bins,
    triangles: usize,
    /// Those after the skin.
    outer: Vec<(u32, [ShellPoint; 3])>,
    /// Corners of all, as the light sees them.
    corners: Vec<[Vec3; 3]>,
}

/// Faces per square, about.
const PER_SQUARE: f32 = 2.0;

/// Most squares along an edge.
const MOST_SQUARES: f32 = 2048.0;

impl Faces {
    /// Of a shell up to `tips` times its height.
    pub(super) fn new(shell: &Shell<'_>, tips: f32, to_light: Vec3) -> Self {
        let across = to_light.any_orthonormal_vector();
        let triangles = shell.skin.triangles.len();
        // As prisms' coordinates have them.
        let of_triangle = |t| outer::faces(shell, t, tips).map(|face| (face.triangle, face.unturned()));
        let mut faces = Self {
            axes: [across, to_light.cross(across), to_light],
            low_m: [0.0; 2],
            px_per_m: 1.0,
            grid: TileGrid::whole([1, 1]),
            bins: Bins::default(),
            triangles,
            outer: (0..triangles as u32).flat_map(of_triangle).collect(),
            corners: Vec::new(),
        };
        let count = triangles + faces.outer.len();
        faces.corners = (0..count).into_par_iter().map(|face| faces.corners_of(shell, face)).collect();
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for (foot_m, offset_m) in shell.skin.positions_m.iter().zip(&shell.offsets_m) {
            for t in [0.0, tips] {
                let p = faces.seen(*foot_m + *offset_m * t);
                (low, high) = (low.min(p), high.max(p));
            }
        }
        let extent_m = (high - low).max(Vec3::splat(f32::MIN_POSITIVE));
        let square_m = (extent_m.x * extent_m.y * PER_SQUARE / count as f32).sqrt();
        let square_m = square_m.max(extent_m.x.max(extent_m.y) / MOST_SQUARES);
        if !(square_m > 0.0 && square_m < f32::INFINITY) {
            return faces;
        }
        faces.low_m = [low.x, low.y];
        faces.px_per_m = TILE as f32 / square_m;
        faces.grid = TileGrid::whole([extent_m.x, extent_m.y].map(|e| (e * faces.px_per_m) as usize + 1));
        faces.bins = Bins::new(&faces.grid, count, |i| {
            let mut reach = Reach::NOTHING;
            for &p in &faces.corners[i] {
                let [x, y] = faces.px(p);
                reach.add(x, y, 0.0);
            }
            reach
        });
        faces
    }

    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        self.bins.bytes() + size_of_val(&self.outer[..]) + size_of_val(&self.corners[..])
    }

    /// A point as the light sees it: across it twice, and towards it, m.
    fn seen(&self, point_m: Vec3) -> Vec3 {
        Vec3::from(self.axes.map(|axis| axis.dot(point_m)))
    }

    fn px(&self, seen: Vec3) -> [f32; 2] {
        [(seen.x - self.low_m[0]) * self.px_per_m, (seen.y - self.low_m[1]) * self.px_per_m]
    }

    fn points(&self, face: usize) -> (u32, [ShellPoint; 3]) {
        match face.checked_sub(self.triangles) {
            Some(outer) => self.outer[outer],
            None => (face as u32, [0, 1, 2].map(|i| corner(i, 0.0))),
        }
    }

    fn corners_of(&self, shell: &Shell<'_>, face: usize) -> [Vec3; 3] {
        let (triangle, points) = self.points(face);
        let corners = shell.skin.triangles[triangle as usize].map(|v| v as usize);
        points.map(|point| {
            let v = corners[if point.b[0] > 0.0 {
                1
            } else if point.b[1] > 0.0 {
                2
            } else {
                0
            }];
            self.seen(shell.skin.positions_m[v] + shell.offsets_m[v] * point.t)
        })
    }

    /// How far a ray from a point to the light goes before it meets skin, m, and where it leaves hair until there, from
    /// `near_m` on; in no order.
    pub(super) fn exits(&self, from_m: Vec3, near_m: f32, out: &mut Vec<Exit>) -> f32 {
        out.clear();
        let from = self.seen(from_m);
        let [x, y] = self.px(from);
        let mut reach = Reach::NOTHING;
        reach.add(x, y, 0.0);
        let (columns, rows) = self.grid.touched(&reach);
        let (Some(column), Some(row)) = (columns.last(), rows.last()) else { return f32::INFINITY };
        let mut far_m = f32::INFINITY;
        for &face in self.bins.of(row * self.grid.columns + column) {
            let face = face as usize;
            let [a, b, c] = self.corners[face].map(|p| p - from);
            // Products in this order are the same, but for their sign, from both sides of an edge: no ray slips through.
            let cross = |p: Vec3, q: Vec3| p.x * q.y - p.y * q.x;
            let e = Vec3::new(cross(b, c), cross(c, a), cross(a, b));
            let area = e.x + e.y + e.z;
            if !(e.min_element() >= 0.0 || e.max_element() <= 0.0) || area == 0.0 {
                continue;
            }
            let e = e / area;
            let at_m = e.x * a.z + e.y * b.z + e.z * c.z;
            if !(at_m > near_m && at_m <= far_m) {
                continue;
            }
            let is_skin = face < self.triangles;
            let leaves = (area > 0.0) != is_skin;
            if is_skin {
                far_m = at_m;
            }
            if !leaves {
                continue;
            }
            let (triangle, [p, q, r]) = self.points(face);
            let mix = |p: f32, q: f32, r: f32| e.x * p + e.y * q + e.z * r;
            let b = [0, 1].map(|i| mix(p.b[i], q.b[i], r.b[i]));
            out.push(Exit { at_m, triangle, point: ShellPoint { b, t: mix(p.t, q.t, r.t) } });
        }
        out.retain(|exit| exit.at_m <= far_m);
        far_m
    }
}
