//! The light on the asset, and the sky behind it.

use crate::data::camera::Camera;
use crate::data::light::Light;
use crate::data::subject::Subject;
use crate::error::Result;
use crate::math::{Quat, Vec3};
use crate::stage::environment::Environment;
use crate::stage::light::Lit;
use crate::stage::options::{ENVIRONMENT_LIGHTS, Options};
use crate::stage::rig::Rig;
use std::path::Path;
use std::sync::Arc;

/// A map of surrounding light, and the lights that stand for it.
#[derive(Debug)]
pub struct Surroundings {
    /// What it is called: its file's name.
    pub name: String,
    map: Environment,
    lights: Vec<Light>,
}

impl Surroundings {
    /// Reads a map.
    ///
    /// # Errors
    /// As [`Environment::read`].
    pub fn read(path: &Path) -> Result<Self> {
        let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
        Ok(Self::new(name, Environment::read(path)?))
    }

    /// A map under a name.
    pub fn new(name: String, map: Environment) -> Self {
        let mut lights = map.median_cut(ENVIRONMENT_LIGHTS);
        lights.sort_by(|a, b| b.irradiance.element_sum().total_cmp(&a.irradiance.element_sum()));
        Self { name, map, lights: lights.into_iter().map(Light::from).collect() }
    }

    /// Radiance that comes from a direction, linear RGB.
    pub fn radiance(&self, towards: Vec3) -> Vec3 {
        let d = towards.normalize_or(Vec3::NEG_Z);
        let (width, height) = (self.map.width as f32, self.map.height as f32);
        let x = (d.x.atan2(-d.z) / std::f32::consts::TAU + 0.5) * width - 0.5;
        let y = d.y.clamp(-1.0, 1.0).acos() / std::f32::consts::PI * height - 0.5;
        let at = |column: f32, row: f32| {
            let column = (column as i64).rem_euclid(self.map.width as i64) as usize;
            let row = (row as i64).clamp(0, self.map.height as i64 - 1) as usize;
            self.map.radiance[row * self.map.width + column]
        };
        let (left, above) = (x.floor(), y.floor());
        let row = |row: f32| at(left, row).lerp(at(left + 1.0, row), x - left);
        row(above).lerp(row(above + 1.0), y - above)
    }
}

/// Which light falls on the asset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// The lights that the command line asked for, else the studio's.
    Asked,
    /// Of a rig, which turns with the camera.
    Rig(Rig),
    /// The map of surrounding light.
    Surroundings,
}

/// The light on the asset.
#[derive(Clone, Debug)]
pub struct Lighting {
    /// Which.
    pub source: Source,
    /// What the command line asked for.
    pub asked: Options,
    /// A map, where there is one.
    pub surroundings: Option<Arc<Surroundings>>,
    /// Whether the map is seen behind the asset.
    pub sky: bool,
    /// How far all lights are turned about the vertical, degrees.
    pub turn_deg: f32,
    /// How far they are raised, degrees.
    pub raise_deg: f32,
    /// Factor on all light, as a power of two.
    pub stops: f32,
    /// Whether the first light casts the shadow of one limb on another.
    pub shadow: bool,
}

impl PartialEq for Lighting {
    /// The same light: a map is the same where it is the same in memory.
    fn eq(&self, other: &Self) -> bool {
        let place = |lighting: &Self| lighting.surroundings.as_ref().map(Arc::as_ptr);
        let numbers = |l: &Self| (l.source, l.sky, l.turn_deg, l.raise_deg, l.stops, l.shadow);
        place(self) == place(other) && numbers(self) == numbers(other) && self.asked.lights == other.asked.lights
    }
}

impl Lighting {
    /// As the command line asked.
    pub fn new(asked: Options) -> Self {
        let surroundings = asked
            .environment
            .clone()
            .map(|environment| Arc::new(Surroundings::new("as asked for".to_owned(), environment)));
        let source = if surroundings.is_some() { Source::Surroundings } else { Source::Asked };
        Self { source, surroundings, asked, sky: true, turn_deg: 0.0, raise_deg: 0.0, stops: 0.0, shadow: true }
    }

    /// What falls on `subject` before `camera`.
    ///
    /// # Errors
    /// As [`Options::lit`].
    pub fn lit(&self, subject: &Subject, camera: &Camera) -> Result<Lit> {
        let mut lit = match (self.source, &self.surroundings) {
            (Source::Rig(rig), _) => rig.lit(camera),
            (Source::Surroundings, Some(surroundings)) => Lit {
                lights: surroundings.lights.clone(),
                ambient: Vec3::ZERO,
                fill_on_undercoat: self.asked.environment_on_undercoat,
            },
            _ => Options { environment: None, ..self.asked.clone() }.lit(subject, camera)?,
        };
        let factor = libm::exp2f(self.stops);
        let turn = self.rotation(camera);
        lit.lights.iter_mut().for_each(|light| *light = turned(light, turn, factor));
        lit.ambient *= factor;
        Ok(lit)
    }

    /// What is seen behind the asset in a direction, linear RGB; none where there is no sky.
    pub fn behind(&self, towards: Vec3) -> Option<Vec3> {
        let surroundings = self.surroundings.as_ref().filter(|_| self.sky && self.source == Source::Surroundings)?;
        let back = Quat::from_rotation_y(-self.turn_deg.to_radians());
        Some(surroundings.radiance(back * towards) * libm::exp2f(self.stops))
    }

    /// About the vertical, then up or down about the picture's horizontal; the sky is not raised.
    fn rotation(&self, camera: &Camera) -> Quat {
        let turn = Quat::from_rotation_y(self.turn_deg.to_radians());
        if self.source == Source::Surroundings {
            return turn;
        }
        let right = camera.axes()[0].as_vec3();
        Quat::from_axis_angle(right, -self.raise_deg.to_radians()) * turn
    }
}

fn turned(light: &Light, turn: Quat, factor: f32) -> Light {
    let mut light = *light;
    match &mut light {
        Light::Directional(light) => {
            light.to_light = (turn * light.to_light).normalize();
            light.irradiance *= factor;
        }
        Light::Point(light) => {
            light.position_m = turn * light.position_m;
            light.intensity *= factor;
        }
        Light::Spot(light) => {
            light.point.position_m = turn * light.point.position_m;
            light.point.intensity *= factor;
            light.direction = (turn * light.direction).normalize();
        }
    }
    light
}
