//! A kind of hair as dense as it is in the mean.

use super::LAYERS;
use crate::fur::groom::fibre::{Fibre, LENGTH_SPREAD};
use crate::fur::undercoat::Undercoat;

/// Values at heights up to the tips.
pub(super) type Table = [f32; LAYERS * 4 + 1];

/// A kind of hair in the mean.
#[derive(Clone, Debug)]
pub(super) struct HairKind {
    /// Slopes and their spread.
    pub(super) slopes: Undercoat,
    /// Hair width × length along the hair per skin area and height, 1/m, at heights up to the tips.
    pub(super) width_per_m: Table,
    /// The same, summed from the skin up to there in intervals.
    pub(super) width_below_per_m: Table,
}

impl HairKind {
    pub(super) fn new(fibre: &Fibre, shell_m: f32, tips: f32) -> Self {
        let slopes = Undercoat::new(fibre, None);
        let variation = fibre.shape.length_variation;
        let mean = slopes.height_m / shell_m / (1.0 + LENGTH_SPREAD * variation);
        let width = |t: f32| {
            // Over lengths: normal, those beyond two deviations set there.
            const STEPS: usize = 32;
            let step = 2.0 * LENGTH_SPREAD / STEPS as f32;
            let of = |z: f32| {
                let s = t / (mean * (1.0 + z * variation));
                if s > 1.0 {
                    return 0.0;
                }
                2.0 * fibre.radius_m * fibre.profile.radius_factor(s) * fibre.profile.opacity_at(s)
            };
            let beyond = 0.5 * libm::erfcf(LENGTH_SPREAD * std::f32::consts::FRAC_1_SQRT_2);
            (0..STEPS).fold(beyond * (of(-LENGTH_SPREAD) + of(LENGTH_SPREAD)), |sum, i| {
                let z = -LENGTH_SPREAD + (i as f32 + 0.5) * step;
                sum + 0.398_942_3 * libm::expf(-0.5 * z * z) * step * of(z)
            })
        };
        let last = (LAYERS * 4) as f32;
        let width_per_m: Table =
            std::array::from_fn(|i| fibre.density_per_m2 * slopes.stretch * width(tips * i as f32 / last));
        let mut width_below_per_m = [0.0; LAYERS * 4 + 1];
        for i in 1..width_per_m.len() {
            width_below_per_m[i] = width_below_per_m[i - 1] + 0.5 * (width_per_m[i - 1] + width_per_m[i]);
        }
        Self { slopes, width_per_m, width_below_per_m }
    }
}
