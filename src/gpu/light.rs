//! Lights as shaders read them.

use crate::data::light::{Light, Point};
use bytemuck::{Pod, Zeroable};

/// `Light` of `shared/light.wgsl`; `tests/shaders.rs` compares names, offsets and sizes.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct LightItem {
    /// The unit vector to a light from infinitely far away, the position of any other, m.
    pub place: [f32; 3],
    /// 1 over the range, 1/m; 0 where it goes on for ever.
    pub per_range: f32,
    /// Irradiance of a light from infinitely far away, of any other irradiance × m², linear RGB.
    pub strength: [f32; 3],
    /// 0 for a light from infinitely far away, 1 for any other.
    pub near: f32,
    /// Unit vector along the axis of a cone, or zero.
    pub axis: [f32; 3],
    /// What a cosine to the axis is multiplied by.
    pub cone_scale: f32,
    /// What is added to it.
    pub cone_offset: f32,
    pub(super) _pad: [f32; 3],
}

impl From<&Light> for LightItem {
    fn from(light: &Light) -> Self {
        let point = |point: &Point| Self {
            place: point.position_m.to_array(),
            per_range: point.per_range(),
            strength: point.intensity.to_array(),
            near: 1.0,
            // A cone that holds everything.
            cone_offset: 1.0,
            ..Self::default()
        };
        match light {
            Light::Directional(light) => {
                Self { place: light.to_light.to_array(), strength: light.irradiance.to_array(), ..Self::default() }
            }
            Light::Point(light) => point(light),
            Light::Spot(spot) => {
                let [cone_scale, cone_offset] = spot.cone();
                Self { axis: spot.direction.to_array(), cone_scale, cone_offset, ..point(&spot.point) }
            }
        }
    }
}
