//! Rays through the shell, from prism to prism (Andersen et al. 2016 §3.2, `docs/steps/march.md`).

pub mod enter;
pub mod light;
pub mod volume;

use super::shell::prism::Place;
use crate::math::Vec3;
use volume::Volume;

/// How finely rays are followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stepping {
    /// Optical depth of a step, at most about this, in (0, 4].
    pub depth: f32,
    /// Length of a step, at most, in layers' thicknesses, in (0, 16].
    pub layers: f32,
}

impl Default for Stepping {
    fn default() -> Self {
        Self { depth: 0.25, layers: 2.0 }
    }
}

/// Where a march stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// Distance along the ray, m.
    pub at_m: f32,
    /// Prism.
    pub triangle: u32,
    /// Place in it.
    pub place: Place,
}

/// One step through undercoat, as its middle found it.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// Distance where it begins, m.
    pub from_m: f32,
    /// Its length, m.
    pub length_m: f32,
    /// Prism.
    pub triangle: u32,
    /// Place of its middle.
    pub place: Place,
    /// Mean direction of the hair, unit.
    pub hair: Vec3,
    /// Optical depth.
    pub depth: f32,
}

/// No march takes more steps: some thousand prisms in a row.
const MOST_STEPS: usize = 8192;

/// How close to a prism's side counts as on it, in barycentric coordinates and shares of the height.
const ON_SIDE: f32 = 1e-4;

/// Follows a ray until it leaves the shell, meets the skin, passes `far_m`, or `visit` returns false.
///
/// Every step lies in one prism. Coordinates are carried along by their gradients and put right by one Newton step; a step
/// ends on the side it would pass, and the march goes on in the neighbour there.
pub fn march(
    volume: &Volume<'_>,
    origin_m: Vec3,
    direction: Vec3,
    start: Start,
    far_m: f32,
    stepping: &Stepping,
    mut visit: impl FnMut(&Step) -> bool,
) {
    let shell = volume.shell();
    let Start { mut at_m, mut triangle, mut place } = start;
    let mut prism = shell.prism(triangle);
    let mut expected = f32::INFINITY;
    for _ in 0..MOST_STEPS {
        let j = prism.jacobian(&place);
        // Put right what the last step's straight line left over.
        let place_here = place.moved(j.rates(origin_m + direction * at_m - j.at_m), 1.0);
        let rates = j.rates(direction);
        if !rates.is_finite() || rates == Vec3::ZERO {
            return;
        }
        place = place_here;
        let thickness_m = j.up_m.length() / volume.layers() as f32;
        let least_m = 1e-3 * thickness_m;
        let side = next_side(&place, rates);
        let longest_m = (stepping.layers * thickness_m).min(expected).max(least_m);
        let mut length_m = longest_m.min(side.after_m.max(0.0)).min(far_m - at_m);
        if length_m > 0.0 {
            let mut step = volume.step(&j, triangle, &place, rates, at_m, length_m, direction);
            if step.depth > 2.0 * stepping.depth && length_m > least_m {
                length_m = (length_m * stepping.depth / step.depth).max(least_m);
                step = volume.step(&j, triangle, &place, rates, at_m, length_m, direction);
            }
            expected = stepping.depth * length_m / step.depth.max(1e-9);
            if step.depth > 0.0 && !visit(&step) {
                return;
            }
            at_m += length_m;
            place = place.moved(rates, length_m);
        }
        if at_m >= far_m {
            return;
        }
        if length_m < side.after_m {
            continue;
        }
        match side.which {
            Side::Top | Side::Skin => return,
            Side::Edge(corner) => {
                let Some(beyond) = shell.neighbours.beyond(triangle, corner) else { return };
                place = across(&place, corner, usize::from(beyond.corner));
                triangle = beyond.triangle;
                prism = shell.prism(triangle);
                // The next prism is entered a hair's breadth inside, so that rounding does not send the march back.
                at_m += ON_SIDE * least_m;
            }
        }
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Side {
    Top,
    Skin,
    Edge(usize),
}

struct Next {
    which: Side,
    after_m: f32,
}

/// The side that a straight line in coordinates passes first.
fn next_side(place: &Place, rates: Vec3) -> Next {
    let mut next = Next { which: Side::Top, after_m: f32::INFINITY };
    let mut offer = |which: Side, left: f32, rate: f32| {
        if rate < 0.0 && left / -rate < next.after_m {
            next = Next { which, after_m: left / -rate };
        }
    };
    offer(Side::Edge(0), 1.0 - place.b[0] - place.b[1], -rates.x - rates.y);
    offer(Side::Edge(1), place.b[0], rates.x);
    offer(Side::Edge(2), place.b[1], rates.y);
    offer(Side::Top, 1.0 - place.t, -rates.z);
    offer(Side::Skin, place.t, rates.z);
    next
}

/// A place on the edge opposite to `corner`, in the neighbour whose `opposite` corner lies beyond it.
///
/// The neighbour runs through the shared edge the other way around.
fn across(place: &Place, corner: usize, opposite: usize) -> Place {
    let b = place.barycentric().to_array();
    let mut beyond = [0.0; 3];
    beyond[(opposite + 1) % 3] = b[(corner + 2) % 3];
    beyond[(opposite + 2) % 3] = b[(corner + 1) % 3];
    let sum = beyond[0] + beyond[1] + beyond[2];
    let scale = if sum > 0.0 { 1.0 / sum } else { 0.0 };
    Place { b: [beyond[1] * scale, beyond[2] * scale], t: place.t }
}
