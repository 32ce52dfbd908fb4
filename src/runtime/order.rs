//! In which order a coat is drawn: from back to front.

use super::draw_list::{Frame, Show};
use super::sight::{Eye, Sighted};
use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;
use std::ops::Range;

/// Most steps to either side of the eye.
const MOST_STEPS: f32 = 8e5;

/// `Item` of `runtime/items.wgsl`: a triangle of a shell, or a fin.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Pod, Zeroable)]
pub struct Item {
    /// Number of the triangle, or of the fin.
    pub index: u32,
    /// Layer of a triangle, and [`Item::FAR`] where it is seen from inside.
    pub layer: u32,
}

impl Item {
    /// Added to the layer of what is seen from inside.
    pub const FAR: u32 = 1 << 16;

    /// A triangle of a layer.
    pub fn slab(index: usize, layer: u32, far: bool) -> Self {
        Self { index: index as u32, layer: layer + if far { Self::FAR } else { 0 } }
    }

    /// Layer of a triangle.
    pub fn layer(&self) -> u32 {
        self.layer % Self::FAR
    }

    /// Whether it is seen from inside.
    pub fn far(&self) -> bool {
        self.layer >= Self::FAR
    }
}

/// What is drawn at once.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Run {
    /// Whether it is fins rather than shells.
    pub fins: bool,
    /// Which of the coats.
    pub fur: usize,
    /// Which of its tile's looks.
    pub look: usize,
    /// Which items.
    pub items: Range<u32>,
}

/// A picture's items, and runs of them, in the order drawn.
#[derive(Clone, Debug, Default)]
pub struct Order {
    /// All items.
    pub items: Vec<Item>,
    /// Neighbours of one kind, coat and look.
    pub runs: Vec<Run>,
}

/// Where an item comes: steps from the furthest on; within one the far side from its outermost layer, whose rank is minus its number,
/// fins at 0, the near side at twice their numbers; then coats.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Place {
    step: i32,
    rank: i32,
    turn: u32,
    item: Item,
    fur: u32,
    fins: bool,
}

impl Order {
    /// What `frame` shows of `furs` with `samples` along a pixel's edge.
    ///
    /// Along a ray through one coat the order is that of layers: the far side, outer to inner; fins; the near side, inner to outer. Of two
    /// limbs, fur of the near one lies over that of the other. Distances of triangles tell limbs apart, but no layers of one coat, as
    /// triangles are larger than layers are thick. So both add up: a layer counts as much as a triangle is long, and half as much on the
    /// far side, where little is seen.
    pub fn of(furs: &[&Sighted], frame: &Frame, samples: u32, show: Show) -> Self {
        let eye = Eye::of(frame, samples);
        let half_edge_m = furs.iter().map(|fur| 0.5 * fur.edge_m).fold(f32::MIN_POSITIVE, f32::max);
        let step =
            |away_m: f32, rank: i32| (rank as f32 - away_m / half_edge_m).clamp(-MOST_STEPS, MOST_STEPS).floor() as i32;
        let mut places = Vec::new();
        for (number, fur) in furs.iter().enumerate() {
            // Of two coats in one place each is drawn over the other in every other layer.
            let turn = |layer: u32| match layer % 2 {
                1 if fur.over_last => number as u32 - 1,
                1 if furs.get(number + 1).is_some_and(|next| next.over_last) => number as u32 + 1,
                _ => number as u32,
            };
            let place = |away_m: f32, rank: i32, fins: bool, item: Item| Place {
                step: step(away_m, rank),
                rank,
                turn: turn(item.layer()),
                item,
                fur: number as u32,
                fins,
            };
            if show.shells {
                places.par_extend((0..fur.triangles.len()).into_par_iter().flat_map_iter(|index| {
                    let seen = move |layer| Some((layer, fur.slab(&eye, index, layer)?));
                    (1..fur.layers).filter_map(seen).map(move |(layer, seen)| {
                        let rank = if seen.far { -(layer as i32) } else { 2 * layer as i32 };
                        let item = Item::slab(index, layer, seen.far);
                        place(seen.away_m, rank, false, item)
                    })
                }));
            }
            if show.fins {
                places.par_extend(fur.fins.par_iter().enumerate().filter_map(|(index, fin)| {
                    let item = Item { index: index as u32, ..Item::default() };
                    Some(place(fur.fin(&eye, fin)?, 0, true, item))
                }));
            }
        }
        places.par_sort_unstable();
        let mut order = Self::default();
        for place in places {
            let fur = place.fur as usize;
            // What stands out as fins is guard hair.
            let look = if place.fins { 0 } else { furs[fur].looks[place.item.layer() as usize] };
            order.push(place.fins, fur, look, place.item);
        }
        order
    }

    /// All slabs of every coat that face the eye, or its skin alone, in no order.
    pub fn all(furs: &[&Sighted], frame: &Frame, samples: u32, skin: bool) -> Self {
        let mut order = Self::default();
        let eye = Eye::of(frame, samples);
        for (number, fur) in furs.iter().enumerate() {
            for index in 0..fur.triangles.len() {
                let layers = if skin { 0..1 } else { 1..fur.layers };
                for layer in layers.filter(|&layer| fur.faces(&eye, index, layer)) {
                    order.push(false, number, 0, Item::slab(index, layer, false));
                }
            }
        }
        order
    }

    fn push(&mut self, fins: bool, fur: usize, look: usize, item: Item) {
        let end = self.items.len() as u32;
        self.items.push(item);
        match self.runs.last_mut().filter(|run| (run.fins, run.fur, run.look) == (fins, fur, look)) {
            Some(run) => run.items.end = end + 1,
            None => self.runs.push(Run { fins, fur, look, items: end..end + 1 }),
        }
    }
}
