//! The coat against the hair that it stands for: how far off, pixel by pixel, and in which colours that is shown.

use crate::data::film::Film;
use crate::data::image::{Image8, srgb_from_linear, unorm8};
use crate::error::Result;
use crate::math::Vec3;
use crate::metrics::compare::{Difference, LinearImage, compare_mapped};
use crate::metrics::likeness::{self, Likeness};
use std::sync::Arc;

/// How the two pictures are laid beside each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// The coat alone.
    #[default]
    Off,
    /// The hair left of a line, the coat right of it.
    Wipe,
    /// One at a time.
    Flip,
    /// Both, side by side.
    Side,
    /// The error map.
    Error,
}

impl Mode {
    /// All there are, with their names.
    pub const ALL: [(&'static str, Self); 5] = [
        ("coat alone", Self::Off),
        ("wipe", Self::Wipe),
        ("flip", Self::Flip),
        ("side by side", Self::Side),
        ("error map", Self::Error),
    ];
}

/// What the person decides about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// How.
    pub mode: Mode,
    /// Where the line of a wipe is, of the picture's width.
    pub wipe: f32,
    /// Whether the hair is shown now, of the two that take turns.
    pub hair: bool,
}

impl Default for Comparison {
    fn default() -> Self {
        Self { mode: Mode::Off, wipe: 0.5, hair: true }
    }
}

/// How far a picture of the coat is from one of the hair.
pub struct Judged {
    /// The picture of the hair that it is about.
    pub film: Arc<Film>,
    /// The picture of the coat.
    pub coat: Film,
    /// LDR-FLIP pixel by pixel, rows from the top.
    pub flip: Vec<f32>,
    /// Its colours.
    pub image: Image8,
    /// As `furrier compare` says.
    pub difference: Difference,
    /// As `furrier report coat` says; none where nothing lit is seen.
    pub likeness: Option<Likeness>,
}

impl Judged {
    /// Compares `coat` with `hair`, which has a fringe so wide.
    ///
    /// # Errors
    /// As [`compare_mapped`].
    pub fn new(hair: Arc<Film>, coat: Film, fringe_px: f32) -> Result<Self> {
        let [a, b] = [&*hair, &coat].map(LinearImage::from);
        let (difference, flip) = compare_mapped(&a, &b)?;
        let mut image = Image8::new(hair.width as u32, hair.height as u32, 4);
        for (out, &error) in image.pixels.chunks_exact_mut(4).zip(&flip) {
            let [r, g, b] = coded(error);
            out.copy_from_slice(&[r, g, b, 255]);
        }
        let likeness = likeness::judge(&a, &b, fringe_px).ok().map(|judged| judged.likeness);
        Ok(Self { film: hair, coat, flip, image, difference, likeness })
    }

    /// The numbers by name, as the panel shows them: those of `compare`, then those of `report coat`.
    pub fn rows(&self) -> Vec<(&'static str, String)> {
        let d = &self.difference;
        let mut rows = vec![
            ("FLIP", format!("{:.4}", d.flip)),
            ("FLIP, 95th percentile", format!("{:.4}", d.flip_p95)),
            ("relMSE", format!("{:.5}", d.rel_mse)),
            ("SSIM", format!("{:.4}", d.ssim)),
            ("bias", format!("{:+.2} %", 100.0 * d.bias)),
        ];
        if let Some(likeness) = &self.likeness {
            rows.push(("exposed: FLIP", format!("{:.4}", likeness.flip)));
            rows.push(("exposed: bias", format!("{:+.2} %", 100.0 * likeness.bias)));
            rows.push(("coverage", format!("{:+.2} points", likeness.coverage)));
            if let Some(fringe) = &likeness.fringe {
                rows.push(("fringe: FLIP", format!("{:.4}", fringe.flip)));
                rows.push(("fringe: coverage", format!("{:+.2} points", fringe.coverage)));
            }
        }
        rows
    }

    /// FLIP at a place, in parts of the picture's width and height.
    pub fn at(&self, x: f32, y: f32) -> Option<f32> {
        let (width, height) = (self.film.width, self.film.height);
        let (column, row) = ((x * width as f32) as usize, (y * height as f32) as usize);
        if x < 0.0 || y < 0.0 || column >= width || row >= height {
            return None;
        }
        self.flip.get(row * width + column).copied()
    }
}

/// Colours of errors from 0 to 1, evenly apart: the brighter, the larger. Linear RGB.
const COLOURS: [Vec3; 6] = [
    Vec3::new(0.0, 0.0, 0.005),
    Vec3::new(0.08, 0.01, 0.18),
    Vec3::new(0.38, 0.03, 0.2),
    Vec3::new(0.85, 0.13, 0.05),
    Vec3::new(0.97, 0.5, 0.08),
    Vec3::new(1.0, 0.98, 0.6),
];

/// The colour of an error, as eight bits hold it.
pub fn coded(error: f32) -> [u8; 3] {
    colour(error).to_array().map(|v| unorm8(srgb_from_linear(v)))
}

/// The colour of an error, linear RGB.
fn colour(error: f32) -> Vec3 {
    let at = error.clamp(0.0, 1.0) * (COLOURS.len() - 1) as f32;
    let below = (at as usize).min(COLOURS.len() - 2);
    COLOURS[below].lerp(COLOURS[below + 1], at - below as f32)
}
