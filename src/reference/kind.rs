//! A kind of hair as a volume, in f64: what reaches a height and how much it blocks there.

use crate::fur::groom::fibre::{Fibre, LENGTH_SPREAD};
use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_4, PI};

/// A kind of hair. Heights are shares of the shell's.
#[derive(Clone, Debug)]
pub struct DHairKind {
    /// Hairs per skin area where the fields say 1, 1/m².
    pub per_m2: f64,
    /// Height of the tallest.
    pub top: f64,
    /// Length along the hair over its height.
    stretch: f64,
    /// Mean and standard deviation of height.
    mean: f64,
    spread: f64,
    /// Mean diameter, m.
    diameter_m: f64,
    /// Standard deviation of each hair's slope against the mean.
    slope: f64,
    /// Share of hairs that reach heights from the skin to `top`, and the density of their ends there.
    reach: Vec<[f64; 2]>,
    /// Density of the ends of the tallest, below the top.
    brim: f64,
    /// Width per hair at heights from the skin to `top`, m, with opacity counted; empty where all have one.
    widths_m: Vec<f64>,
}

/// Part of the height below the top over which the ends of the tallest hairs are spread, so that all may be integrated.
pub const BRIM: f64 = 0.01;

/// Heights at which guard hair's width is kept.
const WIDTHS: usize = 1024;

impl DHairKind {
    /// Of hair of one diameter: undercoat.
    pub fn undercoat(fibre: &Fibre, shell_height_m: f64) -> Self {
        let variation = f64::from(fibre.shape.length_variation);
        let height_m = f64::from(fibre.height_m());
        let top = height_m / shell_height_m;
        let mean = top / (1.0 + f64::from(LENGTH_SPREAD) * variation);
        let mut kind = Self {
            per_m2: f64::from(fibre.density_per_m2),
            top,
            stretch: f64::from(fibre.longest_m()) / height_m.max(f64::MIN_POSITIVE),
            mean,
            spread: mean * variation,
            diameter_m: f64::from(fibre.radius_m) * (1.0 + f64::from(fibre.profile.taper)),
            slope: libm::tan(f64::from(fibre.shape.jitter_deg).to_radians()),
            reach: Vec::new(),
            brim: 0.0,
            widths_m: Vec::new(),
        };
        // All that reaches the top ends below it.
        kind.reach = (0..=WIDTHS).map(|i| kind.reaching(top * (i as f64 / WIDTHS as f64).min(1.0 - 1e-12))).collect();
        kind.brim = kind.reach[WIDTHS][0] / (BRIM * top);
        kind
    }

    /// Of hair that tapers and grows transparent: guard hair.
    pub fn guard(fibre: &Fibre, shell_height_m: f64) -> Self {
        let mut kind = Self::undercoat(fibre, shell_height_m);
        let width_at = |t: f64| {
            // Lengths are normal, those beyond two deviations set there.
            const STEPS: u32 = 512;
            let spread = f64::from(LENGTH_SPREAD);
            let width = |z: f64| {
                let s = t / (kind.mean + z * kind.spread);
                if s <= 1.0 { opaque_width_m(fibre, s) } else { 0.0 }
            };
            let step = 2.0 * spread / f64::from(STEPS);
            let middle: f64 = (0..STEPS)
                .map(|i| {
                    let z = -spread + (f64::from(i) + 0.5) * step;
                    libm::exp(-0.5 * z * z) / (2.0 * PI).sqrt() * step * width(z)
                })
                .sum();
            middle + 0.5 * libm::erfc(spread * FRAC_1_SQRT_2) * (width(-spread) + width(spread))
        };
        kind.widths_m = (0..=WIDTHS).map(|i| width_at(kind.top * i as f64 / WIDTHS as f64)).collect();
        kind
    }

    /// Blocked share per length of the ray at height `t`, for one hair per volume and unit of height: `up_m` from skin to
    /// the shell's top, `sine` and `cosine` between ray and hair.
    pub fn extinction(&self, t: f64, up_m: f64, sine: f64, cosine: f64) -> f64 {
        if t >= self.top {
            return 0.0;
        }
        let side = up_m * self.stretch * self.mean_sine(sine);
        if self.widths_m.is_empty() {
            let at = t / self.top * WIDTHS as f64;
            let low = (at as usize).min(WIDTHS - 1);
            let [from, to] = [self.reach[low], self.reach[low + 1]];
            let [share, ends] = [0, 1].map(|i| from[i] + (at - low as f64) * (to[i] - from[i]));
            let ends = ends + if t > self.top * (1.0 - BRIM) { self.brim } else { 0.0 };
            return share * self.diameter_m * side
                + ends * FRAC_PI_4 * self.diameter_m * self.diameter_m * cosine.abs();
        }
        let at = t / self.top * WIDTHS as f64;
        let low = (at as usize).min(WIDTHS - 1);
        let width_m = self.widths_m[low] + (at - low as f64) * (self.widths_m[low + 1] - self.widths_m[low]);
        width_m * side
    }

    /// Share of hairs that reach height `t`, and the density of their ends there.
    fn reaching(&self, t: f64) -> [f64; 2] {
        if self.spread < 1e-6 {
            return [f64::from(u8::from(t < self.mean)), 0.0];
        }
        let z = (t - self.mean) / self.spread;
        [0.5 * libm::erfc(z * FRAC_1_SQRT_2), libm::exp(-0.5 * z * z) / (self.spread * (2.0 * PI).sqrt())]
    }

    /// Mean sine to the hairs whose mean has this sine: as `Undercoat::mean_sine`.
    fn mean_sine(&self, sine: f64) -> f64 {
        let (variance, s2) = (self.slope * self.slope, sine * sine);
        let c = 1.0 + (0.5 * PI - 1.0) * variance / (variance + 0.434 * s2 + 1e-12);
        ((s2 + c * variance) / (1.0 + variance)).sqrt().min(1.0)
    }
}

/// Width times opacity of a hair at `s` in [0, 1], m.
fn opaque_width_m(fibre: &Fibre, s: f64) -> f64 {
    let p = &fibre.profile;
    let k = f64::from(p.tip_exponent);
    let opacity = 1.0 - libm::expm1(k * s) / libm::expm1(k) * f64::from(p.tip_transparency);
    2.0 * f64::from(fibre.radius_m) * (1.0 + (f64::from(p.taper) - 1.0) * s) * opacity
}
