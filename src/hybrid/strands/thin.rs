//! Fewer, wider hairs, where single ones are too thin for the picture to show (Cook, Halstead, Planck and Ryu 2007,
//! "Stochastic Simplification of Aggregate Detail").
//!
//! Hairs of which a share λ is to be left give way in an order of their own, by id, so that a hair that is there from afar is
//! there from near. Those next in turn are thin already, so that none comes or goes at once. What is left is wider, so that
//! hairs cover as much as before.

use crate::data::strands::Strands;
use crate::stage::projection::Projection;

/// Least share of the hairs that is left.
const LEAST: f32 = 1.0 / 64.0;
/// Share of what is drawn that is on its way out.
const FADING: f32 = 0.125;

/// Which hairs of a picture are drawn, and how much wider than they are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thinning {
    view: Projection,
    /// Width that hairs are to have at their roots, px; none where every hair is drawn as it is.
    hair_px: f32,
}

impl Thinning {
    /// For pictures of `view`, where hairs are to be at least `hair_px` wide; 0 draws every hair.
    pub fn new(view: &Projection, hair_px: f32) -> Self {
        Self { view: *view, hair_px }
    }

    /// Factor on the width of a hair; 0 where it is not drawn.
    #[inline]
    pub fn widening(&self, strands: &Strands, strand: usize) -> f32 {
        if self.hair_px <= 0.0 {
            return 1.0;
        }
        let z_m = self.view.camera_from_world(strands.points_m[strand * strands.points_per_strand]).z;
        let width_px = 2.0 * strands.root_radius_m[strand] * self.view.focal_px / z_m;
        // Hair around the eye or behind it is as wide as it is.
        let share = if z_m > self.view.near_m { (width_px / self.hair_px).clamp(LEAST, 1.0) } else { 1.0 };
        widening(share, turn(strands.id[strand]))
    }

    /// The hairs that are drawn, as wide as they are drawn; none where all are drawn as they are.
    pub fn of(&self, strands: &Strands) -> Option<Strands> {
        if self.hair_px <= 0.0 {
            return None;
        }
        let mut left = strands.none_alike();
        for i in 0..strands.len() {
            let widening = self.widening(strands, i);
            if widening > 0.0 {
                left.push_alike(strands, i, strands.points_of_m(i).iter().copied(), widening);
            }
        }
        Some(left)
    }
}

/// Where a hair stands in the order in which hairs give way, in [0, 1): the last go first. Multiples of the golden ratio, so
/// that of hairs that grow side by side every share is spread evenly.
fn turn(id: u32) -> f32 {
    (id.wrapping_mul(0x9E37_79B9) >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// Factor on the width of a hair at `turn`, where a `share` of all is to be left. Its mean over all turns is 1.
fn widening(share: f32, turn: f32) -> f32 {
    if share >= 1.0 {
        return 1.0;
    }
    let last = share / (1.0 - FADING);
    let fading = FADING * last;
    let weight = |turn: f32| ((last - turn) / fading).clamp(0.0, 1.0);
    // Mean of the weights over all turns; what lies beyond 1 is not there.
    let beyond = (last - 1.0).max(0.0);
    let mean = last - 0.5 * fading - 0.5 * beyond * beyond / fading;
    weight(turn) / mean
}
