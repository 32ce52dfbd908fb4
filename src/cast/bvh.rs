//! A bounding volume hierarchy over boxes: binned surface-area heuristic (Wald 2007), depth-first nodes.

use crate::math::Vec3;

const LEAF_SIZE: usize = 4;
const BINS: usize = 12;

/// A node: a leaf where `count > 0`, whose items are `first … first + count`; else its children are the next node and
/// the one `first` nodes further on.
#[derive(Clone, Copy, Debug)]
struct Node {
    low: Vec3,
    first: u32,
    high: Vec3,
    count: u32,
}

/// The hierarchy. Items are referred to by their index at construction.
#[derive(Clone, Debug, Default)]
pub struct Bvh {
    nodes: Vec<Node>,
    items: Vec<u32>,
}

/// Items from which on halves are built side by side.
const PARALLEL: usize = 8192;

impl Bvh {
    /// Builds over boxes (lowest, highest corner).
    pub fn new(bounds: &[(Vec3, Vec3)]) -> Self {
        let mut items: Vec<u32> = (0..bounds.len() as u32).collect();
        let nodes = if items.is_empty() { Vec::new() } else { split(bounds, &mut items, 0) };
        Self { nodes, items }
    }

    /// Lowest and highest corner of all items; none when there is no item.
    pub fn bounds(&self) -> Option<(Vec3, Vec3)> {
        self.nodes.first().map(|n| (n.low, n.high))
    }

    /// The items in the order of the leaves; from now on items are referred to by their place in it.
    pub fn take_order(&mut self) -> Vec<u32> {
        let places = (0..self.items.len() as u32).collect();
        std::mem::replace(&mut self.items, places)
    }

    /// Calls `visit(item, far)` for every item whose box meets the ray between `near` and the returned `far`, which
    /// `visit` may shorten. Nearer boxes come first, roughly.
    pub fn traverse(
        &self,
        origin: Vec3,
        direction: Vec3,
        near: f32,
        mut far: f32,
        mut visit: impl FnMut(u32, f32) -> f32,
    ) {
        if self.nodes.is_empty() {
            return;
        }
        let inverse = direction.recip();
        let meets = |node: &Node, far: f32| {
            let (a, b) = ((node.low - origin) * inverse, (node.high - origin) * inverse);
            // min/max drop the NaN of 0 · ∞: a ray inside a slab's plane stays possible.
            let enter = a.min(b).max_element().max(near);
            let leave = a.max(b).min_element().min(far);
            (enter <= leave).then_some(enter)
        };
        let mut stack = [0_u32; 64];
        let mut depth = 0;
        let mut index = 0_usize;
        if meets(&self.nodes[0], far).is_none() {
            return;
        }
        loop {
            let node = &self.nodes[index];
            if node.count > 0 {
                for &item in &self.items[node.first as usize..(node.first + node.count) as usize] {
                    far = visit(item, far);
                }
            } else {
                let (left, right) = (index + 1, index + node.first as usize);
                match (meets(&self.nodes[left], far), meets(&self.nodes[right], far)) {
                    (Some(l), Some(r)) => {
                        let (next, later) = if l <= r { (left, right) } else { (right, left) };
                        stack[depth] = later as u32;
                        depth += 1;
                        index = next;
                        continue;
                    }
                    (Some(_), None) => {
                        index = left;
                        continue;
                    }
                    (None, Some(_)) => {
                        index = right;
                        continue;
                    }
                    (None, None) => {}
                }
            }
            // Boxes put aside may lie past a `far` that has come nearer since.
            loop {
                if depth == 0 {
                    return;
                }
                depth -= 1;
                index = stack[depth] as usize;
                if meets(&self.nodes[index], far).is_some() {
                    break;
                }
            }
        }
    }
}

/// The nodes over `items`, the first of which is item `begin` of all.
fn split(bounds: &[(Vec3, Vec3)], items: &mut [u32], begin: usize) -> Vec<Node> {
    let mut low = Vec3::INFINITY;
    let mut high = Vec3::NEG_INFINITY;
    let mut centre_low = Vec3::INFINITY;
    let mut centre_high = Vec3::NEG_INFINITY;
    for &i in items.iter() {
        let (l, h) = bounds[i as usize];
        low = low.min(l);
        high = high.max(h);
        centre_low = centre_low.min(l + h);
        centre_high = centre_high.max(l + h);
    }
    let leaf = Node { low, first: begin as u32, high, count: items.len() as u32 };
    if items.len() <= LEAF_SIZE {
        return vec![leaf];
    }
    let extent = centre_high - centre_low;
    let axis = if extent.x >= extent.y && extent.x >= extent.z {
        0
    } else if extent.y >= extent.z {
        1
    } else {
        2
    };
    let middle = partition(bounds, items, axis, centre_low[axis], extent[axis]);
    let wide = items.len() >= PARALLEL;
    let (left_items, right_items) = items.split_at_mut(middle);
    let left = |items: &mut [u32]| split(bounds, items, begin);
    let right = |items: &mut [u32]| split(bounds, items, begin + middle);
    let (left, right) = if wide {
        rayon::join(|| left(left_items), || right(right_items))
    } else {
        (left(left_items), right(right_items))
    };
    let mut nodes = Vec::with_capacity(1 + left.len() + right.len());
    nodes.push(Node { first: 1 + left.len() as u32, count: 0, ..leaf });
    nodes.extend(left);
    nodes.extend(right);
    nodes
}

/// Reorders the items and returns where the second half begins.
fn partition(bounds: &[(Vec3, Vec3)], items: &mut [u32], axis: usize, low: f32, extent: f32) -> usize {
    let centre = |i: u32| bounds[i as usize].0[axis] + bounds[i as usize].1[axis];
    let bin = |i: u32| (((centre(i) - low) / extent * BINS as f32) as usize).min(BINS - 1);
    if extent > 0.0 {
        let mut boxes = [(Vec3::INFINITY, Vec3::NEG_INFINITY, 0_usize); BINS];
        for &i in items.iter() {
            let entry = &mut boxes[bin(i)];
            let (l, h) = bounds[i as usize];
            *entry = (entry.0.min(l), entry.1.max(h), entry.2 + 1);
        }
        let sweep = |order: &mut dyn Iterator<Item = usize>| {
            let mut all = (Vec3::INFINITY, Vec3::NEG_INFINITY, 0);
            let mut cost = [0.0_f32; BINS];
            for b in order {
                all = (all.0.min(boxes[b].0), all.1.max(boxes[b].1), all.2 + boxes[b].2);
                let d = (all.1 - all.0).max(Vec3::ZERO);
                cost[b] = (d.x * d.y + d.y * d.z + d.z * d.x) * all.2 as f32;
            }
            cost
        };
        let left = sweep(&mut (0..BINS));
        let right = sweep(&mut (0..BINS).rev());
        let best = (0..BINS - 1).min_by(|&x, &y| (left[x] + right[x + 1]).total_cmp(&(left[y] + right[y + 1])));
        let last_left = best.unwrap_or(0);
        let mut middle = 0;
        for k in 0..items.len() {
            if bin(items[k]) <= last_left {
                items.swap(k, middle);
                middle += 1;
            }
        }
        // A lopsided split could grow deeper than the traversal stack: keep at least an eighth on each side.
        if middle.min(items.len() - middle) * 8 >= items.len() {
            return middle;
        }
    }
    let half = items.len() / 2;
    items.select_nth_unstable_by(half, |&x, &y| centre(x).total_cmp(&centre(y)).then(x.cmp(&y)));
    half
}
