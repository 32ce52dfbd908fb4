//! The renderer's own formulas as fibres: R, TT and TRT lobes of guard hair, Kajiya and Kay's undercoat.

use super::scatter::{Meeting, Scatter};
use crate::math::DVec3;
use crate::shade::Angles;
use crate::shade::kajiya_kay::KajiyaKay;
use crate::shade::lobes::{Lobes, Prepared};
use std::f64::consts::{FRAC_1_PI, PI, TAU};

impl Scatter for KajiyaKay<f64> {
    fn scatter(&self, at: &Meeting, to_eye: DVec3, to_light: DVec3, colour: DVec3) -> DVec3 {
        let angles = Angles::of_dvectors(at.hair, to_light, to_eye);
        let (tinted, plain) = KajiyaKay::scatter(self, angles);
        (colour * tinted + plain) * angles.cos_in()
    }

    fn sample(&self, at: &Meeting, _: DVec3, _: DVec3, random: [f64; 4]) -> (DVec3, f64) {
        let (sine, azimuth) = level(random);
        let [x, y] = at.hair.any_orthonormal_pair().into();
        (Frame { axes: [x, y, at.hair] }.direction(sine, azimuth), level_density(sine))
    }
}

/// Share of directions that go to each of [`Lobes`]' three lobes; the rest goes to what is spread around the hair.
const LOBE: f64 = 0.2;

impl Scatter for Lobes<f64> {
    fn scatter(&self, at: &Meeting, to_eye: DVec3, to_light: DVec3, colour: DVec3) -> DVec3 {
        let angles = Angles::of_dvectors(at.hair, to_light, to_eye);
        let s = Lobes::scatter(self, angles);
        (colour * (s.once + colour * s.twice) + s.plain) * angles.cos_in()
    }

    fn sample(&self, at: &Meeting, to_eye: DVec3, _: DVec3, random: [f64; 4]) -> (DVec3, f64) {
        let frame = Frame::new(at.hair, to_eye);
        let out_rad = libm::asin(to_eye.dot(at.hair).clamp(-1.0, 1.0));
        let choice = (random[0] / LOBE) as usize;
        let (sine, azimuth) = match self.lobes.get(choice) {
            Some(lobe) => {
                let [along, around] = normals([random[1], random[2]]);
                let (mean, deviation) = inclination(lobe, out_rad);
                let theta = mean + deviation * along;
                // Past the hair's ends there is no direction; nor farther around than half a turn.
                if theta.abs() >= 0.5 * PI {
                    return (at.hair, 0.0);
                }
                let azimuth = if choice == TT { PI + around_tt(self) * around } else { TAU * random[3] };
                if !(0.0..TAU).contains(&azimuth) {
                    return (at.hair, 0.0);
                }
                (libm::sin(theta), azimuth)
            }
            None => level(random),
        };
        (frame.direction(sine, azimuth), density(self, out_rad, sine, azimuth))
    }
}

/// Index of the lobe that goes through the hair.
const TT: usize = 1;

/// Standard deviation of TT around the hair, rad.
fn around_tt(lobes: &Lobes<f64>) -> f64 {
    (-0.5 / lobes.tt_azimuth_scale).sqrt()
}

/// How densely directions are sampled, 1/sr.
fn density(lobes: &Lobes<f64>, out_rad: f64, sine: f64, azimuth: f64) -> f64 {
    let (theta, cosine) = (libm::asin(sine), (1.0 - sine * sine).max(1e-12).sqrt());
    let each = lobes.lobes.iter().enumerate().map(|(i, lobe)| {
        let (mean, deviation) = inclination(lobe, out_rad);
        let around = if i == TT { normal(azimuth - PI, around_tt(lobes)) } else { 1.0 / TAU };
        normal(theta - mean, deviation) * around / cosine
    });
    LOBE * each.sum::<f64>() + (1.0 - 3.0 * LOBE) * level_density(sine)
}

/// Mean and standard deviation of the light's inclination in a lobe, rad.
fn inclination(lobe: &Prepared<f64>, out_rad: f64) -> (f64, f64) {
    (2.0 * lobe.shift_rad - out_rad, 2.0 * (-0.5 / lobe.scale).sqrt())
}

/// Density of a normal distribution.
fn normal(x: f64, deviation: f64) -> f64 {
    libm::exp(-0.5 * (x / deviation) * (x / deviation)) / (deviation * TAU.sqrt())
}

/// Two normal numbers (Box and Muller 1958).
pub fn normals(random: [f64; 2]) -> [f64; 2] {
    let radius = (-2.0 * libm::log(1.0 - random[0])).sqrt();
    let angle = TAU * random[1];
    [radius * libm::cos(angle), radius * libm::sin(angle)]
}

/// Sine of the inclination, and azimuth, of a direction that is as dense as its cosine to the hair's level: the sine is the
/// abscissa of a point in a disc.
fn level(random: [f64; 4]) -> (f64, f64) {
    (random[1].sqrt() * libm::cos(TAU * random[2]), TAU * random[3])
}

fn level_density(sine: f64) -> f64 {
    (1.0 - sine * sine).max(0.0).sqrt() * FRAC_1_PI * FRAC_1_PI
}

/// Axes at a hair, the last one along it.
#[derive(Clone, Copy, Debug)]
struct Frame {
    axes: [DVec3; 3],
}

impl Frame {
    /// With azimuth 0 where the eye is.
    fn new(hair: DVec3, to_eye: DVec3) -> Self {
        let x = (to_eye - hair * to_eye.dot(hair)).try_normalize().unwrap_or_else(|| hair.any_orthonormal_vector());
        Self { axes: [x, hair.cross(x), hair] }
    }

    fn direction(&self, sine: f64, azimuth: f64) -> DVec3 {
        let cosine = (1.0 - sine * sine).max(0.0).sqrt();
        let [x, y, z] = self.axes;
        x * (cosine * libm::cos(azimuth)) + y * (cosine * libm::sin(azimuth)) + z * sine
    }
}
