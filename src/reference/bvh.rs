//! A plain hierarchy of boxes in f64: halves by the middle item along the widest axis.

use crate::math::{DVec3, Vec3};

const LEAF: usize = 4;
/// Items from which on halves are built side by side.
const PARALLEL: usize = 4096;

/// A ray, with what its tests against boxes need.
#[derive(Clone, Copy, Debug)]
pub struct DRay {
    /// Where it starts, m.
    pub origin_m: DVec3,
    /// Unit vector.
    pub direction: DVec3,
    inverse: DVec3,
    /// Unit vectors across it.
    across: [DVec3; 2],
}

impl DRay {
    /// From a point along a unit vector.
    pub fn new(origin_m: DVec3, direction: DVec3) -> Self {
        Self { origin_m, direction, inverse: direction.recip(), across: direction.any_orthonormal_pair().into() }
    }

    /// A vector in its own axes: two across it, the third along it.
    pub fn see(&self, v: DVec3) -> DVec3 {
        DVec3::new(v.dot(self.across[0]), v.dot(self.across[1]), v.dot(self.direction))
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
    pub fn span(&self, ray: &DRay, near: f64, far: f64) -> Option<[f64; 2]> {
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

/// What lies between four planes through one eye.
#[derive(Clone, Copy, Debug)]
pub struct Beam {
    eye_m: DVec3,
    /// Inwards.
    normals: [DVec3; 4],
    /// Its middle direction.
    ahead: DVec3,
}

impl Beam {
    /// Between planes through four directions, each through two that follow one another, around the direction `ahead`.
    pub fn new(eye_m: DVec3, corners: [DVec3; 4], ahead: DVec3) -> Self {
        let middle: DVec3 = corners.into_iter().sum();
        let normals = [0, 1, 2, 3].map(|i| {
            let normal = corners[i].cross(corners[(i + 1) % 4]);
            if normal.dot(middle) < 0.0 { -normal } else { normal }
        });
        Self { eye_m, normals, ahead }
    }

    /// Whether it may meet a box.
    pub fn meets(&self, bounds: &Bounds) -> bool {
        let middle = 0.5 * (bounds.low + bounds.high) - self.eye_m;
        let half = 0.5 * (bounds.high - bounds.low);
        let reaches = |normal: &DVec3| normal.dot(middle) >= -normal.abs().dot(half);
        self.normals.iter().all(reaches) && reaches(&self.ahead)
    }
}

/// The hierarchy.
#[derive(Debug, Default)]
pub struct DBvh {
    nodes: Vec<Node>,
    items: Vec<u32>,
}

impl DBvh {
    /// Over items with these boxes.
    pub fn new(bounds: &[Bounds]) -> Self {
        let mut items: Vec<Item> = bounds
            .iter()
            .zip(0..)
            .map(|(b, index)| Item { middle: (0.5 * (b.low + b.high)).as_vec3(), index })
            .collect();
        let mut nodes = vec![Node { bounds: Bounds::NOTHING, first: 0, count: 0 }; nodes_over(items.len())];
        if !items.is_empty() {
            halve(bounds, &mut items, 0, &mut nodes);
        }
        Self { nodes, items: items.into_iter().map(|item| item.index).collect() }
    }

    /// Calls `visit` for every item whose box a ray meets between `near` and `far`; `visit` returns a new `far`.
    pub fn visit(&self, ray: &DRay, near: f64, far: f64, mut visit: impl FnMut(u32, f64) -> f64) {
        let meets = |bounds: &Bounds, far: f64| bounds.span(ray, near, far).is_some();
        self.descend(far, meets, |item, far| *far = visit(item, *far));
    }

    /// As [`Self::visit`], boxes that begin nearer first: what comes first along the ray cuts off the rest soon.
    pub fn visit_nearest(&self, ray: &DRay, near: f64, far: f64, mut visit: impl FnMut(u32, f64) -> f64) {
        let enter = |index: usize, far: f64| {
            self.nodes[index].bounds.span(ray, near, far).map_or(f64::INFINITY, |[enter, _]| enter)
        };
        let mut far = far;
        let mut stack = [(0_u32, 0.0); 64];
        let mut depth = usize::from(!self.nodes.is_empty());
        while depth > 0 {
            depth -= 1;
            let (index, enter_m) = stack[depth];
            if enter_m > far {
                continue;
            }
            let index = index as usize;
            let node = &self.nodes[index];
            if node.count > 0 {
                for &item in &self.items[node.first as usize..(node.first + node.count) as usize] {
                    far = visit(item, far);
                }
                continue;
            }
            let children = [index + 1, index + node.first as usize].map(|child| (child as u32, enter(child, far)));
            let nearer = usize::from(children[1].1 < children[0].1);
            for child in [children[1 - nearer], children[nearer]] {
                if child.1 < f64::INFINITY {
                    stack[depth] = child;
                    depth += 1;
                }
            }
        }
    }

    /// Calls `visit` for every item in leaves whose boxes a beam meets.
    pub fn visit_beam(&self, beam: &Beam, mut visit: impl FnMut(u32)) {
        self.descend((), |bounds, ()| beam.meets(bounds), |item, ()| visit(item));
    }

    /// Calls `visit` for every item in leaves whose boxes are met, given what `visit` has made of `known`.
    #[inline(always)]
    fn descend<K: Copy>(&self, mut known: K, meets: impl Fn(&Bounds, K) -> bool, mut visit: impl FnMut(u32, &mut K)) {
        let mut stack = [0_u32; 64];
        let mut depth = usize::from(!self.nodes.is_empty());
        while depth > 0 {
            depth -= 1;
            let index = stack[depth] as usize;
            let node = &self.nodes[index];
            if !meets(&node.bounds, known) {
                continue;
            }
            if node.count > 0 {
                for &item in &self.items[node.first as usize..(node.first + node.count) as usize] {
                    visit(item, &mut known);
                }
            } else {
                stack[depth] = index as u32 + node.first;
                stack[depth + 1] = index as u32 + 1;
                depth += 2;
            }
        }
    }

    /// Where, from `near` on, a ray first meets the box of a leaf; infinite where it meets none.
    pub fn first(&self, ray: &DRay, near: f64) -> f64 {
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

/// An item while it is sorted.
#[derive(Clone, Copy)]
struct Item {
    middle: Vec3,
    index: u32,
}

/// Nodes over so many items.
fn nodes_over(items: usize) -> usize {
    match items {
        0 => 0,
        1..=LEAF => 1,
        _ => 1 + nodes_over(items / 2) + nodes_over(items - items / 2),
    }
}

/// Fills the nodes over some items; gives their box.
fn halve(bounds: &[Bounds], items: &mut [Item], begin: usize, nodes: &mut [Node]) -> Bounds {
    let join = |a: Bounds, b: &Bounds| Bounds { low: a.low.min(b.low), high: a.high.max(b.high) };
    let count = items.len();
    if count <= LEAF {
        let all = items.iter().fold(Bounds::NOTHING, |all, item| join(all, &bounds[item.index as usize]));
        nodes[0] = Node { bounds: all, first: begin as u32, count: count as u32 };
        return all;
    }
    let [low, high] = items
        .iter()
        .fold([Vec3::INFINITY, Vec3::NEG_INFINITY], |[low, high], i| [low.min(i.middle), high.max(i.middle)]);
    let extent = high - low;
    let axis = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b])).unwrap_or(0);
    let half = count / 2;
    items.select_nth_unstable_by(half, |a, b| a.middle[axis].total_cmp(&b.middle[axis]).then(a.index.cmp(&b.index)));
    let (left, right) = items.split_at_mut(half);
    let (node, below) = nodes.split_at_mut(1);
    let (left_nodes, right_nodes) = below.split_at_mut(nodes_over(half));
    node[0].first = 1 + left_nodes.len() as u32;
    let (left, right) = if count >= PARALLEL {
        rayon::join(|| halve(bounds, left, begin, left_nodes), || halve(bounds, right, begin + half, right_nodes))
    } else {
        (halve(bounds, left, begin, left_nodes), halve(bounds, right, begin + half, right_nodes))
    };
    node[0].bounds = join(left, &right);
    node[0].bounds
}
