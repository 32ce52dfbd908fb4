//! How much detail of each size a picture has.

use super::smooth;
use crate::metrics::compare::{LUMA, LinearImage, mean};
use serde::Serialize;

/// Alpha from which a pixel is fully covered.
const FULL: f32 = 0.999;
/// Variance below which a picture has no detail to compare, linear light squared.
const LEAST: f64 = 1e-12;

/// Variance of luminance over the reference's, by size of detail; none where the reference has no such detail, or nothing is
/// fully covered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Bands {
    /// Details of 1 to 2 pixels.
    #[serde(rename = "1-2", skip_serializing_if = "Option::is_none")]
    pub from_1_px: Option<f64>,
    /// Of 2 to 4.
    #[serde(rename = "2-4", skip_serializing_if = "Option::is_none")]
    pub from_2_px: Option<f64>,
    /// Of 4 to 8.
    #[serde(rename = "4-8", skip_serializing_if = "Option::is_none")]
    pub from_4_px: Option<f64>,
}

impl Bands {
    /// Of `other` over `reference`, pictures of one size, where both are fully covered.
    pub fn new(reference: &LinearImage, other: &LinearImage) -> Self {
        let full = |i: usize| f32::from(reference.alpha[i] >= FULL && other.alpha[i] >= FULL);
        let full: Vec<f32> = (0..reference.alpha.len()).map(full).collect();
        let [b, a] = [reference, other].map(|picture| variances(picture, &full));
        let ratio = |i: usize| (b[i] > LEAST).then(|| a[i] / b[i]);
        Self { from_1_px: ratio(0), from_2_px: ratio(1), from_4_px: ratio(2) }
    }

    /// In the order of their sizes.
    pub fn all(&self) -> [Option<f64>; 3] {
        [self.from_1_px, self.from_2_px, self.from_4_px]
    }
}

/// Mean square of the difference between luminance smoothed over 1 and 2, 2 and 4, 4 and 8 pixels, within `full`. To smooth
/// over w pixels is to weigh with a Gaussian of the variance that a box of w has, w²/12, of which a pixel brings the box of 1.
fn variances(picture: &LinearImage, full: &[f32]) -> [f64; 3] {
    let luminance: Vec<f32> = picture.colour.iter().map(|c| c.dot(LUMA)).collect();
    let smoothed =
        [1.0_f32, 2.0, 4.0, 8.0].map(|w| smooth::gaussian(&luminance, full, picture.width, (w * w - 1.0) / 12.0));
    let within: Vec<usize> = (0..full.len()).filter(|&i| full[i] > 0.0).collect();
    std::array::from_fn(|band| {
        let difference = |&i: &usize| f64::from(smoothed[band][i] - smoothed[band + 1][i]);
        mean(within.iter().map(|i| difference(i) * difference(i)))
    })
}
