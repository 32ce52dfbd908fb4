//! Lights: from infinitely far away, from a point, and from a point in a cone.
//!
//! Point and spot lights are those of the glTF extension [KHR_lights_punctual], whose words are cited where they are followed. The
//! extension gives intensities in candela; here they are irradiance × m², linear RGB, so that a point light of intensity I lights a
//! plane that faces it, d metres away, with I/d².
//!
//! [KHR_lights_punctual]: https://github.com/KhronosGroup/glTF/tree/main/extensions/2.0/Khronos/KHR_lights_punctual

use crate::error::{Error, Result};
use crate::math::lanes::{F32s, Isa, Vec3s};
use crate::math::{DVec3, Vec3};
use std::f32::consts::FRAC_PI_2;

/// Points nearer to a light than this, m, are lit as at this distance: nothing is infinitely bright.
pub const NEAREST_M: f32 = 1e-6;

/// Least difference between the cosines of a cone's edges.
///
/// The extension's reference code has 0.001, with which a cone narrower than 2.6° would nowhere reach the "brightness inside the
/// innerConeAngle" that its text promises.
const LEAST_EDGE: f32 = 1e-6;

/// A light of any kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Light {
    /// From infinitely far away.
    Directional(Directional),
    /// From a point, the same into all directions.
    Point(Point),
    /// From a point, in a cone.
    Spot(Spot),
}

/// A light from infinitely far away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Directional {
    /// Unit vector towards the light.
    pub to_light: Vec3,
    /// Irradiance on a plane at a right angle to it, linear RGB.
    pub irradiance: Vec3,
}

/// A light from a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Position, m, relative to the same origin as the scene ([`InWorld::relative_to`]).
    pub position_m: Vec3,
    /// Irradiance × m², linear RGB.
    pub intensity: Vec3,
    /// Distance at which it ends, m; none where it goes on for ever.
    pub range_m: Option<f32>,
}

/// A light from a point, brightest within a cone and fading to the edge of a wider one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Where it is and how bright it is along its axis.
    pub point: Point,
    /// Unit vector along the axis, away from the light.
    pub direction: Vec3,
    /// Cosine of the angle between the axis and where the light begins to fade.
    pub inner_cos: f32,
    /// Cosine of the angle from which on there is none of it, below `inner_cos`.
    pub outer_cos: f32,
}

/// A light as a command line or an asset places it.
///
/// Worlds may be large, so the place is kept in f64, and positions in `light` are relative to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InWorld {
    /// What the positions in `light` are relative to, m, world coordinates.
    pub place_m: DVec3,
    /// The light.
    pub light: Light,
}

impl Light {
    /// What arrives at `p`, m: the unit vector to the light, and the irradiance on a plane at a right angle to it.
    #[inline]
    pub fn at(&self, p: Vec3) -> Directional {
        match self {
            Self::Directional(light) => *light,
            Self::Point(point) => point.at(p),
            Self::Spot(spot) => spot.at(p),
        }
    }

    /// [`Self::at`] in lanes: unit vectors to the light, and irradiances.
    #[inline(always)]
    pub fn at_lanes<I: Isa>(&self, p: Vec3s<I>) -> (Vec3s<I>, Vec3s<I>) {
        match self {
            Self::Directional(light) => (Vec3s::splat(light.to_light), Vec3s::splat(light.irradiance)),
            Self::Point(point) => point.at_lanes(p),
            Self::Spot(spot) => spot.at_lanes(p),
        }
    }

    /// Where it is, m; none where it is infinitely far away.
    pub fn position_m(&self) -> Option<Vec3> {
        match self {
            Self::Directional(_) => None,
            Self::Point(point) | Self::Spot(Spot { point, .. }) => Some(point.position_m),
        }
    }
}

impl From<Directional> for Light {
    fn from(light: Directional) -> Self {
        Self::Directional(light)
    }
}

impl From<Point> for Light {
    fn from(light: Point) -> Self {
        Self::Point(light)
    }
}

impl From<Spot> for Light {
    fn from(light: Spot) -> Self {
        Self::Spot(light)
    }
}

impl Directional {
    /// From the direction in which the light travels, of any length.
    ///
    /// # Errors
    /// Names a zero or non-finite direction, or an irradiance that is negative or not finite.
    pub fn travelling(direction: Vec3, irradiance: Vec3) -> Result<Self> {
        Ok(Self { to_light: -unit(direction)?, irradiance: checked(irradiance, "irradiance")? })
    }
}

impl Point {
    /// At a position, with an intensity and perhaps a range.
    ///
    /// # Errors
    /// Names a position that is not finite, an intensity that is negative or not finite, or a range that is not above 0.
    pub fn new(position_m: Vec3, intensity: Vec3, range_m: Option<f32>) -> Result<Self> {
        if !position_m.is_finite() {
            return Err(Error::usage("a light needs a place")
                .with_field("position")
                .with_found(position_m)
                .with_expected("three finite numbers"));
        }
        // "Must be > 0. When undefined, range is assumed to be infinite."
        if let Some(range_m) = range_m.filter(|&range_m| !(range_m > 0.0 && range_m.is_finite())) {
            return Err(Error::usage("a light cannot end there")
                .with_field("range")
                .with_found(range_m)
                .with_expected("a distance above 0, or none"));
        }
        Ok(Self { position_m, intensity: checked(intensity, "intensity")?, range_m })
    }

    fn at(&self, p: Vec3) -> Directional {
        let to = self.position_m - p;
        let length_m = to.length();
        let distance_m = length_m.max(NEAREST_M);
        let to_light = if length_m > NEAREST_M { to / distance_m } else { Vec3::Y };
        Directional { to_light, irradiance: self.intensity * self.attenuation(distance_m) }
    }

    /// Range attenuation: "max( min( 1.0 - ( current_distance / range )^4, 1 ), 0 ) / current_distance^2".
    fn attenuation(&self, distance_m: f32) -> f32 {
        let share = distance_m * self.per_range();
        (1.0 - share * share * share * share).clamp(0.0, 1.0) / (distance_m * distance_m)
    }

    /// 1 over the range, 1/m; 0 where there is none.
    pub fn per_range(&self) -> f32 {
        self.range_m.map_or(0.0, |range_m| 1.0 / range_m)
    }

    #[inline(always)]
    fn at_lanes<I: Isa>(&self, p: Vec3s<I>) -> (Vec3s<I>, Vec3s<I>) {
        let nearest_m = F32s::splat(NEAREST_M);
        let to = Vec3s::splat(self.position_m) - p;
        let length_m = to.length();
        let distance_m = length_m.max(nearest_m);
        let to_light = to.over(distance_m).select(length_m.gt(nearest_m), Vec3s::splat(Vec3::Y));
        let share = distance_m * self.per_range();
        let window = (F32s::splat(1.0) - share * share * share * share).within(0.0, 1.0);
        (to_light, Vec3s::splat(self.intensity) * (window / (distance_m * distance_m)))
    }
}

impl Spot {
    /// From a point along `direction`, of any length, fading between two angles from the axis.
    ///
    /// # Errors
    /// Names a zero or non-finite direction, or angles that are not in 0 ≤ inner < outer ≤ π/2.
    pub fn new(point: Point, direction: Vec3, inner_rad: f32, outer_rad: f32) -> Result<Self> {
        let direction = unit(direction)?;
        // innerConeAngle "must be greater than or equal to 0 and less than outerConeAngle", which "must be greater than
        // innerConeAngle and less than or equal to PI / 2.0".
        if !(0.0 <= inner_rad && inner_rad < outer_rad && outer_rad <= FRAC_PI_2) {
            return Err(Error::usage("there is no such cone of light")
                .with_field("inner and outer angle")
                .with_found(format!("{inner_rad} and {outer_rad} rad"))
                .with_expected("0 or more, and between that and a right angle"));
        }
        Ok(Self { point, direction, inner_cos: libm::cosf(inner_rad), outer_cos: libm::cosf(outer_rad) })
    }

    fn at(&self, p: Vec3) -> Directional {
        let Directional { to_light, irradiance } = self.point.at(p);
        let [scale, offset] = self.cone();
        let share = (-to_light.dot(self.direction) * scale + offset).clamp(0.0, 1.0);
        Directional { to_light, irradiance: irradiance * (share * share) }
    }

    /// What a cosine to the axis is multiplied by and what is added, for a number whose square is the cone's share of light:
    /// lightAngleScale = 1 / (cos(innerConeAngle) − cos(outerConeAngle)) and "lightAngleOffset = -cos(outerConeAngle) *
    /// lightAngleScale".
    pub fn cone(&self) -> [f32; 2] {
        let scale = 1.0 / (self.inner_cos - self.outer_cos).max(LEAST_EDGE);
        [scale, -self.outer_cos * scale]
    }

    #[inline(always)]
    fn at_lanes<I: Isa>(&self, p: Vec3s<I>) -> (Vec3s<I>, Vec3s<I>) {
        let (to_light, irradiance) = self.point.at_lanes(p);
        let [scale, offset] = self.cone();
        let share = (to_light.dot(Vec3s::splat(-self.direction)) * scale + offset).within(0.0, 1.0);
        (to_light, irradiance * (share * share))
    }
}

impl InWorld {
    /// A light from infinitely far away, which is the same everywhere.
    pub fn directional(light: Directional) -> Self {
        Self { place_m: DVec3::ZERO, light: light.into() }
    }

    /// The light with positions relative to `origin_m`, as the scene's are: the difference is taken in f64.
    ///
    /// # Errors
    /// Names a position that is not finite or too far from the scene for single precision.
    pub fn relative_to(&self, origin_m: DVec3) -> Result<Light> {
        let by_m = self.place_m - origin_m;
        let moved =
            |point: Point| Point::new((by_m + point.position_m.as_dvec3()).as_vec3(), point.intensity, point.range_m);
        Ok(match self.light {
            Light::Directional(light) => light.into(),
            Light::Point(point) => moved(point)?.into(),
            Light::Spot(spot) => Spot { point: moved(spot.point)?, ..spot }.into(),
        })
    }
}

/// A direction of length 1.
fn unit(direction: Vec3) -> Result<Vec3> {
    let unit = direction.normalize_or_zero();
    if unit == Vec3::ZERO || !direction.is_finite() {
        return Err(Error::usage("a light needs a direction")
            .with_field("direction")
            .with_found(direction)
            .with_expected("three finite numbers, not all zero"));
    }
    Ok(unit)
}

/// A colour that gives light.
fn checked(colour: Vec3, field: &str) -> Result<Vec3> {
    if !colour.is_finite() || colour.min_element() < 0.0 {
        return Err(Error::usage("a light cannot take light away")
            .with_field(field)
            .with_found(colour)
            .with_expected("three finite numbers, none negative"));
    }
    Ok(colour)
}

/// Luminance of linear sRGB primaries (Rec. 709).
pub fn luminance(colour: Vec3) -> f32 {
    colour.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}
