//! Eight-bit images, as they come from and go to files.

use serde::{Deserialize, Serialize};
use std::sync::LazyLock;

/// Pixels in rows from the top, `channels` bytes each. Transfer function and meaning are the owner's.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Image8 {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Bytes per pixel: 1 or 4.
    pub channels: u32,
    /// `width * height * channels` bytes.
    #[serde(with = "serde_bytes")]
    pub pixels: Vec<u8>,
}

impl Image8 {
    /// An image of zeros.
    pub fn new(width: u32, height: u32, channels: u32) -> Self {
        let len = width as usize * height as usize * channels as usize;
        Self { width, height, channels, pixels: vec![0; len] }
    }

    /// The bytes of pixel (x, y).
    pub fn pixel(&self, x: u32, y: u32) -> &[u8] {
        let start = (y as usize * self.width as usize + x as usize) * self.channels as usize;
        &self.pixels[start..start + self.channels as usize]
    }
}

/// One sRGB-coded value in [0, 1] to linear (IEC 61966-2-1).
pub fn linear_from_srgb(value: f32) -> f32 {
    if value <= 0.040_45 { value / 12.92 } else { libm::powf((value + 0.055) / 1.055, 2.4) }
}

/// The same of a byte.
pub fn linear_from_srgb8(byte: u8) -> f32 {
    static TABLE: LazyLock<[f32; 256]> =
        LazyLock::new(|| std::array::from_fn(|byte| linear_from_srgb(byte as f32 / 255.0)));
    TABLE[usize::from(byte)]
}

/// One linear value in [0, 1] to sRGB coding (IEC 61966-2-1).
pub fn srgb_from_linear(value: f32) -> f32 {
    if value <= 0.003_130_8 { value * 12.92 } else { 1.055 * libm::powf(value, 1.0 / 2.4) - 0.055 }
}

/// [0, 1] to a byte, rounded; NaN becomes 0.
pub fn unorm8(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}
