//! Pictures from files.

use super::LinearImage;
use crate::data::image::linear_from_srgb;
use crate::error::{Error, Result};
use crate::math::Vec3;
use std::path::Path;

/// Longest edge that is read, pixels.
const MAX_EDGE: u32 = 16_384;

/// Reads a `.png` (sRGB, straight alpha, 8 or 16 bits) or an `.exr` (first layer with R, G, B; linear, premultiplied).
///
/// # Errors
/// [`crate::error::Kind::Input`] naming the file where it is missing, of another kind, broken or larger than 16384 pixels.
pub fn load(path: &Path) -> Result<LinearImage> {
    let extension = path.extension().and_then(|e| e.to_str()).map(str::to_lowercase);
    match extension.as_deref() {
        Some("png") => load_png(path),
        Some("exr") => load_exr(path),
        _ => Err(Error::input("this kind of picture is not read").with_expected("a .png or .exr file")),
    }
    .map_err(|error| error.with_file(path))
}

fn broken(error: impl std::fmt::Display) -> Error {
    Error::input("the picture cannot be read").with_found(error)
}

fn load_png(path: &Path) -> Result<LinearImage> {
    let mut reader = image::ImageReader::open(path).map_err(broken)?.with_guessed_format().map_err(broken)?;
    let mut limits = image::Limits::default();
    limits.max_image_width = Some(MAX_EDGE);
    limits.max_image_height = Some(MAX_EDGE);
    reader.limits(limits);
    let pixels = reader.decode().map_err(broken)?.into_rgba32f();
    let (width, height) = (pixels.width() as usize, pixels.height() as usize);
    let of = |p: &image::Rgba<f32>| Vec3::new(p[0], p[1], p[2]).map(linear_from_srgb) * p[3];
    Ok(LinearImage {
        width,
        height,
        colour: pixels.pixels().map(of).collect(),
        alpha: pixels.pixels().map(|p| p[3]).collect(),
    })
}

fn load_exr(path: &Path) -> Result<LinearImage> {
    let meta = exr::meta::MetaData::read_from_file(path, false).map_err(broken)?;
    if let Some(size) = meta.headers.iter().map(|h| h.layer_size).find(|s| s.0.max(s.1) > MAX_EDGE as usize) {
        return Err(Error::input("the picture is too large")
            .with_field("data window")
            .with_found(format!("{} x {}", size.0, size.1))
            .with_expected(format!("at most {MAX_EDGE} pixels along an edge")));
    }
    let image = exr::prelude::read_first_rgba_layer_from_file(
        path,
        |size: exr::math::Vec2<usize>, _| LinearImage {
            width: size.0,
            height: size.1,
            colour: vec![Vec3::ZERO; size.0 * size.1],
            alpha: vec![1.0; size.0 * size.1],
        },
        |light: &mut LinearImage, at: exr::math::Vec2<usize>, (r, g, b, a): (f32, f32, f32, f32)| {
            let i = at.1 * light.width + at.0;
            light.colour[i] = Vec3::new(r, g, b);
            light.alpha[i] = a;
        },
    )
    .map_err(broken)?;
    Ok(image.layer_data.channel_data.pixels)
}
