//! How sure a picture of random paths is.

use crate::math::DVec3;
use crate::reference::sum::luminance;

/// Standard errors over what they are errors of.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Noise {
    /// Of the picture's mean luminance.
    pub mean: f64,
    /// Of a pixel's luminance: the median over pixels in which anything is seen.
    pub median_pixel: f64,
}

/// Sums over the luminances of a pixel's paths.
#[derive(Clone, Copy, Debug, Default)]
pub struct Spread {
    count: f64,
    sum: f64,
    squares: f64,
}

impl Spread {
    /// Adds a path.
    pub fn add(&mut self, radiance: DVec3) {
        let bright = luminance(radiance);
        self.count += 1.0;
        self.sum += bright;
        self.squares += bright * bright;
    }

    /// Adds other paths.
    pub fn add_all(&mut self, other: &Self) {
        self.count += other.count;
        self.sum += other.sum;
        self.squares += other.squares;
    }

    /// Mean luminance.
    fn mean(&self) -> f64 {
        self.sum / self.count.max(1.0)
    }

    /// Variance of the mean. It is somewhat too large: paths share a pixel evenly, which is not counted.
    fn variance(&self) -> f64 {
        let mean = self.mean();
        ((self.squares / self.count.max(1.0) - mean * mean) / (self.count - 1.0).max(1.0)).max(0.0)
    }
}

impl Noise {
    /// Of a picture's pixels; infinite where one path is all that is known.
    pub fn new(pixels: &[Spread]) -> Self {
        if pixels.iter().any(|pixel| pixel.count < 2.0) {
            return Self { mean: f64::INFINITY, median_pixel: f64::INFINITY };
        }
        let sum: f64 = pixels.iter().map(Spread::mean).sum();
        let variance: f64 = pixels.iter().map(Spread::variance).sum();
        let mut errors: Vec<f64> =
            pixels.iter().filter(|p| p.sum > 0.0).map(|p| p.variance().sqrt() / p.mean()).collect();
        errors.sort_unstable_by(f64::total_cmp);
        let over = |error: f64, of: f64| if of > 0.0 { error / of } else { 0.0 };
        let median_pixel = errors.get(errors.len() / 2).copied().unwrap_or(0.0);
        Self { mean: over(variance.sqrt(), sum), median_pixel }
    }
}
