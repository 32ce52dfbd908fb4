//! Stitches borders: moves the texture a little so that it goes on across them.
//!
//! Patches run along one comb at one scale, so across a border the texture is shifted and hardly turned. As tiles repeat,
//! it goes on where the shift is a whole number of tiles. Borders whose shift is near one are welded there, and the
//! displacement δ that this takes is spread over the skin around them: it minimises Σ_f A_f (|∇δ|² + |δ|²/ℓ²), a screened
//! Laplacian, by conjugate gradients. Welds that would stretch a triangle beyond the limits are given up. Where the comb
//! spreads, whole tiles have to begin somewhere: there borders stay, as dislocations do in a crystal.

use super::Surface;
use super::patch::Limits;
use crate::data::patches::Patches;
use crate::fur::patch::face::{Face, singular_values};
use crate::fur::patch::measure::{Edge, borders};
use crate::math::{DVec2, IVec2, Vec2, Vec3};
use rayon::prelude::*;
use std::collections::VecDeque;

/// How far a shift may be from a whole number of tiles to be welded, in tiles, pass after pass: each pass sees what the
/// ones before have moved.
const NEAR: [f64; 4] = [0.23, 0.36, 0.45, 0.55];
/// Length ℓ over which displacements fade, in tiles.
const FADE: f64 = 1.7;
/// … and at most so many mean edges: the steps that a solution takes grow with them.
const FADE_EDGES: f64 = 8.0;
/// Bounds of cotangent weights, as the comb's.
const WEIGHTS: [f64; 2] = [0.05, 20.0];
/// Passes at most, those that only give up counted.
const ROUNDS: usize = 14;
/// Around a triangle beyond the limits, welds this near are given up, in tiles; more in each round.
const GIVE_UP: f64 = 0.3;
/// What triangles must keep to: growth's limits.
const LIMITS: Limits = Limits { least: 0.65, most: 1.5, angle_rad: 0.8 };
/// What triangles much smaller than a tile must keep to: where welds end, displacements change fast over a small place that
/// nobody sees.
const TINY: Limits = Limits { least: 0.5, most: 2.0, angle_rad: 1.0 };
/// Triangles of less than the square of this are small, in tiles.
const SMALL: f64 = 0.15;
/// How closely systems are solved, in tiles. Each pass begins where the one before ended.
const CLOSE: f64 = 0.02;
/// One triangle in this many may end beyond the limits.
const FEW: usize = 5000;
/// Times at most that triangles which are turned over in the end are laid back.
const LAID_BACK: usize = 64;
/// Steps of conjugate gradients at most.
const MOST_STEPS: usize = 500;
/// Systems smaller than this are not worth several threads.
const PARALLEL: usize = 8_000;

/// Welds what can be welded.
pub(super) fn stitch(surface: &Surface, tile_edge_m: f64, patches: &mut Patches) {
    let Surface { faces, topology, comb, .. } = surface;
    let flat =
        |patches: &Patches, t: usize| patches.triangles[t].map(|v| patches.uv[v as usize].as_dvec2() * tile_edge_m);
    let limits =
        |t: usize| if faces[t].area_m2 < (SMALL * tile_edge_m) * (SMALL * tile_edge_m) { TINY } else { LIMITS };
    let beyond = |patches: &Patches, t: usize| beyond(&faces[t], comb[t], flat(patches, t), limits(t));
    let mut open: Vec<Edge> = borders(topology, patches).collect();
    if open.is_empty() {
        return;
    }
    let before = patches.uv.clone();
    let bent: Vec<bool> = (0..faces.len()).map(|t| beyond(patches, t)).collect();
    let bad = |patches: &Patches| (0..faces.len()).filter(|&t| !bent[t] && beyond(patches, t)).collect::<Vec<_>>();
    let turned_over =
        |patches: &Patches, t: usize| faces[t].jacobian(flat(patches, t)).is_some_and(|[x, y]| x.perp_dot(y) <= 0.0);
    let skin = StitchedSkin { laplacian: Laplacian::new(faces, fade_m(faces, tile_edge_m), patches), before: &before };
    let mut held: Vec<Weld> = Vec::new();
    for round in 0..ROUNDS {
        let near = NEAR.get(round).copied().unwrap_or(0.0);
        let mut tried: Vec<Weld> = open.iter().filter_map(|edge| Weld::near(patches, edge, near)).collect();
        tried.sort_by(|a, b| a.off.total_cmp(&b.off).then(a.edge.edges.cmp(&b.edge.edges)));
        open.retain(|edge| Weld::near(patches, edge, near).is_none());
        held.append(&mut tried);
        skin.spread(held.iter(), patches);
        let left = bad(patches);
        let turned = left.iter().any(|&t| turned_over(patches, t));
        if turned || left.len() > faces.len() / FEW || near > 0.0 && !left.is_empty() {
            let reach = GIVE_UP * (1 + round.saturating_sub(NEAR.len())) as f64;
            give_up(surface, left, tile_edge_m * reach, &mut held);
        } else if near == 0.0 {
            break;
        }
    }
    // What no weld gave way for is laid back corner by corner; a short seam may open there.
    for _ in 0..LAID_BACK {
        let turned: Vec<usize> = (0..faces.len()).filter(|&t| !bent[t] && turned_over(patches, t)).collect();
        for &t in &turned {
            let corners = patches.triangles[t].map(|v| v as usize);
            let moved = corners.iter().map(|&v| patches.uv[v] - before[v]).sum::<Vec2>() / 3.0;
            corners.iter().for_each(|&v| patches.uv[v] = before[v] + moved);
        }
        if turned.is_empty() {
            return;
        }
    }
    patches.uv = before;
}

/// An edge over which the texture is to go on.
#[derive(Clone, Copy, Debug)]
struct Weld {
    edge: Edge,
    /// Tiles from the second side to the first.
    whole: IVec2,
    /// How far the sides were from that, in tiles.
    off: f64,
}

impl Weld {
    /// The weld of an edge whose sides are at most `near` from whole tiles apart.
    fn near(patches: &Patches, edge: &Edge, near: f64) -> Option<Self> {
        let shift = |k: usize| (patches.uv[edge.ends[0][k]] - patches.uv[edge.ends[1][k]]).as_dvec2();
        let whole = (0.5 * (shift(0) + shift(1))).round();
        let off = (0..2).map(|k| (shift(k) - whole).length()).fold(0.0, f64::max);
        (off <= near).then_some(Self { edge: *edge, whole: whole.as_ivec2(), off })
    }
}

fn beyond(face: &Face, comb: DVec2, flat: [DVec2; 3], limits: Limits) -> bool {
    let Some(jacobian) = face.jacobian(flat) else { return false };
    let [large, small] = singular_values(jacobian);
    let seen = jacobian[0] * comb.x + jacobian[1] * comb.y;
    let turned = comb != DVec2::ZERO && libm::atan2(seen.y, seen.x).abs() > limits.angle_rad;
    !(small >= limits.least && large <= limits.most) || turned || jacobian[0].perp_dot(jacobian[1]) < 0.0
}

/// Drops the welds within `reach_m` of the bad triangles, and those on them and their neighbours.
fn give_up(surface: &Surface, bad: Vec<usize>, reach_m: f64, welds: &mut Vec<Weld>) {
    let middle = |t: usize| surface.mesh.corners_m(t).iter().sum::<Vec3>() / 3.0;
    let mut near = vec![false; surface.faces.len()];
    // Each triangle with the bad one that it was reached from.
    let mut waiting: VecDeque<(usize, usize)> = bad.iter().map(|&t| (t, t)).collect();
    bad.iter().for_each(|&t| near[t] = true);
    while let Some((t, from)) = waiting.pop_front() {
        for n in (0..3).filter_map(|k| surface.topology.neighbour(t, k)) {
            let close = t == from || f64::from(middle(n).distance(middle(from))) <= reach_m;
            if close && !std::mem::replace(&mut near[n], true) {
                waiting.push_back((n, from));
            }
        }
    }
    welds.retain(|weld| !weld.edge.edges.iter().any(|&e| near[e / 3]));
}

/// Coat vertices that move as one, whole tiles apart.
struct Groups {
    parent: Vec<u32>,
    /// Tiles from the parent.
    shift: Vec<IVec2>,
}

impl Groups {
    fn new(count: usize) -> Self {
        Self { parent: (0..count as u32).collect(), shift: vec![IVec2::ZERO; count] }
    }

    /// The vertex that `v` moves with, and how many tiles `v` is from it.
    fn root(&mut self, v: usize) -> (usize, IVec2) {
        let (mut at, mut shift) = (v, IVec2::ZERO);
        while self.parent[at] as usize != at {
            shift += self.shift[at];
            at = self.parent[at] as usize;
        }
        self.parent[v] = at as u32;
        self.shift[v] = shift;
        (at, shift)
    }

    /// Holds `a` at `whole` tiles from `b`; a pair that already moves as one stays as it is.
    fn weld(&mut self, a: usize, b: usize, whole: IVec2) {
        let ((root_a, shift_a), (root_b, shift_b)) = (self.root(a), self.root(b));
        if root_a != root_b {
            self.parent[root_a] = root_b as u32;
            self.shift[root_a] = whole + shift_b - shift_a;
        }
    }

    /// A number for each vertex' group, its tiles from the group's place, and how many groups there are.
    fn numbered(mut self) -> (Vec<u32>, Vec<IVec2>, usize) {
        let mut number = vec![u32::MAX; self.parent.len()];
        let (mut unknown, mut shifts) = (Vec::with_capacity(number.len()), Vec::with_capacity(number.len()));
        let mut count = 0;
        for v in 0..number.len() {
            let (root, shift) = self.root(v);
            if number[root] == u32::MAX {
                number[root] = count;
                count += 1;
            }
            unknown.push(number[root]);
            shifts.push(shift);
        }
        (unknown, shifts, count as usize)
    }
}

/// What is moved.
struct StitchedSkin<'a> {
    laplacian: Laplacian,
    /// Coordinates before anything was welded.
    before: &'a [Vec2],
}

impl StitchedSkin<'_> {
    /// Moves all vertices so that welds hold and the displacement is as smooth as can be, starting from where they are.
    fn spread<'w>(&self, welded: impl Iterator<Item = &'w Weld>, patches: &mut Patches) {
        let count = patches.uv.len();
        let mut groups = Groups::new(count);
        for weld in welded {
            for k in 0..2 {
                groups.weld(weld.edge.ends[0][k], weld.edge.ends[1][k], weld.whole);
            }
        }
        let (group, shifts, number) = groups.numbered();
        let mut sums = vec![(DVec2::ZERO, 0.0); number];
        for v in 0..count {
            let sum = &mut sums[group[v] as usize];
            sum.0 += patches.uv[v].as_dvec2() - shifts[v].as_dvec2();
            sum.1 += 1.0;
        }
        let start: Vec<DVec2> = sums.iter().map(|(sum, n)| *sum / *n).collect();
        let moved = |v: usize| self.before[v].as_dvec2() - start[group[v] as usize] - shifts[v].as_dvec2();
        let moved: Vec<DVec2> = (0..count).map(moved).collect();
        let further = Welded { laplacian: &self.laplacian, group: &group, number }.solve(&moved);
        for v in 0..count {
            let at = start[group[v] as usize] + further[group[v] as usize];
            // Whole tiles are added to rounded numbers, so that welded vertices differ by nothing else.
            patches.uv[v] = at.as_vec2() + shifts[v].as_vec2();
        }
    }
}

/// Length over which displacements fade, m.
fn fade_m(faces: &[Face], tile_edge_m: f64) -> f64 {
    let area_m2: f64 = faces.iter().map(|f| f.area_m2).sum();
    let edge_m = (2.0 * area_m2 / faces.len().max(1) as f64).sqrt();
    (FADE * tile_edge_m).min(FADE_EDGES * edge_m).max(1e-30)
}

/// Weight of each edge of a triangle (k to k + 1), and of each of its corners.
fn stiffness(face: &Face, fade_m: f64) -> ([f64; 3], f64) {
    let corners = face.corners_m();
    let weight = |k: usize| {
        let far = corners[(k + 2) % 3];
        let (a, b) = (corners[k] - far, corners[(k + 1) % 3] - far);
        let double_area = a.perp_dot(b);
        let cotangent = if double_area > 0.0 { a.dot(b) / double_area } else { 0.0 };
        0.5 * cotangent.clamp(WEIGHTS[0], WEIGHTS[1])
    };
    ([0, 1, 2].map(weight), face.area_m2 / (3.0 * fade_m * fade_m))
}

/// The screened Laplacian over coat vertices, row by row.
struct Laplacian {
    diagonal: Vec<f64>,
    /// Square of the residual at which vertices are [`CLOSE`] to where they should be: against the screen alone, which
    /// holds the widest displacements.
    enough: f64,
    /// Where each row's entries begin.
    rows: Vec<u32>,
    /// Column and weight. What is solved is as smooth with rounded weights, and twice as fast.
    entries: Vec<(u32, f32)>,
}

impl Laplacian {
    fn new(faces: &[Face], fade_m: f64, patches: &Patches) -> Self {
        let count = patches.uv.len();
        let mut rows = vec![0_u32; count + 1];
        patches.triangles.iter().flatten().for_each(|&v| rows[v as usize + 1] += 2);
        for i in 0..count {
            rows[i + 1] += rows[i];
        }
        let mut diagonal = vec![f64::MIN_POSITIVE; count];
        let mut screen = vec![0.0; count];
        let mut next = rows.clone();
        let mut doubled = vec![(0, 0.0_f32); rows[count] as usize];
        for (face, triangle) in faces.iter().zip(&patches.triangles) {
            let (weights, mass) = stiffness(face, fade_m);
            for (k, &weight) in weights.iter().enumerate() {
                let [i, j] = [triangle[k], triangle[(k + 1) % 3]];
                let weight = weight as f32;
                diagonal[i as usize] += f64::from(weight) + mass;
                screen[i as usize] += mass;
                diagonal[j as usize] += f64::from(weight);
                for (from, to) in [(i as usize, j), (j as usize, i)] {
                    doubled[next[from] as usize] = (to, weight);
                    next[from] += 1;
                }
            }
        }
        // An edge has come from both of its triangles: one entry each.
        let mut entries: Vec<(u32, f32)> = Vec::with_capacity(doubled.len() / 2 + count);
        let mut merged = vec![0_u32; count + 1];
        for i in 0..count {
            let row = &mut doubled[rows[i] as usize..rows[i + 1] as usize];
            row.sort_unstable_by_key(|entry| entry.0);
            for &(column, weight) in row.iter() {
                match entries[merged[i] as usize..].last_mut() {
                    Some(last) if last.0 == column => last.1 += weight,
                    _ => entries.push((column, weight)),
                }
            }
            merged[i + 1] = entries.len() as u32;
        }
        let enough = screen.iter().zip(&diagonal).map(|(s, d)| (CLOSE * s) * (CLOSE * s) / d).sum();
        Self { diagonal, enough, rows: merged, entries }
    }

    /// The matrix times `x`; rows stand for themselves, so that threads do not matter.
    fn times(&self, x: &[DVec2], y: &mut [DVec2]) {
        let row = |(i, y): (usize, &mut DVec2)| {
            let row = &self.entries[self.rows[i] as usize..self.rows[i + 1] as usize];
            *y = row.iter().fold(x[i] * self.diagonal[i], |sum, &(j, weight)| sum - x[j as usize] * f64::from(weight));
        };
        if x.len() < PARALLEL {
            y.iter_mut().enumerate().for_each(row);
        } else {
            y.par_iter_mut().enumerate().with_min_len(4096).for_each(row);
        }
    }
}

/// The Laplacian where vertices move in groups.
struct Welded<'a> {
    laplacian: &'a Laplacian,
    /// Group of each vertex, and how many there are.
    group: &'a [u32],
    number: usize,
}

impl Welded<'_> {
    /// Sums over each group.
    fn gather(&self, of_vertices: &[DVec2], of_groups: &mut [DVec2]) {
        of_groups.fill(DVec2::ZERO);
        for (&g, &value) in self.group.iter().zip(of_vertices) {
            of_groups[g as usize] += value;
        }
    }

    /// What each group is to be moved by so that, of all ways, the vertices end nearest to a displacement of `wanted` in the
    /// Laplacian's sense: conjugate gradients with the diagonal as preconditioner, u and v side by side.
    fn solve(&self, wanted: &[DVec2]) -> Vec<DVec2> {
        let dot = |a: &[DVec2], b: &[DVec2]| a.iter().zip(b).fold(DVec2::ZERO, |sum, (a, b)| sum + *a * *b);
        let safe = |a: DVec2, b: DVec2| {
            DVec2::new(if b.x > 0.0 { a.x / b.x } else { 0.0 }, if b.y > 0.0 { a.y / b.y } else { 0.0 })
        };
        let zeros = vec![DVec2::ZERO; self.number];
        let mut diagonal = vec![0.0; self.number];
        for (&g, d) in self.group.iter().zip(&self.laplacian.diagonal) {
            diagonal[g as usize] += d;
        }
        let (mut vertices, mut images) = (wanted.to_vec(), wanted.to_vec());
        self.laplacian.times(&vertices, &mut images);
        let (mut x, mut residual, mut image) = (zeros.clone(), zeros.clone(), zeros);
        self.gather(&images, &mut residual);
        let mut scaled: Vec<DVec2> = residual.iter().zip(&diagonal).map(|(r, d)| *r / *d).collect();
        let mut direction = scaled.clone();
        let mut size = dot(&residual, &scaled);
        for _ in 0..MOST_STEPS {
            if size.max_element() <= self.laplacian.enough {
                break;
            }
            vertices.iter_mut().zip(self.group).for_each(|(v, &g)| *v = direction[g as usize]);
            self.laplacian.times(&vertices, &mut images);
            self.gather(&images, &mut image);
            let step = safe(size, dot(&direction, &image));
            for i in 0..x.len() {
                x[i] += direction[i] * step;
                residual[i] -= image[i] * step;
                scaled[i] = residual[i] / diagonal[i];
            }
            let new = dot(&residual, &scaled);
            let keep = safe(new, size);
            size = new;
            for (d, s) in direction.iter_mut().zip(&scaled) {
                *d = *s + *d * keep;
            }
        }
        x
    }
}
