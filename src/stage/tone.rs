//! A film to an eight-bit picture.

use super::background::Background;
use crate::data::film::Film;
use crate::data::image::{Image8, srgb_from_linear, unorm8};
use crate::math::Vec3;
use rayon::prelude::*;

/// How light that is too bright for a picture is brought into it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tone {
    /// Colours stay as they are up to 0.7; what is brighter rolls off towards white (the curve of Khronos PBR Neutral 2024:
    /// hyperbolic in the largest channel, desaturating as it saturates).
    #[default]
    Neutral,
    /// What is above 1 is cut off.
    None,
}

/// How light becomes a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Development {
    /// Factor on radiance, as a power of two.
    pub exposure_ev: f32,
    /// What happens to light that is too bright.
    pub tone: Tone,
    /// What is behind the asset.
    pub background: Background,
}

/// Pixels that a thread takes on at least.
const PIXELS_AT_ONCE: usize = 1 << 12;

/// Develops to RGBA8: sRGB coding, straight alpha.
pub fn develop(film: &Film, development: &Development) -> Image8 {
    let mut image = Image8::new(film.width as u32, film.height as u32, 4);
    let scale = libm::exp2f(development.exposure_ev);
    let pixels = image.pixels.par_chunks_exact_mut(4).zip(&film.radiance).zip(&film.alpha).enumerate();
    pixels.with_min_len(PIXELS_AT_ONCE).for_each(|(i, ((out, &radiance), &alpha))| {
        let alpha = alpha.clamp(0.0, 1.0);
        // Tones are mapped straight, so that thin hair keeps the hue of thick hair.
        let light = if alpha > 0.0 { radiance * (scale / alpha) } else { Vec3::ZERO };
        let straight = development.tone.map(light);
        let (colour, alpha) = match development.background.behind(i / film.width, film.height) {
            Some(behind) => (straight * alpha + behind * (1.0 - alpha), 1.0),
            None => (straight, alpha),
        };
        for (byte, value) in out.iter_mut().zip(colour.to_array()) {
            *byte = unorm8(srgb_from_linear(value.clamp(0.0, 1.0)));
        }
        out[3] = unorm8(alpha);
    });
    image
}

impl Tone {
    fn map(self, light: Vec3) -> Vec3 {
        const START: f32 = 0.7;
        const DESATURATION: f32 = 0.15;
        let light = light.max(Vec3::ZERO);
        let peak = light.max_element();
        if self == Self::None || peak <= START {
            return light.min(Vec3::ONE);
        }
        let room = 1.0 - START;
        let new_peak = 1.0 - room * room / (peak + room - START);
        let white = 1.0 - 1.0 / (DESATURATION * (peak - new_peak) + 1.0);
        (light * (new_peak / peak)).lerp(Vec3::splat(new_peak), white)
    }
}
