//! Rays through the shell, from prism to prism, several side by side (Andersen et al. 2016 §3.2, `docs/steps/march.md`).

mod columns;
pub mod content;
mod measure;
pub mod shadows;
pub mod volume;

use super::shell::block::Blocks;
use super::shell::prism::ShellPoint;
use super::shell::prisms::{Jacobians, Prisms, ShellPoints};
use super::shell::sides::{across, next_side};
use crate::math::Vec3;
use crate::math::lanes::{F32s, Isa, MOST, Mask, Row, Vec3Row, Vec3s};
use volume::Volume;

/// How finely rays are followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stepping {
    /// Optical depth of a ray's first steps, at most about this, in (0, 4].
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
    /// Point in it.
    pub point: ShellPoint,
}

/// A ray to be followed until it leaves the shell, meets the skin, or passes `far_m`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MarchRay {
    /// Where the ray comes from, m.
    pub origin_m: Vec3,
    /// Unit vector.
    pub direction: Vec3,
    /// Where it enters.
    pub start: Start,
    /// Where it ends at the latest, m from the origin.
    pub far_m: f32,
}

/// A step through undercoat in each lane, as its middle found it.
#[derive(Clone, Copy, Debug)]
pub struct MarchSteps<I: Isa> {
    /// Distances where they begin, m.
    pub from_m: F32s<I>,
    /// Their lengths, m.
    pub length_m: F32s<I>,
    /// Barycentric coordinates of their middles.
    pub b: Vec3s<I>,
    /// Heights of their middles.
    pub t: F32s<I>,
    /// Mean directions of the hair, unit.
    pub hair: Vec3s<I>,
    /// Directions of the rays, unit.
    pub direction: Vec3s<I>,
    /// Optical depths.
    pub depth: F32s<I>,
}

/// What is done with rays. Lanes work on their own: which ray is in which lane changes nothing.
///
/// Implementations are `#[inline(always)]`, so that they are built for the vectors at hand.
pub trait MarchVisitor<I: Isa> {
    /// The next ray, which starts in `lane`; none when all are on their way.
    fn next(&mut self, lane: usize) -> Option<MarchRay>;
    /// Factors on the optical depth of the next steps, up to [`MOST_STEP_GROWTH`], and up to [`MOST_STEP_LENGTHENING`] on their length: they may be the longer, the less of what
    /// they find counts.
    fn step_scale(&self) -> F32s<I> {
        F32s::splat(1.0)
    }
    /// The ray in `lane` is now in prism `triangle`.
    fn enter(&mut self, _lane: usize, _triangle: u32) {}
    /// The rays in the lanes of `on` have made a step; says which may go on.
    fn visit(&mut self, prisms: &Prisms, steps: &MarchSteps<I>, on: Mask<I>) -> Mask<I>;
    /// The ray in `lane` has come to its end.
    fn end(&mut self, lane: usize);
}

/// No march takes more steps: some thousand prisms in a row.
pub const MOST_STEPS: u32 = 8192;

/// How much deeper than [`Stepping::depth`] a ray's last steps may be.
pub const MOST_STEP_GROWTH: f32 = 4.0;

/// How much longer than [`Stepping::layers`] they may be.
pub const MOST_STEP_LENGTHENING: f32 = 2.0;

/// How close to a prism's side counts as on it, in barycentric coordinates and shares of the height.
pub const ON_SIDE: f32 = 1e-4;

/// Follows all rays of `visitor`.
///
/// Every step lies in one prism. Coordinates are carried along by their gradients and put right by one Newton step; a step
/// ends on the side it would pass, and the march goes on in the neighbour there. Where prisms turn inside out, hair crosses: two
/// sheets of it end there together, and each is entered by a march of its own.
///
/// Returns the time that was spent on filling densities on the way, ns: it is not the march's own.
#[inline(always)]
pub fn march<I: Isa, T: MarchVisitor<I>>(volume: &Volume<'_>, stepping: &Stepping, visitor: &mut T) -> u64 {
    let mut flight = Flight {
        on: 0,
        origin_m: Vec3Row::default(),
        direction: Vec3Row::default(),
        far_m: Row::default(),
        at_m: Row::default(),
        b: [Row::default(); 2],
        t: Row::default(),
        sign: Row::default(),
        per_depth_m: Row::default(),
        push_m: Row::default(),
        steps: [0; MOST],
        triangles: [0; MOST],
        prisms: Prisms::default(),
        blocks: Blocks::new(volume.layers()),
        filling_ns: 0,
    };
    let mut waiting = true;
    loop {
        for lane in 0..I::LANES {
            if waiting && flight.on >> lane & 1 == 0 {
                match visitor.next(lane) {
                    Some(march_ray) => board(&mut flight, volume, visitor, lane, &march_ray),
                    None => waiting = false,
                }
            }
        }
        if flight.on == 0 {
            return flight.filling_ns;
        }
        advance(&mut flight, volume, stepping, visitor);
    }
}

/// The marches under way.
struct Flight<'v> {
    /// A bit per lane.
    on: u32,
    origin_m: Vec3Row,
    direction: Vec3Row,
    far_m: Row,
    at_m: Row,
    b: [Row; 2],
    t: Row,
    /// Sign of the determinant at the last step, which changes at folds; 0 before the first.
    sign: Row,
    /// Length per optical depth, by the last step's density, m.
    per_depth_m: Row,
    /// How far the last change of prism took the march along, m.
    push_m: Row,
    steps: [u32; MOST],
    triangles: [u32; MOST],
    prisms: Prisms,
    blocks: Blocks<'v>,
    /// Time spent on filling densities, ns.
    filling_ns: u64,
}

impl<'v> Flight<'v> {
    #[inline(always)]
    fn enter(&mut self, volume: &'v Volume<'_>, lane: usize, triangle: u32, point: ShellPoint) {
        self.triangles[lane] = triangle;
        self.prisms.set(lane, volume.content.corners(triangle), volume.content.twice_area_m2(triangle));
        self.blocks.set(lane, volume.block(triangle, &mut self.filling_ns));
        self.b[0].0[lane] = point.b[0];
        self.b[1].0[lane] = point.b[1];
        self.t.0[lane] = point.t;
    }

    fn point(&self, lane: usize) -> ShellPoint {
        ShellPoint { b: [self.b[0].0[lane], self.b[1].0[lane]], t: self.t.0[lane] }
    }
}

#[inline(always)]
fn board<'v, I: Isa, T: MarchVisitor<I>>(
    flight: &mut Flight<'v>,
    volume: &'v Volume<'_>,
    visitor: &mut T,
    lane: usize,
    march_ray: &MarchRay,
) {
    flight.on |= 1 << lane;
    flight.origin_m.set(lane, march_ray.origin_m);
    flight.direction.set(lane, march_ray.direction);
    flight.far_m.0[lane] = march_ray.far_m;
    flight.at_m.0[lane] = march_ray.start.at_m;
    flight.sign.0[lane] = 0.0;
    flight.per_depth_m.0[lane] = f32::INFINITY;
    flight.push_m.0[lane] = 0.0;
    flight.steps[lane] = 0;
    flight.enter(volume, lane, march_ray.start.triangle, march_ray.start.point);
    visitor.enter(lane, march_ray.start.triangle);
}

/// One step of all marches.
#[inline(always)]
fn advance<'v, I: Isa, T: MarchVisitor<I>>(
    flight: &mut Flight<'v>,
    volume: &'v Volume<'_>,
    stepping: &Stepping,
    visitor: &mut T,
) {
    let zero = F32s::<I>::splat(0.0);
    let on = Mask::from_bits(flight.on);
    let (direction, far_m) = (Vec3s::of(&flight.direction), F32s::of(&flight.far_m));
    let at_m = F32s::of(&flight.at_m);
    let points = ShellPoints { b: [F32s::of(&flight.b[0]), F32s::of(&flight.b[1])], t: F32s::of(&flight.t) };
    let j = flight.prisms.jacobians(&points);
    // Put right what the last step's straight line left over.
    let left_over = Vec3s::of(&flight.origin_m) + direction * at_m - j.at_m;
    let points = points.moved(j.rates(left_over), F32s::splat(1.0));
    let rates = j.rates(direction);
    let fastest = rates.x.abs() + rates.y.abs() + rates.z.abs();
    let sign = j.determinant.lt(zero).select(F32s::splat(-1.0), F32s::splat(1.0));
    let folded = (F32s::of(&flight.sign) * sign).lt(zero);
    flight.sign = sign.row();
    let moving = on & fastest.gt(zero) & fastest.lt(F32s::splat(f32::INFINITY)) & !folded;

    let layer_m = j.up_m.length() * (1.0 / volume.layers() as f32);
    let least_m = layer_m * 1e-3;
    let (side, side_m) = next_side(&points, rates, 1.0);
    let scale = visitor.step_scale();
    let depth = scale * stepping.depth;
    let layers = scale.min(F32s::splat(MOST_STEP_LENGTHENING)) * stepping.layers;
    let expected_m = F32s::of(&flight.per_depth_m) * depth;
    let longest_m = (layer_m * layers).min(expected_m).max(least_m);
    let mut length_m = longest_m.min(side_m.max(zero)).min(far_m - at_m);
    let walking = moving & length_m.gt(zero);

    let from = From { j, points, rates, at_m, direction };
    let mut shortened = false;
    // Called from one line, so that its code is there once.
    let steps = loop {
        let steps = volume.steps(&flight.prisms, &flight.blocks, &from, length_m);
        let too_deep = walking & steps.depth.gt(depth * 2.0) & length_m.gt(least_m);
        if shortened || too_deep.bits() == 0 {
            break steps;
        }
        let shorter_m = (length_m * depth / steps.depth).max(least_m);
        length_m = too_deep.select(shorter_m, length_m);
        shortened = true;
    };
    let per_depth_m = length_m / steps.depth.max(F32s::splat(1e-9));
    flight.per_depth_m = walking.select(per_depth_m, F32s::of(&flight.per_depth_m)).row();
    let seen = walking & steps.depth.gt(zero);
    let going = if seen.bits() == 0 { !seen } else { visitor.visit(&flight.prisms, &steps, seen) | !seen };
    let walked_m = walking.keep(length_m);
    let at_m = at_m + walked_m;
    let points = points.moved(rates, walked_m);

    let alive = moving & going & at_m.lt(far_m);
    let crossing = (alive & !length_m.lt(side_m)).bits();
    let over = flight.on & !alive.bits();
    flight.at_m = at_m.row();
    flight.b = [points.b[0].row(), points.b[1].row()];
    flight.t = points.t.row();
    let (side, least_m, walked_m) = (side.row(), least_m.row(), walked_m.row());
    for lane in 0..I::LANES {
        if flight.on >> lane & 1 == 0 {
            continue;
        }
        flight.steps[lane] += 1;
        let mut ended = over >> lane & 1 != 0 || flight.steps[lane] == MOST_STEPS;
        if crossing >> lane & 1 != 0 {
            match beyond(volume, flight, lane, side.0[lane]) {
                Some((triangle, point)) => {
                    flight.enter(volume, lane, triangle, point);
                    visitor.enter(lane, triangle);
                    // The next prism is entered a hair's breadth inside, so that rounding does not send the march back;
                    // ever deeper where folded prisms pass it to and fro.
                    let stuck = walked_m.0[lane] < least_m.0[lane];
                    let last_m = if stuck { flight.push_m.0[lane] } else { 0.0 };
                    flight.push_m.0[lane] = (2.0 * last_m).max(ON_SIDE * least_m.0[lane]);
                    flight.at_m.0[lane] += flight.push_m.0[lane];
                }
                None => ended = true,
            }
        }
        if ended {
            flight.on &= !(1 << lane);
            visitor.end(lane);
        }
    }
}

/// Where steps begin.
struct From<I: Isa> {
    j: Jacobians<I>,
    points: ShellPoints<I>,
    rates: Vec3s<I>,
    at_m: F32s<I>,
    direction: Vec3s<I>,
}

/// The prism and point beyond a side; none at the top, the skin and open borders.
fn beyond(volume: &Volume<'_>, flight: &Flight<'_>, lane: usize, side: f32) -> Option<(u32, ShellPoint)> {
    let corner = side as usize;
    if corner > 2 {
        return None;
    }
    let beyond = volume.shell().neighbours.beyond(flight.triangles[lane], corner)?;
    Some((beyond.triangle, across(&flight.point(lane), corner, usize::from(beyond.corner))))
}
