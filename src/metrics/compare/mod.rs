//! How far one picture is from another (`docs/steps/metrics.md`).

mod load;
mod ssim;

pub use load::load;

use crate::data::film::Film;
use crate::data::image::srgb_from_linear;
use crate::error::{Error, Result};
use crate::math::Vec3;
use serde::Serialize;

/// Pixels per degree of the viewer's eye that FLIP assumes: a 0.7 m wide 4K screen seen from 0.7 m.
pub const PIXELS_PER_DEGREE: f32 = 67.0;

/// A picture in linear light, rows from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearImage {
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Linear RGB, premultiplied.
    pub colour: Vec<Vec3>,
    /// Coverage in [0, 1].
    pub alpha: Vec<f32>,
}

impl From<&Film> for LinearImage {
    fn from(film: &Film) -> Self {
        Self { width: film.width, height: film.height, colour: film.radiance.clone(), alpha: film.alpha.clone() }
    }
}

/// How a picture differs from a reference.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Difference {
    /// Mean of NVIDIA's LDR-FLIP (Andersson et al. 2020) over pixels with coverage in either picture, in [0, 1].
    pub flip: f64,
    /// Its 95th percentile over the same pixels.
    pub flip_p95: f64,
    /// mean((a − b)²/(b² + 0.01)) over the same pixels and three channels, linear light, b the reference.
    pub rel_mse: f64,
    /// Peak signal-to-noise ratio of the sRGB-coded pictures, dB; `None` where they are equal.
    pub psnr_db: Option<f64>,
    /// Structural similarity of the sRGB-coded luma (Wang et al. 2004), 1 where they are equal.
    pub ssim: f64,
    /// Mean luminance over the reference's, less 1; 0 where both are black.
    pub bias: f64,
    /// Mean alpha of the reference and of the other.
    pub coverage: [f64; 2],
}

/// Compares `other` with `reference`.
///
/// # Errors
/// [`crate::error::Kind::Input`] where the sizes differ, a picture is empty, or a value is not a finite number.
pub fn compare(reference: &LinearImage, other: &LinearImage) -> Result<Difference> {
    compare_mapped(reference, other).map(|(difference, _)| difference)
}

/// [`compare`], and FLIP pixel by pixel.
///
/// # Errors
/// As [`compare`].
pub fn compare_mapped(reference: &LinearImage, other: &LinearImage) -> Result<(Difference, Vec<f32>)> {
    let size = |light: &LinearImage| format!("{} x {}", light.width, light.height);
    if (reference.width, reference.height) != (other.width, other.height) || reference.colour.is_empty() {
        return Err(Error::input("the pictures cannot be laid over each other")
            .with_field("size")
            .with_found(size(other))
            .with_expected(format!("{}, at least one pixel", size(reference))));
    }
    for light in [reference, other] {
        if let Some(i) = light.colour.iter().zip(&light.alpha).position(|(c, a)| !c.is_finite() || !a.is_finite()) {
            return Err(Error::input("a pixel is not a finite number")
                .with_field(format!("pixel ({}, {})", i % light.width, i / light.width))
                .with_found(format!("{} alpha {}", light.colour[i], light.alpha[i]))
                .with_expected("finite numbers"));
        }
    }
    let counted: Vec<usize> =
        (0..reference.colour.len()).filter(|&i| reference.alpha[i] > 0.0 || other.alpha[i] > 0.0).collect();
    let coded = [reference, other].map(coded);
    let map = flip_map(&coded, reference.width, reference.height);
    let (flip, flip_p95) = flip(&map, &counted);
    let luma = |picture: &[Vec3]| picture.iter().map(|c| c.dot(LUMA)).collect::<Vec<f32>>();
    let difference = Difference {
        flip,
        flip_p95,
        rel_mse: rel_mse(reference, other, &counted),
        psnr_db: psnr_db(&coded),
        ssim: ssim::mean(&luma(&coded[0]), &luma(&coded[1]), reference.width, reference.height),
        bias: bias(reference, other),
        coverage: [reference, other].map(|l| mean(l.alpha.iter().map(|&a| f64::from(a)))),
    };
    Ok((difference, map))
}

/// Rec. 709 weights.
pub(super) const LUMA: Vec3 = Vec3::new(0.2126, 0.7152, 0.0722);

pub(super) fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len().max(1);
    values.sum::<f64>() / count as f64
}

/// Fixed exposure (none), sRGB coding, clamped to what a screen shows.
fn coded(light: &LinearImage) -> Vec<Vec3> {
    light.colour.iter().map(|c| c.map(|v| srgb_from_linear(v.clamp(0.0, 1.0)))).collect()
}

fn flip_map(coded: &[Vec<Vec3>; 2], width: usize, height: usize) -> Vec<f32> {
    let image = |picture: &[Vec3]| {
        let bytes: Vec<u8> = picture.iter().flat_map(|c| c.to_array().map(|v| (v * 255.0 + 0.5) as u8)).collect();
        nv_flip::FlipImageRgb8::with_data(width as u32, height as u32, &bytes)
    };
    nv_flip::flip(image(&coded[0]), image(&coded[1]), PIXELS_PER_DEGREE).to_vec()
}

fn flip(map: &[f32], counted: &[usize]) -> (f64, f64) {
    let mut errors: Vec<f32> = counted.iter().map(|&i| map[i]).collect();
    errors.sort_unstable_by(f32::total_cmp);
    let p95 = errors.get((errors.len() * 95).div_ceil(100).saturating_sub(1)).copied().unwrap_or(0.0);
    (mean(errors.iter().map(|&e| f64::from(e))), f64::from(p95))
}

pub(super) fn rel_mse(reference: &LinearImage, other: &LinearImage, counted: &[usize]) -> f64 {
    mean(counted.iter().map(|&i| {
        let (b, a) = (reference.colour[i].as_dvec3(), other.colour[i].as_dvec3());
        let ratio = (a - b) * (a - b) / (b * b + 0.01);
        (ratio.x + ratio.y + ratio.z) / 3.0
    }))
}

fn psnr_db(coded: &[Vec<Vec3>; 2]) -> Option<f64> {
    let square = |(a, b): (&Vec3, &Vec3)| f64::from((*a - *b).length_squared()) / 3.0;
    let mse = mean(coded[0].iter().zip(&coded[1]).map(square));
    (mse > 0.0).then(|| -10.0 * libm::log10(mse))
}

fn bias(reference: &LinearImage, other: &LinearImage) -> f64 {
    let [b, a] = [reference, other].map(|l| mean(l.colour.iter().map(|c| f64::from(c.dot(LUMA)))));
    if b == 0.0 && a == 0.0 { 0.0 } else { (a - b) / b }
}
