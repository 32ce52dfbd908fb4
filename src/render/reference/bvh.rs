//! A plain hierarchy of boxes in f64: halves by the middle item along the widest axis.

use crate::math::DVec3;

const LEAF: usize = 4;
/// Items from which on halves are built side by side.
const PARALLEL: usize = 4096;

/// A ray, with what its tests against boxes need.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Where it starts, m.
    pub origin_m: DVec3,
    /// Unit vector.
    pub direction: DVec3,
    inverse: DVec3,
}

impl Ray {
    /// From a point along a unit vector.
    pub fn new(origin_m: DVec3, direction: DVec3) -> Self {
        Self { origin_m, direction, inverse: direction.recip() }
    }

    /// The point `at_m` along it.
    pub fn at(&self, at_m: f64) -> DVec3 {
        self.origin_m + self.direction * at_m
    }
}

/// A box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Lowest corner, m.
    pub low: DVec3,
    /// Highest corner, m.
    pub high: DVec3,
}

impl Bounds {
    /// Holds nothing.
    pub const NOTHING: Self = Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };

    /// Of points, with `pad_m` around.
    pub fn of(points: impl IntoIterator<Item = DVec3>, pad_m: f64) -> Self {
        let tight = points.into_iter().fold(Self::NOTHING, |b, p| Self { low: b.low.min(p), high: b.high.max(p) });
        Self { low: tight.low - pad_m, high: tight.high + pad_m }
    }

    /// Where a ray is inside, between `near` and `far`; none where it is not.
    pub fn span(&self, ray: &Ray, near: f64, far: f64) -> Option<[f64; 2]> {
        let (a, b) = ((self.low - ray.origin_m) * ray.inverse, (self.high - ray.origin_m) * ray.inverse);
        // min and max drop the NaN of 0 · ∞: a ray inside a side's plane stays possible.
        let enter = a.min(b).max_element().max(near);
        let leave = a.max(b).min_element().min(far);
        (enter <= leave).then_some([enter, leave])
    }
}

#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Bounds,
    /// Of a leaf: its first item. Else the distance to the second child; the first is the next node.
    first: u32,
    /// Items of a leaf, else 0.
    count: u32,
}

/// The hierarchy.
#[derive(Debug, Default)]
pub struct Bvh {
    nodes: Vec<Node>,
    items: Vec<u32>,
}

impl Bvh {
    /// Over items with these boxes.
    pub fn new(bounds: &[Bounds]) -> Self {
        let mut items: Vec<u32> = (0..bounds.len() as u32).collect();
        let nodes = if items.is_empty() { Vec::new() } else { halve(bounds, &mut items, 0) };
        Self { nodes, items }
    }

    /// Calls `visit` for every item whose box a ray meets between `near` and `far`; `visit` returns a new `far`.
    pub fn visit(&self, ray: &Ray, near: f64, mut far: f64, mut visit: impl FnMut(u32, f64) -> f64) {
        let mut stack = [0_u32; 64];
        let mut depth = usize::from(!self.nodes.is_empty());
        while depth > 0 {
            depth -= 1;
            let index = stack[depth] as usize;
            let node = &self.nodes[index];
            if node.bounds.span(ray, near, far).is_none() {
                continue;
            }
            if node.count > 0 {
                for &item in &self.items[node.first as usize..(node.first + node.count) as usize] {
                    far = visit(item, far);
                }
            } else {
                stack[depth] = index as u32 + node.first;
                stack[depth + 1] = index as u32 + 1;
                depth += 2;
            }
        }
    }

    /// Where, from `near` on, a ray first meets the box of a leaf; infinite where it meets none.
    pub fn first(&self, ray: &Ray, near: f64) -> f64 {
        let enter = |index: usize, far: f64| {
            self.nodes[index].bounds.span(ray, near, far).map_or(f64::INFINITY, |[enter, _]| enter)
        };
        let mut nearest = f64::INFINITY;
        let mut stack = [(0, 0.0); 64];
        let mut depth = usize::from(!self.nodes.is_empty());
        if depth > 0 {
            stack[0] = (0, enter(0, f64::INFINITY));
        }
        while depth > 0 {
            depth -= 1;
            let (index, enter_m) = stack[depth];
            if enter_m >= nearest {
                continue;
            }
            let node = &self.nodes[index];
            if node.count > 0 {
                nearest = enter_m;
                continue;
            }
            let children = [index + 1, index + node.first as usize].map(|child| (child, enter(child, nearest)));
            // The nearer child goes first.
            let nearer = usize::from(children[1].1 < children[0].1);
            (stack[depth], stack[depth + 1]) = (children[1 - nearer], children[nearer]);
            depth += 2;
        }
        nearest
    }
}

fn halve(bounds: &[Bounds], items: &mut [u32], begin: usize) -> Vec<Node> {
    let all = items.iter().fold(Bounds::NOTHING, |all, &i| {
        let b = &bounds[i as usize];
        Bounds { low: all.low.min(b.low), high: all.high.max(b.high) }
    });
    if items.len() <= LEAF {
        return vec![Node { bounds: all, first: begin as u32, count: items.len() as u32 }];
    }
    let centre = |i: u32| bounds[i as usize].low + bounds[i as usize].high;
    let centres = Bounds::of(items.iter().map(|&i| centre(i)), 0.0);
    let extent = centres.high - centres.low;
    let axis = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b])).unwrap_or(0);
    let middle = items.len() / 2;
    items.select_nth_unstable_by(middle, |&a, &b| centre(a)[axis].total_cmp(&centre(b)[axis]).then(a.cmp(&b)));
    let side_by_side = items.len() >= PARALLEL;
    let (left, right) = items.split_at_mut(middle);
    let (left, right) = if side_by_side {
        rayon::join(|| halve(bounds, left, begin), || halve(bounds, right, begin + middle))
    } else {
        (halve(bounds, left, begin), halve(bounds, right, begin + middle))
    };
    let mut nodes = Vec::with_capacity(1 + left.len() + right.len());
    nodes.push(Node { bounds: all, first: 1 + left.len() as u32, count: 0 });
    nodes.extend(left);
    nodes.extend(right);
    nodes
}
