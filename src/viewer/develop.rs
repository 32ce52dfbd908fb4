//! Linear light to an eight-bit picture.

use crate::data::image::{Image8, srgb_from_linear, unorm8};
use crate::math::Vec3;
use crate::runtime::Picture;

/// Backdrop at the top and at the bottom, linear RGB, after tone mapping.
const BACKDROP: [Vec3; 2] = [Vec3::new(0.34, 0.37, 0.41), Vec3::new(0.66, 0.67, 0.68)];

/// What is behind the asset.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Background {
    /// A grey wall, lighter below.
    #[default]
    Backdrop,
    /// Nothing: the picture keeps its alpha.
    Transparent,
}

/// Tone maps, puts the picture before its background and codes it as RGBA8 sRGB.
pub fn develop(picture: &Picture, background: Background) -> Image8 {
    let [width, height] = picture.size;
    let mut image = Image8::new(width, height, 4);
    for (i, pixel) in picture.pixels.iter().enumerate() {
        let alpha = pixel[3].clamp(0.0, 1.0);
        let light = Vec3::new(pixel[0], pixel[1], pixel[2]);
        // Tones are mapped straight, so that thin hair keeps the hue of thick hair.
        let straight = tone(if alpha > 0.0 { light / alpha } else { Vec3::ZERO });
        let (colour, alpha) = match background {
            Background::Transparent => (straight, alpha),
            Background::Backdrop => {
                let down = (i as u32 / width) as f32 / height.max(2) as f32;
                (straight * alpha + BACKDROP[0].lerp(BACKDROP[1], down) * (1.0 - alpha), 1.0)
            }
        };
        let bytes = colour.to_array().map(|c| unorm8(srgb_from_linear(c.clamp(0.0, 1.0))));
        image.pixels[4 * i..4 * i + 3].copy_from_slice(&bytes);
        image.pixels[4 * i + 3] = unorm8(alpha);
    }
    image
}

/// Keeps colours as they are up to 0.7 and rolls what is brighter off towards white (the curve of Khronos PBR Neutral 2024:
/// hyperbolic in the largest channel, desaturating as it saturates).
fn tone(light: Vec3) -> Vec3 {
    const START: f32 = 0.7;
    const DESATURATION: f32 = 0.15;
    let light = light.max(Vec3::ZERO);
    let peak = light.max_element();
    if peak <= START {
        return light;
    }
    let room = 1.0 - START;
    let new_peak = 1.0 - room * room / (peak + room - START);
    let white = 1.0 - 1.0 / (DESATURATION * (peak - new_peak) + 1.0);
    (light * (new_peak / peak)).lerp(Vec3::splat(new_peak), white)
}
