//! Basis Universal textures in KTX2 files, as KHR_texture_basisu has them.

use crate::data::image::Image8;
use basisu::{DecodeFlags, Error, TargetFormat, Transcoder};

/// How every KTX2 file begins.
const MAGIC: [u8; 12] = *b"\xABKTX 20\xBB\r\n\x1A\n";

/// Whether `bytes` claim to be KTX2.
pub fn is_ktx2(bytes: &[u8]) -> bool {
    bytes.starts_with(&MAGIC)
}

/// Width and height of the texture.
///
/// # Errors
/// Says why it cannot be read.
pub fn size(bytes: &[u8]) -> Result<[u32; 2], String> {
    let (width, height) = open(bytes)?.base_dimensions();
    Ok([width, height])
}

/// Its finest level as RGBA.
///
/// # Errors
/// Says why it cannot be read.
pub fn decode(bytes: &[u8]) -> Result<Image8, String> {
    let texture = open(bytes)?;
    let (width, height) = texture.base_dimensions();
    let pixels = texture.transcode(0, TargetFormat::Rgba32, DecodeFlags::NONE).map_err(told)?;
    if pixels.len() as u64 != 4 * u64::from(width) * u64::from(height) {
        return Err(format!("{} bytes for {width} × {height} pixels", pixels.len()));
    }
    Ok(Image8 { width, height, channels: 4, pixels })
}

fn open(bytes: &[u8]) -> Result<Transcoder<'_>, String> {
    let texture = Transcoder::new(bytes).map_err(told)?;
    if !texture.supports(TargetFormat::Rgba32) {
        return Err(format!("{:?} has no eight bits per channel", texture.source_format()));
    }
    Ok(texture)
}

fn told(error: Error) -> String {
    match error {
        Error::InvalidData | Error::Truncated => "it is cut, or holds no Basis Universal data".to_owned(),
        other => format!("{other:?}"),
    }
}
