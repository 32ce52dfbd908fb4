//! Guard hairs, drawn one by one.

use crate::math::Vec3;
use serde::Serialize;

/// Where a hair grows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Root {
    /// Triangle of the skin mesh.
    pub triangle: u32,
    /// Barycentric coordinates of the first two corners.
    pub barycentric: [f32; 2],
}

/// What all hairs of one set share.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Profile {
    /// Tip radius over root radius; in between linear in arc length.
    pub taper: f32,
    /// Colour factors at root, middle and tip, linear RGB in [0, 1]; in between linear.
    pub ramp: [Vec3; 3],
    /// Opacity at s ∈ [0, 1] along the hair is 1 − (e^{ks} − 1)/(e^k − 1)·`tip_transparency` (Andersen et al. 2016
    /// §3.1: transparency grows exponentially towards the tip).
    pub tip_transparency: f32,
    /// The exponent k above.
    pub tip_exponent: f32,
}

impl Profile {
    /// Radius over root radius at `s` ∈ [0, 1].
    pub fn radius_factor(&self, s: f32) -> f32 {
        1.0 + (self.taper - 1.0) * s
    }

    /// Colour factor at `s` ∈ [0, 1].
    pub fn ramp_at(&self, s: f32) -> Vec3 {
        if s < 0.5 { self.ramp[0].lerp(self.ramp[1], 2.0 * s) } else { self.ramp[1].lerp(self.ramp[2], 2.0 * s - 1.0) }
    }

    /// Opacity at `s` ∈ [0, 1].
    pub fn opacity_at(&self, s: f32) -> f32 {
        if self.tip_transparency == 0.0 {
            return 1.0;
        }
        1.0 - self.tip_transparency * libm::expm1f(self.tip_exponent * s) / libm::expm1f(self.tip_exponent)
    }
}

/// A set of hairs as polylines with `points_per_strand` points each, root first, evenly spaced in arc parameter
/// s = i / (points_per_strand − 1).
///
/// Growth maps each hair from shell space (its root's barycentric coordinates and tangent frame) to the skin it is
/// given, so a posed mesh gets the same hairs by growing again.
#[derive(Clone, Debug)]
pub struct Strands {
    /// At least 2.
    pub points_per_strand: usize,
    /// `len() * points_per_strand` points, m.
    pub points_m: Vec<Vec3>,
    /// One per hair.
    pub roots: Vec<Root>,
    /// Radius at the root, one per hair, m.
    pub root_radius_m: Vec<f32>,
    /// Colour that multiplies the profile's ramp, one per hair, linear RGB.
    pub tint: Vec<Vec3>,
    /// Source index, one per hair: breaks ties of depth, so that order and threads do not matter.
    pub id: Vec<u32>,
    /// What all hairs share.
    pub profile: Profile,
}

impl Strands {
    /// How many hairs.
    pub fn len(&self) -> usize {
        self.roots.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.roots.is_empty()
    }

    /// The points of hair `i`, root first, m.
    pub fn points_of_m(&self, i: usize) -> &[Vec3] {
        &self.points_m[i * self.points_per_strand..(i + 1) * self.points_per_strand]
    }

    /// No hair yet, of the same kind.
    pub fn none_alike(&self) -> Self {
        Self {
            points_per_strand: self.points_per_strand,
            points_m: Vec::new(),
            roots: Vec::new(),
            root_radius_m: Vec::new(),
            tint: Vec::new(),
            id: Vec::new(),
            profile: self.profile,
        }
    }

    /// Adds hair `i` of `others`, with `points_m` in place of its points, as many, and `widening` times as wide.
    pub fn push_alike(&mut self, others: &Self, i: usize, points_m: impl IntoIterator<Item = Vec3>, widening: f32) {
        self.points_m.extend(points_m);
        self.roots.push(others.roots[i]);
        self.root_radius_m.push(others.root_radius_m[i] * widening);
        self.tint.push(others.tint[i]);
        self.id.push(others.id[i]);
    }
}
