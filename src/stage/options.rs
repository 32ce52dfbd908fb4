//! What a picture was asked to be taken with, whoever asks and whoever draws.

use super::camera::Viewpoint;
use super::environment::Environment;
use super::light::{Asked, Lit, studio};
use super::tone::Development;
use crate::data::camera::Camera;
use crate::data::light::Light;
use crate::data::subject::Subject;
use crate::error::{Error, Result};
use crate::math::Vec3;

/// Lights that a picture with an environment has, the given ones counted (Andersen et al. 2016 §5).
pub const ENVIRONMENT_LIGHTS: usize = 16;

/// Camera, light and development.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Pixels: width, height.
    pub size: [u32; 2],
    /// From where.
    pub viewpoint: Viewpoint,
    /// Lights; without any and without an environment, the studio's.
    pub lights: Vec<Asked>,
    /// Radiance from everywhere, linear RGB; `None` means the studio's, or none where there are other lights.
    pub ambient: Option<Vec3>,
    /// A map of surrounding light.
    pub environment: Option<Environment>,
    /// Whether the environment's light falls on undercoat too.
    pub environment_on_undercoat: bool,
    /// From light to a picture of eight bits.
    pub development: Development,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            size: [1024, 1024],
            viewpoint: Viewpoint::default(),
            lights: Vec::new(),
            ambient: None,
            environment: None,
            environment_on_undercoat: false,
            development: Development::default(),
        }
    }
}

impl Options {
    /// Width over height.
    pub fn aspect(&self) -> f64 {
        f64::from(self.size[0].max(1)) / f64::from(self.size[1].max(1))
    }

    /// The camera for a picture of `subject`.
    ///
    /// # Errors
    /// As [`Viewpoint::camera`].
    pub fn camera(&self, subject: &Subject) -> Result<Camera> {
        self.viewpoint.camera(subject, self.aspect())
    }

    /// The lights of a picture of `subject` by `camera`: those given in their order, then those that stand for the
    /// environment, the strongest first.
    ///
    /// # Errors
    /// As [`Asked::light`]; [`crate::error::Kind::Usage`] where given lights leave none to the environment.
    pub fn lit(&self, subject: &Subject, camera: &Camera) -> Result<Lit> {
        let mut lights: Vec<Light> = self.lights.iter().map(|asked| asked.light(subject)).collect::<Result<_>>()?;
        if let Some(environment) = &self.environment {
            let left = ENVIRONMENT_LIGHTS.saturating_sub(lights.len());
            if left == 0 {
                return Err(Error::usage("the lights leave none to the environment")
                    .with_parameter("light")
                    .with_found(lights.len())
                    .with_expected(format!("at most {} beside `env`", ENVIRONMENT_LIGHTS - 1)));
            }
            let mut surrounding = environment.median_cut(left);
            surrounding.sort_by(|a, b| b.irradiance.element_sum().total_cmp(&a.irradiance.element_sum()));
            lights.extend(surrounding.into_iter().map(Light::from));
        }
        let mut lit = match (lights.is_empty(), &self.environment) {
            (true, None) => studio(camera),
            _ => Lit { lights, ambient: Vec3::ZERO, fill_on_undercoat: self.environment_on_undercoat },
        };
        lit.ambient = self.ambient.unwrap_or(lit.ambient);
        Ok(lit)
    }
}
