//! Where the mean shadow's columns stand: over the skin's vertices, and over points between them where triangles are wide for
//! their hair.

use crate::math::Vec3;
use crate::volume::shell::Shell;
use crate::volume::shell::lattice;
use std::collections::HashMap;

/// No triangle is split more often.
const MOST_SPLITS: u32 = 3;

/// Most columns between vertices, of which a mesh of many may have some for each.
const MOST_BETWEEN: usize = 1 << 18;
const MOST_PER_VERTEX: usize = 3;

/// Columns by number: those over position classes first, then those between vertices.
#[derive(Debug)]
pub(super) struct MeanColumns {
    /// Where each triangle's begin in `numbers`, and how often it is split.
    lattices: Vec<(u32, u32)>,
    /// Columns over the corners of triangles' lattices, in the order of [`lattice::points`].
    numbers: Vec<u32>,
    /// Those over vertices.
    vertices: usize,
    /// Where the others stand.
    between: Vec<(u32, Vec3)>,
}

/// An edge of split triangles.
struct Edge {
    /// The most that a triangle beside it is split.
    splits: u32,
    /// The triangle beside it that lies first in space, and which of its corners are the edge's, that of the lower class first.
    triangle: u32,
    ends: [usize; 2],
    /// Its first column, once it has any.
    first: Option<u32>,
}

impl MeanColumns {
    /// No farther apart than `span_m`, if so many can be kept.
    pub(super) fn new(shell: &Shell<'_>, span_m: f32) -> Self {
        let triangles = shell.skin.triangles.len();
        let splits = |span_m: f32| -> Vec<u32> {
            let of = |t| ((shell.skin.mean_edge_m(t) / span_m).log2().ceil().max(0.0) as u32).min(MOST_SPLITS);
            (0..triangles).map(of).collect()
        };
        // A closed mesh has half as many vertices as triangles (Euler), and so has its lattice.
        let count = |splits: &[u32]| splits.iter().map(|&d| (1 << (2 * d)) - 1).sum::<usize>() / 2;
        let most = MOST_BETWEEN.max(MOST_PER_VERTEX * shell.skin.positions_m.len());
        let mut span_m = span_m;
        let mut chosen = splits(span_m);
        while count(&chosen) > most {
            span_m *= 2.0;
            chosen = splits(span_m);
        }
        let mut columns = Self {
            lattices: Vec::with_capacity(triangles),
            numbers: Vec::new(),
            vertices: shell.skin.positions_m.len(),
            between: Vec::new(),
        };
        let mut edges = edges(shell, &chosen);
        for (t, d) in (0..triangles as u32).zip(chosen) {
            columns.lattices.push((columns.numbers.len() as u32, d));
            columns.split(shell, &mut edges, t, d);
        }
        columns
    }

    /// Adds the numbers of a triangle's lattice.
    fn split(&mut self, shell: &Shell<'_>, edges: &mut HashMap<[u32; 2], Edge>, t: u32, d: u32) {
        let classes = classes(shell, t);
        let n = 1_u32 << d;
        for b in lattice::points(d) {
            let steps = b.to_array().map(|part| (part * n as f32) as u32);
            let number = if let Some(corner) = steps.iter().position(|&steps| steps == n) {
                classes[corner]
            } else if let Some(opposite) = steps.iter().position(|&steps| steps == 0) {
                let ends = ends(&classes, opposite);
                let edge = edges.get_mut(&ends.map(|end| classes[end])).expect("a split triangle's edge");
                let first = *edge.first.get_or_insert_with(|| {
                    let first = (self.vertices + self.between.len()) as u32;
                    let parts = 1_u32 << edge.splits;
                    let at = |i: u32| {
                        let share = i as f32 / parts as f32;
                        Vec3::AXES[edge.ends[0]] * (1.0 - share) + Vec3::AXES[edge.ends[1]] * share
                    };
                    self.between.extend((1..parts).map(|i| (edge.triangle, at(i))));
                    first
                });
                first + (steps[ends[1]] << (edge.splits - d)) - 1
            } else {
                self.between.push((t, b));
                (self.vertices + self.between.len()) as u32 - 1
            };
            self.numbers.push(number);
        }
    }

    /// How many there are.
    pub(super) fn count(&self) -> usize {
        self.vertices + self.between.len()
    }

    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.lattices[..]) + size_of_val(&self.numbers[..]) + size_of_val(&self.between[..])
    }

    /// Where one that is over no vertex stands.
    pub(super) fn between(&self, number: u32) -> Option<(u32, Vec3)> {
        (number as usize).checked_sub(self.vertices).map(|i| self.between[i])
    }

    /// Where a triangle's begin in [`Self::numbers`], and how often it is split.
    pub(super) fn lattice(&self, triangle: u32) -> (u32, u32) {
        self.lattices[triangle as usize]
    }

    /// By triangle and corner of its lattice.
    pub(super) fn numbers(&self) -> &[u32] {
        &self.numbers
    }

    /// The three around a point of the skin, and their weights.
    pub(super) fn around(&self, triangle: u32, b: Vec3) -> ([u32; 3], Vec3) {
        let (first, d) = self.lattices[triangle as usize];
        let numbers = &self.numbers[first as usize..];
        if d == 0 {
            return ([numbers[0], numbers[1], numbers[2]], b);
        }
        let (corners, weights) = lattice::around(d, b);
        (corners.map(|corner| numbers[corner as usize]), weights)
    }
}

fn classes(shell: &Shell<'_>, t: u32) -> [u32; 3] {
    shell.skin.triangles[t as usize].map(|v| shell.skin.position_class[v as usize])
}

/// The ends of the edge opposite to a corner, that of the lower class first.
fn ends(classes: &[u32; 3], opposite: usize) -> [usize; 2] {
    let [a, b] = [(opposite + 1) % 3, (opposite + 2) % 3];
    if classes[a] <= classes[b] { [a, b] } else { [b, a] }
}

/// Edges of split triangles, by the classes of their ends.
fn edges(shell: &Shell<'_>, splits: &[u32]) -> HashMap<[u32; 2], Edge> {
    let order = |t: u32| shell.skin.order_in_space(t as usize);
    let mut edges: HashMap<[u32; 2], Edge> = HashMap::new();
    for (t, &splits) in (0_u32..).zip(splits).filter(|(_, splits)| **splits > 0) {
        let classes = classes(shell, t);
        for opposite in 0..3 {
            let ends = ends(&classes, opposite);
            let edge =
                edges.entry(ends.map(|end| classes[end])).or_insert(Edge { splits, triangle: t, ends, first: None });
            edge.splits = edge.splits.max(splits);
            if order(t) < order(edge.triangle) {
                (edge.triangle, edge.ends) = (t, ends);
            }
        }
    }
    edges
}
