//! A film to an eight-bit picture.

use crate::data::film::Film;
use crate::data::image::{Image8, srgb_from_linear, unorm8};
use crate::math::Vec3;
use rayon::prelude::*;

/// How light becomes a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Development {
    /// Factor on radiance, as a power of two.
    pub exposure_ev: f32,
    /// Radiance, after exposure, that becomes white; light is rolled off below it.
    pub white: f32,
    /// Linear colour behind the picture; none keeps its alpha.
    pub background: Option<Vec3>,
}

impl Default for Development {
    fn default() -> Self {
        Self { exposure_ev: 0.0, white: 4.0, background: None }
    }
}

/// Pixels that a thread takes on at least.
const PIXELS_AT_ONCE: usize = 1 << 12;

/// Develops to RGBA8: sRGB coding, straight alpha.
///
/// Tones follow Reinhard et al. 2002, equation (4), on the largest channel, so that hues stay.
pub fn develop(film: &Film, development: &Development) -> Image8 {
    let mut image = Image8::new(film.width as u32, film.height as u32, 4);
    let scale = libm::exp2f(development.exposure_ev);
    let white2 = development.white * development.white;
    let pixels = image.pixels.par_chunks_exact_mut(4).zip(&film.radiance).zip(&film.alpha);
    pixels.with_min_len(PIXELS_AT_ONCE).for_each(|((out, &radiance), &alpha)| {
        let (light, alpha) = match development.background {
            Some(behind) => (radiance * scale + behind * (1.0 - alpha), 1.0),
            None => (radiance * scale / alpha.max(1e-6), alpha),
        };
        let most = light.max_element().max(0.0);
        let toned = light.max(Vec3::ZERO) * ((1.0 + most / white2) / (1.0 + most));
        for (byte, value) in out.iter_mut().zip(toned.to_array()) {
            *byte = unorm8(srgb_from_linear(value.clamp(0.0, 1.0)));
        }
        out[3] = unorm8(alpha);
    });
    image
}
