//! The first hair along a ray, which may itself begin at a hair.

use super::tree::Tree;
use crate::data::mesh::Mesh;
use crate::data::strands::Strands;
use crate::math::DVec3;
use crate::reference::bvh::DRay;
use crate::reference::cone;
use crate::reference::guard::{Crossing, GuardCones};

/// The hair from whose surface a ray begins: it does not meet that again before it has left it. All that a fibre does with light
/// is counted where the light meets it, so what is sent through it is not blocked by its far side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leaving {
    /// The hair.
    pub strand: u32,
    /// Its segment.
    pub segment: u32,
}

impl From<Crossing> for Leaving {
    fn from(crossing: Crossing) -> Self {
        Self { strand: crossing.strand, segment: crossing.segment }
    }
}

/// What rounding may move a point off a surface, in radii of the hair.
const ROUNDING: f64 = 1e-4;

/// Which crossing is looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// The first.
    First,
    /// Whichever is found soonest.
    Any,
}

/// Guard hairs, and where they are.
#[derive(Debug)]
pub struct Hairs<'a> {
    /// The hairs as round cones.
    pub cones: GuardCones<'a>,
    tree: Tree,
}

impl<'a> Hairs<'a> {
    /// Of strands on a skin.
    pub fn new(strands: &'a Strands, skin: &'a Mesh) -> Self {
        let cones = GuardCones::unsorted(strands, skin);
        let tree = Tree::new(&cones);
        Self { cones, tree }
    }

    /// A hair that a ray meets between two distances. Hairs in which it begins are not met until they are left.
    pub fn meet(
        &self,
        ray: &DRay,
        [near_m, far_m]: [f64; 2],
        leaving: Option<Leaving>,
        wanted: Wanted,
    ) -> Option<Crossing> {
        let cones = &self.cones;
        let left_m = leaving.map(|leaving| left_m(cones, ray, near_m, leaving));
        let mut found: Option<Crossing> = None;
        let mut last = None;
        self.tree.visit(ray, far_m, |strand, segment, far_m| {
            // A segment lies in several boxes, mostly side by side.
            if last.replace((strand, segment)) == Some((strand, segment)) || !passes(cones, ray, strand, segment) {
                return far_m;
            }
            let Some(crossing) = cones.cross(ray, strand, segment) else { return far_m };
            let own = leaving.is_some_and(|leaving| leaving.strand == strand)
                && left_m.is_some_and(|left_m| crossing.enter_m <= left_m);
            if own || crossing.enter_m < near_m || crossing.enter_m >= far_m {
                return far_m;
            }
            found = Some(crossing);
            if wanted == Wanted::Any { f64::NEG_INFINITY } else { crossing.enter_m }
        });
        found
    }
}

/// Whether a ray's line passes as near to a segment's line as the segment is thick: most of those whose boxes it meets it does
/// not.
fn passes(guard: &GuardCones<'_>, ray: &DRay, strand: u32, segment: u32) -> bool {
    let ([from_m, to_m], radius_m) = guard.ends(strand, segment);
    let across = ray.direction.cross(to_m - from_m);
    let beside = (from_m - ray.origin_m).dot(across);
    let widest_m = radius_m[0].max(radius_m[1]);
    beside * beside <= widest_m * widest_m * across.length_squared()
}

/// Where a ray that begins on or in a hair has left it, over all of its segments that follow one another there.
fn left_m(guard: &GuardCones<'_>, ray: &DRay, near_m: f64, leaving: Leaving) -> f64 {
    let Leaving { strand, segment } = leaving;
    let rounding_m = ROUNDING * guard.ends(strand, segment).1[0];
    let mut until_m = near_m + rounding_m;
    let mut inside = |segment: u32| {
        let ([from_m, to_m], radius_m) = guard.ends(strand, segment);
        let ends: [DVec3; 2] = [from_m, to_m].map(|end_m| end_m - ray.origin_m);
        let met = cone::enter_and_leave(ends[0], ends[1], radius_m, ray.direction);
        let met = met.filter(|&[enter_m, leave_m, _]| enter_m <= until_m && leave_m + rounding_m >= near_m);
        if let Some([_, leave_m, _]) = met {
            until_m = until_m.max(leave_m + rounding_m);
        }
        met.is_some()
    };
    inside(segment);
    let _ = (segment + 1..guard.segments()).all(&mut inside);
    let _ = (0..segment).rev().all(&mut inside);
    until_m
}
