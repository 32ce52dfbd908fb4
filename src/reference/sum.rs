//! What a pixel's lines tell, put together.

use super::shade::Appearance;
use super::trace::Seen;
use crate::data::film::Film;
use crate::math::DVec3;

/// Luminance of linear sRGB primaries (Rec. 709).
pub fn luminance(colour: DVec3) -> f64 {
    colour.dot(DVec3::new(0.2126, 0.7152, 0.0722))
}

/// Sums over a pixel's lines.
#[derive(Debug, Default)]
pub struct Sum {
    lines: f64,
    /// Of the mean luminance, estimated.
    pub variance: f64,
    /// Σ of what is seen.
    pub appearance: Appearance,
    /// Σ share × distance, m.
    pub depth_m: f64,
    guard: f64,
    undercoat: f64,
    skin: f64,
}

impl Sum {
    /// Of so many lines, with nothing seen on them yet.
    pub fn of(lines: usize) -> Self {
        Self { lines: lines as f64, ..Self::default() }
    }

    /// Adds what is seen with a share of a line.
    pub fn add(&mut self, appearance: &Appearance, share: f64) {
        self.appearance.radiance += appearance.radiance * share;
        self.appearance.albedo += appearance.albedo * share;
        self.appearance.tangent += appearance.tangent * share;
        self.appearance.normal += appearance.normal * share;
    }

    /// Takes note of what is seen.
    pub fn cover(&mut self, seen: &Seen, share: f64) {
        *match seen {
            Seen::Guard { .. } => &mut self.guard,
            Seen::Undercoat(_) => &mut self.undercoat,
            Seen::Skin(_) => &mut self.skin,
        } += share;
    }

    /// Standard error of the pixel's lightness (CIE L*, 0 to 100), which goes with the cube root of luminance.
    pub fn lightness_error(&self) -> f64 {
        let slope =
            116.0 / 3.0 * libm::pow(luminance(self.appearance.radiance) / self.lines.max(1.0) + 1e-3, -2.0 / 3.0);
        self.variance.sqrt() * slope
    }

    /// Adds other lines of the pixel. The more there are, the more each tells, as lines that share a pixel evenly err less than
    /// as many that do not know of each other: each counts for as many as were placed together.
    pub fn join(&mut self, other: &Self) {
        let weights = if other.lines > 0.0 { [self.lines, other.lines] } else { [1.0, 0.0] };
        let join = |a: &mut f64, b: f64| *a = weights[0] * *a + weights[1] * b;
        let join_all = |a: &mut DVec3, b: DVec3| *a = *a * weights[0] + b * weights[1];
        join_all(&mut self.appearance.radiance, other.appearance.radiance);
        join_all(&mut self.appearance.albedo, other.appearance.albedo);
        join_all(&mut self.appearance.tangent, other.appearance.tangent);
        join_all(&mut self.appearance.normal, other.appearance.normal);
        join(&mut self.depth_m, other.depth_m);
        join(&mut self.guard, other.guard);
        join(&mut self.undercoat, other.undercoat);
        join(&mut self.skin, other.skin);
        join(&mut self.lines, other.lines);
    }

    /// Adds other lines of the pixel, each of which counts as much.
    pub fn add_all(&mut self, other: &Self) {
        self.lines += other.lines;
        self.add(&other.appearance, 1.0);
        self.depth_m += other.depth_m;
        self.guard += other.guard;
        self.undercoat += other.undercoat;
        self.skin += other.skin;
    }

    /// Becomes a pixel of a film.
    pub fn into_film(self, film: &mut Film, i: usize) {
        let met = self.guard + self.undercoat + self.skin;
        let part = 1.0 / self.lines.max(1.0);
        let mean = |v: DVec3| (v * part).as_vec3();
        film.radiance[i] = mean(self.appearance.radiance);
        film.albedo[i] = mean(self.appearance.albedo);
        film.tangent[i] = mean(self.appearance.tangent);
        film.normal[i] = mean(self.appearance.normal);
        film.depth_m[i] = if met > 0.0 { (self.depth_m / met) as f32 } else { 0.0 };
        film.alpha[i] = (met * part) as f32;
        film.guard[i] = (self.guard * part) as f32;
        film.undercoat[i] = (self.undercoat * part) as f32;
    }
}

/// Variance of the mean of what lines tell, estimated from how unlike those are that lie side by side.
pub fn variance(lines: &[f64]) -> f64 {
    let count = lines.len() as f64;
    if lines.len() < 6 {
        let unlike: f64 = lines.windows(2).map(|pair| (pair[1] - pair[0]) * (pair[1] - pair[0])).sum();
        return 0.5 * unlike / (count - 1.0).max(1.0) / count;
    }
    // Pairs err the less the smoother the pixel is: what changes linearly from each to the next is no error.
    let pairs: Vec<f64> = lines.chunks_exact(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
    let bend = |three: &[f64]| three[0] - 2.0 * three[1] + three[2];
    let bends: f64 = pairs.windows(3).map(|three| bend(three) * bend(three)).sum();
    bends / 6.0 / (pairs.len() - 2) as f64 / pairs.len() as f64
}

/// Chooses evenly among small shares: whenever their sum passes a multiple of the least.
#[derive(Debug)]
pub struct Pick {
    least: f64,
    passed: f64,
}

impl Pick {
    /// Of shares less than `least`, the first after a random part of it.
    pub fn new(least: f64, part: f64) -> Self {
        Self { least, passed: least * part }
    }

    /// What a share counts for: it is the share in the mean, and 0 or no less than the least.
    pub fn weight(&mut self, share: f64) -> f64 {
        if share >= self.least {
            return share;
        }
        self.passed += share;
        if self.passed < self.least {
            return 0.0;
        }
        self.passed -= self.least;
        self.least
    }
}
