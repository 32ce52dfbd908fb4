//! Boxes around pieces of hair, by which rays find the segments that they may meet.
//!
//! A slanted segment fills little of its box, so it is put into several, each around a piece of it. Boxes are f32 and somewhat too
//! large; what lies in them is met in f64.

use crate::math::Vec3A;
use crate::reference::bvh::{Bounds, DRay};
use crate::reference::guard::GuardCones;
use rayon::prelude::*;

/// Pieces of a leaf at most.
const LEAF: usize = 3;
/// Pieces from which on halves are built side by side.
const PARALLEL: usize = 8192;
/// Diameters that a piece is long, about.
const LONG: f64 = 6.0;
/// Pieces of a segment at most.
const MOST_OF_SEGMENT: usize = 8;
/// Pieces in all, about, at most: 500 MB while they are sorted, 200 MB from then on.
const MOST: usize = 1 << 23;
/// What rounding may move a point, over the size of the scene.
const ROUNDING: f64 = 2e-6;

#[derive(Clone, Copy, Debug)]
struct Node {
    low_m: [f32; 3],
    /// Of a leaf: its first item. Else the distance to the second child; the first is the next node.
    first: u32,
    high_m: [f32; 3],
    /// Items of a leaf, else 0.
    count: u32,
}

impl Node {
    fn enter(&self, origin: Vec3A, inverse: Vec3A, far: f32) -> f32 {
        let a = (Vec3A::from_array(self.low_m) - origin) * inverse;
        let b = (Vec3A::from_array(self.high_m) - origin) * inverse;
        let enter = a.min(b).max_element().max(0.0);
        let leave = a.max(b).min_element().min(far);
        if enter <= leave { enter } else { f32::INFINITY }
    }
}

/// A piece while it is sorted.
#[derive(Clone, Copy)]
struct Piece {
    low_m: Vec3A,
    high_m: Vec3A,
    segment: u32,
}

/// The boxes.
#[derive(Debug)]
pub struct Tree {
    nodes: Vec<Node>,
    /// Of each piece its segment, counted over all hairs.
    items: Vec<u32>,
    segments: u32,
    bounds: Bounds,
    rounding_m: f64,
}

impl Tree {
    /// Around hairs.
    pub fn new(cones: &GuardCones<'_>) -> Self {
        let segments = cones.segments();
        let count = cones.strands().len() * segments as usize;
        let most = (MOST / count.max(1)).clamp(1, MOST_OF_SEGMENT);
        let of = |item: u32| {
            let ([from_m, to_m], radius_m) = cones.ends(item / segments, item % segments);
            let widest_m = radius_m[0].max(radius_m[1]);
            let parts = (from_m.distance(to_m) / (2.0 * LONG * widest_m)).ceil().clamp(1.0, most as f64);
            (0..parts as usize).map(move |part| {
                let ends = [0, 1].map(|i| from_m.lerp(to_m, (part + i) as f64 / parts));
                (Bounds::of(ends, widest_m), item)
            })
        };
        let bounds = (0..count as u32)
            .into_par_iter()
            .flat_map_iter(of)
            .map(|(bounds, _)| bounds)
            .reduce(|| Bounds::NOTHING, |a, b| Bounds { low: a.low.min(b.low), high: a.high.max(b.high) });
        let rounding_m = ROUNDING * bounds.low.abs().max(bounds.high.abs()).max_element().max(0.0);
        let mut pieces: Vec<Piece> = (0..count as u32)
            .into_par_iter()
            .flat_map_iter(of)
            .map(|(bounds, segment)| Piece {
                low_m: (bounds.low - rounding_m).as_vec3a(),
                high_m: (bounds.high + rounding_m).as_vec3a(),
                segment,
            })
            .collect();
        let nothing = Node { low_m: [0.0; 3], first: 0, high_m: [0.0; 3], count: 0 };
        let mut nodes = vec![nothing; nodes_over(pieces.len())];
        if !pieces.is_empty() {
            halve(&mut pieces, 0, &mut nodes);
        }
        Self { nodes, items: pieces.iter().map(|piece| piece.segment).collect(), segments, bounds, rounding_m }
    }

    /// Calls `visit` with hair and segment of every piece whose box a ray meets before `far_m`, the nearer boxes first; `visit`
    /// returns how far to go on.
    pub fn visit(&self, ray: &DRay, far_m: f64, mut visit: impl FnMut(u32, u32, f64) -> f64) {
        let Some([begin_m, _]) = self.bounds.span(ray, 0.0, far_m) else { return };
        // From where all is small.
        let origin = (ray.origin_m + ray.direction * begin_m).as_vec3a();
        let inverse = ray.direction.map(|d: f64| 1.0 / d.abs().max(1e-12).copysign(d)).as_vec3a();
        let reach = |far_m: f64| (far_m - begin_m + 4.0 * self.rounding_m) as f32;
        let mut far_m = far_m;
        let mut stack = [(0_u32, 0.0_f32); 64];
        let mut depth = usize::from(!self.nodes.is_empty());
        while depth > 0 {
            depth -= 1;
            let (index, enter) = stack[depth];
            let far = reach(far_m);
            if enter > far {
                continue;
            }
            let index = index as usize;
            let node = &self.nodes[index];
            if node.count > 0 {
                for &item in &self.items[node.first as usize..(node.first + node.count) as usize] {
                    far_m = visit(item / self.segments, item % self.segments, far_m);
                }
                continue;
            }
            let children = [index + 1, index + node.first as usize]
                .map(|child| (child as u32, self.nodes[child].enter(origin, inverse, far)));
            let nearer = usize::from(children[1].1 < children[0].1);
            for child in [children[1 - nearer], children[nearer]] {
                if child.1 < f32::INFINITY {
                    stack[depth] = child;
                    depth += 1;
                }
            }
        }
    }
}

/// Nodes over so many pieces.
fn nodes_over(pieces: usize) -> usize {
    match pieces {
        0 => 0,
        1..=LEAF => 1,
        _ => 1 + nodes_over(pieces / 2) + nodes_over(pieces - pieces / 2),
    }
}

/// Fills the nodes over some pieces; gives their box.
fn halve(pieces: &mut [Piece], begin: usize, nodes: &mut [Node]) -> [Vec3A; 2] {
    let count = pieces.len();
    if count <= LEAF {
        let low = pieces.iter().fold(Vec3A::INFINITY, |low, piece| low.min(piece.low_m));
        let high = pieces.iter().fold(Vec3A::NEG_INFINITY, |high, piece| high.max(piece.high_m));
        nodes[0] = Node { low_m: low.to_array(), first: begin as u32, high_m: high.to_array(), count: count as u32 };
        return [low, high];
    }
    let middle = |piece: &Piece| piece.low_m + piece.high_m;
    let [low, high] = pieces.iter().fold([Vec3A::INFINITY, Vec3A::NEG_INFINITY], |[low, high], piece| {
        [low.min(middle(piece)), high.max(middle(piece))]
    });
    let extent = high - low;
    let axis = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b])).unwrap_or(0);
    let half = count / 2;
    let key = |piece: &Piece| middle(piece)[axis];
    pieces.select_nth_unstable_by(half, |a, b| key(a).total_cmp(&key(b)).then(a.segment.cmp(&b.segment)));
    let (left, right) = pieces.split_at_mut(half);
    let (node, below) = nodes.split_at_mut(1);
    let (left_nodes, right_nodes) = below.split_at_mut(nodes_over(half));
    node[0].first = 1 + left_nodes.len() as u32;
    let (left, right) = if count >= PARALLEL {
        rayon::join(|| halve(left, begin, left_nodes), || halve(right, begin + half, right_nodes))
    } else {
        (halve(left, begin, left_nodes), halve(right, begin + half, right_nodes))
    };
    let (low, high) = (left[0].min(right[0]), left[1].max(right[1]));
    (node[0].low_m, node[0].high_m) = (low.to_array(), high.to_array());
    [low, high]
}
