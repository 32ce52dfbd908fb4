//! How the key light sees what it lights: the projection of its shadow map.

use super::casters::{Bounds, Casters};
use crate::data::light::{Light, Spot};
use crate::math::{Mat4, Vec2, Vec3};

/// Texels along the map's edges.
pub const TEXELS: u32 = 1024;

/// Texels by which what is lit is moved towards the light along its normal before it is compared: more than the filter reaches.
const BIAS_TEXELS: f32 = 2.5;

/// Tangent of half the widest angle that a map covers.
const WIDEST: f32 = 3.0;

/// Share of a map's edge left free on each side.
const MARGIN: f32 = 0.01;

/// A shadow map's place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowView {
    /// World to the map's clip space: depth 0 nearest to the light, 1 farthest.
    pub clip_from_world: Mat4,
    /// How far what is compared is moved along its normal where w is 1, m.
    pub bias_m: f32,
    /// Whether what is no part of the asset may cast a shadow on it.
    pub guests_reach: bool,
}

impl ShadowView {
    /// The map in which `light` sees all of the asset; none without an asset, and where the light stands so near to it or within it
    /// that no map holds it.
    ///
    /// Light from infinitely far away has a parallel projection, all other a perspective one towards the asset's middle, or, where
    /// a spot's cone is narrower than the asset, along its axis.
    pub fn of(light: &Light, casters: &Casters) -> Option<Self> {
        let asset = casters.asset?;
        let view = match light {
            Light::Directional(light) => Some(parallel(light.to_light, &asset, casters)),
            Light::Point(point) => towards(point.position_m, &asset, casters, WIDEST),
            Light::Spot(spot) => {
                let tangent = (1.0 / spot.outer_cos.max(1e-3).powi(2) - 1.0).sqrt();
                towards(spot.point.position_m, &asset, casters, tangent.min(WIDEST))
                    .or_else(|| (tangent <= WIDEST).then(|| along(spot, tangent, &asset, casters)))
            }
        };
        view.map(|view| Self { guests_reach: view.reached(light, casters), ..view })
    }

    /// Whether the shadow of what is no part of the asset can fall on it: seen from the light it lies neither beside the asset nor
    /// behind all of it, nor where the light has ended.
    fn reached(&self, light: &Light, casters: &Casters) -> bool {
        let (Some(guests), Some(asset)) = (casters.guests, casters.asset) else { return true };
        if let Light::Point(point) | Light::Spot(Spot { point, .. }) = light {
            let nearest = point.position_m.clamp(guests.low, guests.high);
            if point.range_m.is_some_and(|range_m| nearest.distance(point.position_m) > range_m) {
                return false;
            }
        }
        let seen = |bounds: &Bounds| bounds.corners().map(|p| self.clip_from_world * p.extend(1.0));
        let (guests, asset) = (seen(&guests), seen(&asset));
        let beside = (0..2).any(|i| guests.iter().all(|p| p[i] > p.w) || guests.iter().all(|p| p[i] < -p.w));
        let depth = |p: &crate::math::Vec4| if p.w > 0.0 { p.z / p.w } else { 0.0 };
        let last = asset.iter().map(depth).fold(0.0, f32::max);
        let behind = guests.iter().all(|p| depth(p) > last);
        let before = guests.iter().all(|p| p.w <= 0.0);
        !(beside || behind || before)
    }
}

/// Axes across a unit vector towards the light.
fn across(back: Vec3) -> [Vec3; 2] {
    let right = back.any_orthonormal_vector();
    [right, back.cross(right)]
}

/// Rows to a matrix.
fn matrix(rows: [(Vec3, f32); 4]) -> Mat4 {
    Mat4::from_cols_array_2d(&rows.map(|(row, last)| row.extend(last).to_array())).transpose()
}

fn parallel(to_light: Vec3, asset: &Bounds, casters: &Casters) -> ShadowView {
    let axes = across(to_light);
    let middle = asset.middle();
    let half = |axis: Vec3| asset.corners().iter().map(|p| (*p - middle).dot(axis).abs()).fold(1e-6, f32::max);
    let half_m = axes.map(|axis| half(axis) * (1.0 + 2.0 * MARGIN));
    let depths = asset.and(casters.guests).corners().map(|p| -p.dot(to_light));
    let (near, far) = depths.iter().fold((f32::MAX, f32::MIN), |(near, far), &d| (near.min(d), far.max(d)));
    let room = 1e-3 * (far - near).max(half_m[0] + half_m[1]);
    let (near, range) = (near - room, far - near + 2.0 * room);
    let row = |axis: Vec3, half: f32| (axis / half, -middle.dot(axis) / half);
    ShadowView {
        clip_from_world: matrix([
            row(axes[0], half_m[0]),
            row(axes[1], half_m[1]),
            (-to_light / range, -near / range),
            (Vec3::ZERO, 1.0),
        ]),
        bias_m: BIAS_TEXELS * 2.0 * half_m[0].max(half_m[1]) / TEXELS as f32,
        guests_reach: true,
    }
}

/// From `eye_m` towards the asset's middle; none where it takes an angle wider than that of tangent `most`.
fn towards(eye_m: Vec3, asset: &Bounds, casters: &Casters, most: f32) -> Option<ShadowView> {
    let forward = (asset.middle() - eye_m).try_normalize()?;
    let [right, up] = across(-forward);
    let slope = |p: &Vec3| {
        let p = *p - eye_m;
        let sideways = Vec2::new(p.dot(right), p.dot(up)).abs().max_element();
        let depth = p.dot(forward);
        if depth > 0.0 { sideways / depth } else { f32::INFINITY }
    };
    let tangent = asset.corners().iter().map(slope).fold(1e-6, f32::max) * (1.0 + 2.0 * MARGIN);
    (tangent <= most).then(|| perspective(eye_m, forward, tangent, asset, casters))
}

/// Along the axis of a spot, in its cone.
fn along(spot: &Spot, tangent: f32, asset: &Bounds, casters: &Casters) -> ShadowView {
    perspective(spot.point.position_m, spot.direction, tangent, asset, casters)
}

fn perspective(eye_m: Vec3, forward: Vec3, tangent: f32, asset: &Bounds, casters: &Casters) -> ShadowView {
    let [right, up] = across(-forward);
    let depths = asset.and(casters.guests).corners().map(|p| (p - eye_m).dot(forward));
    let (least, far) = depths.iter().fold((f32::MAX, 1e-6), |(near, far), &d| (near.min(d), d.max(far)));
    let far = far * 1.01;
    let near = (least * 0.99).clamp(far * 1e-3, far * 0.98);
    let scale = far / (far - near);
    let row = |axis: Vec3, factor: f32, add: f32| (axis * factor, add - eye_m.dot(axis) * factor);
    ShadowView {
        clip_from_world: matrix([
            row(right, 1.0 / tangent, 0.0),
            row(up, 1.0 / tangent, 0.0),
            row(forward, scale, -scale * near),
            row(forward, 1.0, 0.0),
        ]),
        bias_m: BIAS_TEXELS * 2.0 * tangent / TEXELS as f32,
        guests_reach: true,
    }
}
