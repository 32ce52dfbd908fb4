//! What lights give at a point, in f64, from the text of the glTF extension KHR_lights_punctual.

use crate::data::light::{Light, NEAREST_M, Point, Spot};
use crate::math::DVec3;

/// What arrives at a point.
#[derive(Clone, Copy, Debug)]
pub struct Arriving {
    /// Vector to the light; of length 1, but for what rounding to f32 left.
    pub to_light: DVec3,
    /// Irradiance on a plane at a right angle to it, linear RGB.
    pub irradiance: DVec3,
    /// Distance of the light, m.
    pub distance_m: f64,
}

impl Arriving {
    /// What `light` gives at `p`, m.
    pub fn new(light: &Light, p: DVec3) -> Self {
        match light {
            Light::Directional(light) => Self {
                to_light: light.to_light.as_dvec3(),
                irradiance: light.irradiance.as_dvec3(),
                distance_m: f64::INFINITY,
            },
            Light::Point(point) => Self::of_point(point, p),
            Light::Spot(spot) => {
                let all = Self::of_point(&spot.point, p);
                Self { irradiance: all.irradiance * share(spot, -all.to_light), ..all }
            }
        }
    }

    fn of_point(point: &Point, p: DVec3) -> Self {
        let to = point.position_m.as_dvec3() - p;
        let distance_m = to.length().max(f64::from(NEAREST_M));
        // It ends at its range, not all at once.
        let window = point.range_m.map_or(1.0, |range_m| 1.0 - (distance_m / f64::from(range_m)).powi(4));
        Self {
            to_light: to.normalize_or(DVec3::Y),
            irradiance: point.intensity.as_dvec3() * window.max(0.0) / (distance_m * distance_m),
            distance_m,
        }
    }
}

/// Share of light that a cone sends along a unit vector: all within the inner angle, none past the outer one, and the square of
/// what is linear in the angle's cosine between them.
fn share(spot: &Spot, along: DVec3) -> f64 {
    let (inner, outer) = (f64::from(spot.inner_cos), f64::from(spot.outer_cos));
    let cosine = along.dot(spot.direction.as_dvec3());
    if cosine >= inner {
        return 1.0;
    }
    ((cosine - outer) / (inner - outer)).max(0.0).powi(2)
}
