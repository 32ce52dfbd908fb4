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

/// Most bytes that a level may say that it decompresses to: what the largest image holds that is decoded.
const MAX_LEVEL_BYTES: u64 = 1 << 28;
/// Where the number of levels stands in the header, where their index begins, and how far apart its entries are, bytes.
const LEVELS: [usize; 3] = [40, 80, 24];

fn open(bytes: &[u8]) -> Result<Transcoder<'_>, String> {
    // The decoder trusts a level's place, and makes room for whatever it claims.
    let [count_at, index_at, step] = LEVELS;
    let long = |at: usize| bytes.get(at..at + 8).and_then(|b| b.try_into().ok()).map_or(0, u64::from_le_bytes);
    for level in 0..(long(count_at) as u32).clamp(1, 32) as usize {
        let [offset, length, claimed] = [0, 8, 16].map(|field| long(index_at + level * step + field));
        if offset.checked_add(length).is_none_or(|end| end > bytes.len() as u64) {
            return Err(format!("level {level} reaches beyond its end"));
        }
        if claimed > MAX_LEVEL_BYTES {
            return Err(format!("level {level} claims {claimed} bytes"));
        }
    }
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
