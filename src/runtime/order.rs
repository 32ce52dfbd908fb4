//! In which order a coat is drawn: from front to back, in pieces after each of which what is opaque by then hides the rest.

use super::detail::Detail;
use super::draw_list::{Frame, Show};
use super::sight::{Eye, Sighted};
use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;
use std::ops::Range;

/// Opacity from which on nothing is drawn behind.
pub const FULL: f32 = 0.98;
/// Pieces that a picture is drawn in.
const PIECES: usize = 24;
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
    /// Which of its tile's levels.
    pub level: usize,
    /// Which of its tile's looks.
    pub look: usize,
    /// Which items.
    pub items: Range<u32>,
}

/// A picture's items, and runs of them, in the order drawn.
#[derive(Clone, Debug)]
pub struct Order {
    /// All items.
    pub items: Vec<Item>,
    /// Pieces of about as many items each, at least one: neighbours of one kind, coat, level and look.
    pub pieces: Vec<Vec<Run>>,
    /// Which levels are drawn of each coat.
    pub details: Vec<Detail>,
    /// Height of the longest hair in the picture, pixels.
    pub height_px: f32,
}

/// Where an item comes, the last being nearest: steps from the furthest on; within one the far side from its outermost layer, whose rank is minus its number,
/// fins at 0, the near side at twice their numbers (of the finest level; a coarser one's count for as many more); then coats.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Place {
    step: i32,
    rank: i32,
    turn: u32,
    item: Item,
    fur: u32,
    level: usize,
    fins: bool,
}

impl Order {
    /// What `frame` shows of `furs` with `samples` along a pixel's edge.
    ///
    /// Along a ray through one coat the order is that of layers: the near side, outer to inner; fins; the far side, inner to outer. Of two
    /// limbs, fur of the near one comes first. Distances of triangles tell limbs apart, but no layers of one coat, as
    /// triangles are larger than layers are thick. So both add up: a layer counts as much as a triangle is long, and half as much on the
    /// far side, where little is seen.
    pub fn of(furs: &[&Sighted], frame: &Frame, samples: u32, show: Show) -> Self {
        let eye = Eye::of(frame, samples);
        let half_edge_m = furs.iter().map(|fur| 0.5 * fur.edge_m).fold(f32::MIN_POSITIVE, f32::max);
        let step =
            |away_m: f32, rank: i32| (rank as f32 - away_m / half_edge_m).clamp(-MOST_STEPS, MOST_STEPS).floor() as i32;
        let heights_px: Vec<f32> = furs.iter().map(|fur| fur.height_px(&eye)).collect();
        let details: Vec<Detail> =
            furs.iter().zip(&heights_px).map(|(fur, &height_px)| fur.detail(height_px, frame.level)).collect();
        let height_px = heights_px.into_iter().fold(0.0, f32::max);
        let mut places = Vec::new();
        for ((number, fur), detail) in furs.iter().enumerate().zip(&details) {
            // Of two coats in one place each is drawn over the other in every other layer.
            let turn = |layer: u32| match layer % 2 {
                1 if fur.over_last => number as u32 - 1,
                1 if furs.get(number + 1).is_some_and(|next| next.over_last) => number as u32 + 1,
                _ => number as u32,
            };
            let place = |away_m: f32, rank: i32, (level, fins): (usize, bool), item: Item| Place {
                step: step(away_m, rank),
                rank,
                turn: turn(item.layer()),
                item,
                fur: number as u32,
                level,
                fins,
            };
            for level in detail.levels().map(|(level, _)| level).filter(|_| show.shells) {
                let sight = &fur.levels[level];
                let per_layer = (fur.levels[0].layers() - 1) as f32 / (sight.layers() - 1) as f32;
                places.par_extend((0..fur.triangles.len()).into_par_iter().flat_map_iter(|index| {
                    let seen = move |layer| Some((layer, fur.slab(&eye, sight, index, layer)?));
                    (1..sight.layers()).filter_map(seen).map(move |(layer, seen)| {
                        let rank = (layer as f32 * per_layer * if seen.far { -1.0 } else { 2.0 }) as i32;
                        let item = Item::slab(index, layer, seen.far);
                        place(seen.away_m, rank, (level, false), item)
                    })
                }));
            }
            if show.fins && detail.fins() > 0.0 {
                places.par_extend(fur.fins.par_iter().enumerate().filter_map(|(index, fin)| {
                    let item = Item { index: index as u32, ..Item::default() };
                    Some(place(fur.fin(&eye, fin)?, 0, (0, true), item))
                }));
            }
        }
        places.par_sort_unstable();
        let mut order = Self { items: Vec::new(), pieces: vec![Vec::new()], details, height_px };
        let piece = places.len().div_ceil(PIECES).max(1);
        for (number, place) in places.into_iter().rev().enumerate() {
            if number % piece == 0 && number > 0 {
                order.pieces.push(Vec::new());
            }
            let fur = place.fur as usize;
            // What stands out as fins is guard hair.
            let look = if place.fins { 0 } else { furs[fur].levels[place.level].looks[place.item.layer() as usize] };
            order.push(place.fins, (fur, place.level), look, place.item);
        }
        order
    }

    /// All slabs of every coat's finest level that face the eye, or its skin alone, in no order.
    pub fn all(furs: &[&Sighted], frame: &Frame, samples: u32, skin: bool) -> Self {
        let details = vec![Detail::default(); furs.len()];
        let mut order = Self { items: Vec::new(), pieces: vec![Vec::new()], details, height_px: 0.0 };
        let eye = Eye::of(frame, samples);
        for (number, fur) in furs.iter().enumerate() {
            let sight = &fur.levels[0];
            for index in 0..fur.triangles.len() {
                let layers = if skin { 0..1 } else { 1..sight.layers() };
                for layer in layers.filter(|&layer| fur.faces(&eye, sight, index, layer)) {
                    order.push(false, (number, 0), 0, Item::slab(index, layer, false));
                }
            }
        }
        order
    }

    fn push(&mut self, fins: bool, (fur, level): (usize, usize), look: usize, item: Item) {
        let end = self.items.len() as u32;
        self.items.push(item);
        let Some(runs) = self.pieces.last_mut() else { return };
        match runs.last_mut().filter(|run| (run.fins, run.fur, run.level, run.look) == (fins, fur, level, look)) {
            Some(run) => run.items.end = end + 1,
            None => runs.push(Run { fins, fur, level, look, items: end..end + 1 }),
        }
    }
}
