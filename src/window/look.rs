//! How the model is looked at: all that a picture depends on beside the model.

use super::lighting::Lighting;
use crate::data::camera::Camera;
use crate::data::film::Film;
use crate::data::image::Image8;
use crate::math::Vec3;
use crate::runtime::Blending;
use crate::stage::tone::{self, Development};
use crate::viewer::{Combing, Shown};
use rayon::prelude::*;

/// A moment of an animation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// Which animation.
    pub animation: usize,
    /// Seconds into it.
    pub seconds: f64,
}

/// What a picture is taken with.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    /// From where.
    pub camera: Camera,
    /// Pixels: width, height.
    pub size: [u32; 2],
    /// In which light.
    pub lighting: Lighting,
    /// How light becomes colours.
    pub development: Development,
    /// What is drawn.
    pub shown: Shown,
    /// Level of detail; none to choose by size.
    pub level: Option<usize>,
    /// How the coat is combed anew.
    pub combing: Combing,
    /// How shells and fins come together in a pixel.
    pub blend: Blending,
    /// Of an animation; none in the rest pose.
    pub moment: Option<Moment>,
}

impl Look {
    /// Light as eight bits, before what lies behind the asset.
    pub fn developed(&self, mut film: Film) -> Image8 {
        self.put_sky_behind(&mut film);
        tone::develop(&film, &self.development)
    }

    /// Lays the film over the map of surrounding light, where that is seen.
    fn put_sky_behind(&self, film: &mut Film) {
        if self.lighting.behind(Vec3::NEG_Z).is_none() {
            return;
        }
        let [right, up, back] = self.camera.axes().map(|axis| axis.as_vec3());
        let slope = (0.5 * self.camera.vfov_deg.to_radians()).tan() as f32;
        let (width, height) = (film.width, film.height);
        let rows = film.radiance.par_chunks_mut(width).zip(film.alpha.par_chunks_mut(width)).enumerate();
        rows.for_each(|(y, (radiance, alpha))| {
            for (x, (light, alpha)) in radiance.iter_mut().zip(alpha).enumerate() {
                let across = (2.0 * x as f32 + 1.0 - width as f32) / height as f32;
                let upward = 1.0 - (2.0 * y as f32 + 1.0) / height as f32;
                let towards = right * (across * slope) + up * (upward * slope) - back;
                *light += self.lighting.behind(towards).unwrap_or_default() * (1.0 - alpha.clamp(0.0, 1.0));
                *alpha = 1.0;
            }
        });
    }
}
