//! An eight-bit picture to PNG.

use crate::data::image::Image8;
use crate::error::{Error, Kind, Result};
use image::ImageEncoder;

/// Encodes an RGBA8 picture.
///
/// # Errors
/// Where the picture is too large for the format.
pub fn encode(image: &Image8) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    image::codecs::png::PngEncoder::new(&mut bytes)
        .write_image(&image.pixels, image.width, image.height, image::ExtendedColorType::Rgba8)
        .map_err(|e| Error::new(Kind::Output, "the picture cannot be encoded as PNG").with_found(e))?;
    Ok(bytes)
}
