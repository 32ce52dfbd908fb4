//! Fibres as a path tracer by others has them, for near-field meetings: Chiang et al. 2016, "A practical and controllable hair and
//! fur model for production path tracing", after the paper and pbrt's notes on it, a Lambert cylinder, and half of each.

use furrier::math::DVec3;
use furrier::reference::walk::scatter::{Meeting, Scatter};
use std::f64::consts::{FRAC_1_PI, PI, TAU};

/// Ways through the fibre that are told apart: R, TT, TRT, and all longer ones together.
const WAYS: usize = 4;

/// Chiang et al.'s fibre.
#[derive(Clone, Copy, Debug)]
pub struct Chiang {
    index: f64,
    tilt_rad: f64,
    azimuthal: f64,
    /// Longitudinal variances of the ways.
    variances: [f64; WAYS],
    /// Scale of the logistic distribution around the hair.
    scale: f64,
}

impl Chiang {
    /// Of both roughnesses alike, index 1.55 and scales tilted by 2°.
    pub fn new(roughness: f64) -> Self {
        let b = roughness;
        let v = (0.726 * b + 0.812 * b * b + 3.7 * b.powi(20)).powi(2);
        let scale = (PI / 8.0).sqrt() * (0.265 * b + 1.194 * b * b + 5.372 * b.powi(22));
        let variances = [v, 0.25 * v, 4.0 * v, 4.0 * v];
        Self { index: 1.55, tilt_rad: 2.0_f64.to_radians(), azimuthal: b, variances, scale }
    }

    /// Absorption per radius for a fur of this colour: Chiang et al.'s fit.
    fn absorption(&self, colour: DVec3) -> DVec3 {
        let b = self.azimuthal;
        let fit = 5.969 - 0.215 * b + 2.532 * b * b - 10.73 * b.powi(3) + 5.574 * b.powi(4) + 0.245 * b.powi(5);
        colour.map(|c| (c.clamp(1e-4, 1.0 - 1e-4).ln() / fit).powi(2))
    }

    /// What each way sends on of light towards the eye, and the angle inside.
    fn attenuations(&self, sine: f64, across: f64, colour: DVec3) -> ([DVec3; WAYS], f64) {
        let cosine = (1.0 - sine * sine).max(0.0).sqrt();
        let along = (1.0 - (sine / self.index).powi(2)).sqrt();
        let index = (self.index * self.index - sine * sine).sqrt() / cosine.max(1e-9);
        let sine_inside = across / index;
        let length = 2.0 * (1.0 - sine_inside * sine_inside).max(0.0).sqrt() / along;
        let through = (self.absorption(colour) * -length).map(f64::exp);
        let f = fresnel(cosine * (1.0 - across * across).max(0.0).sqrt(), self.index);
        let tt = through * (1.0 - f) * (1.0 - f);
        let trt = tt * through * f;
        ([DVec3::splat(f), tt, trt, trt * through * f / (DVec3::ONE - through * f)], sine_inside.asin())
    }

    /// Inclination of the eye as the tilted scales have it for a way.
    fn tilted(&self, way: usize, sine: f64) -> f64 {
        let by = [-2.0, 1.0, 4.0, 0.0][way] * self.tilt_rad;
        (sine.asin() + by).sin()
    }

    /// Value by way and channel, and density, towards a light.
    fn both(&self, at: &Meeting, to_eye: DVec3, to_light: DVec3, colour: DVec3) -> (DVec3, f64) {
        let view = View::new(at, to_eye);
        let (ways, inside) = self.attenuations(view.sine, at.across, colour);
        let shares = shares(&ways);
        let sine = to_light.dot(at.hair).clamp(-1.0, 1.0);
        let azimuth = to_light.dot(view.y).atan2(to_light.dot(view.x));
        let (mut value, mut density) = (DVec3::ZERO, 0.0);
        for way in 0..WAYS {
            let along = longitudinal(self.tilted(way, view.sine), sine, self.variances[way]);
            let around =
                if way < 3 { trimmed_logistic(azimuth - turn(way, at.across, inside), self.scale) } else { 1.0 / TAU };
            value += ways[way] * (along * around);
            density += shares[way] * along * around;
        }
        (value, density)
    }
}

/// The eye as the hair has it: the sine of its inclination, and axes across the hair, the first towards it.
struct View {
    sine: f64,
    x: DVec3,
    y: DVec3,
}

impl View {
    fn new(at: &Meeting, to_eye: DVec3) -> Self {
        let sine = to_eye.dot(at.hair).clamp(-1.0, 1.0);
        let level = to_eye - at.hair * sine;
        let x = level.try_normalize().unwrap_or_else(|| at.hair.any_orthonormal_vector());
        Self { sine, x, y: at.hair.cross(x) }
    }
}

/// By how much a way turns light around a perfectly smooth hair.
fn turn(way: usize, across: f64, inside: f64) -> f64 {
    2.0 * way as f64 * inside - 2.0 * across.asin() + way as f64 * PI
}

fn shares(ways: &[DVec3; WAYS]) -> [f64; WAYS] {
    let bright = ways.map(|a| a.element_sum());
    let sum: f64 = bright.iter().sum();
    bright.map(|b| b / sum)
}

/// Reflected share of unpolarised light.
fn fresnel(cosine: f64, index: f64) -> f64 {
    let inside = (1.0 - (1.0 - cosine * cosine) / (index * index)).max(0.0).sqrt();
    let across = (cosine - index * inside) / (cosine + index * inside);
    let along = (index * cosine - inside) / (index * cosine + inside);
    0.5 * (across * across + along * along)
}

/// d'Eon et al.'s M, per sine of inclination.
fn longitudinal(eye: f64, light: f64, v: f64) -> f64 {
    let cosines = ((1.0 - eye * eye).max(0.0) * (1.0 - light * light).max(0.0)).sqrt();
    // sinh(1/v) = e^{1/v} (1 − e^{−2/v}) / 2
    (log_bessel(cosines / v) - eye * light / v - 1.0 / v).exp() / (v * (1.0 - (-2.0 / v).exp()))
}

/// ln I₀.
fn log_bessel(x: f64) -> f64 {
    if x > 20.0 {
        return x - 0.5 * (TAU * x).ln() + (1.0 + 1.0 / (8.0 * x) + 9.0 / (128.0 * x * x)).ln();
    }
    let (mut term, mut sum) = (1.0, 1.0);
    for k in 1..60 {
        term *= 0.25 * x * x / f64::from(k * k);
        sum += term;
    }
    f64::ln(sum)
}

fn logistic_below(x: f64, scale: f64) -> f64 {
    1.0 / (1.0 + (-x / scale).exp())
}

fn trimmed_logistic(x: f64, scale: f64) -> f64 {
    let x = (x - TAU * (x / TAU).round()).abs();
    let e = (-x / scale).exp();
    e / (scale * (1.0 + e) * (1.0 + e)) / (2.0 * logistic_below(PI, scale) - 1.0)
}

impl Scatter for Chiang {
    fn scatter(&self, at: &Meeting, to_eye: DVec3, to_light: DVec3, colour: DVec3) -> DVec3 {
        self.both(at, to_eye, to_light, colour).0
    }

    fn sample(&self, at: &Meeting, to_eye: DVec3, colour: DVec3, random: [f64; 4]) -> (DVec3, f64) {
        let view = View::new(at, to_eye);
        let (ways, inside) = self.attenuations(view.sine, at.across, colour);
        let shares = shares(&ways);
        let (mut way, mut left) = (0, random[0]);
        while way + 1 < WAYS && left >= shares[way] {
            left -= shares[way];
            way += 1;
        }
        let (v, eye) = (self.variances[way], self.tilted(way, view.sine));
        let cosine = 1.0 + v * (random[1] + (1.0 - random[1]) * (-2.0 / v).exp()).ln();
        let beside = (1.0 - cosine * cosine).max(0.0).sqrt() * (TAU * random[2]).cos();
        let sine = (-cosine * eye + beside * (1.0 - eye * eye).max(0.0).sqrt()).clamp(-1.0, 1.0);
        let below = logistic_below(-PI, self.scale);
        let spread = -self.scale * (1.0 / (below + random[3] * (1.0 - 2.0 * below)) - 1.0).ln();
        let azimuth = if way < 3 { turn(way, at.across, inside) + spread } else { TAU * random[3] };
        let level = (1.0 - sine * sine).max(0.0).sqrt();
        let direction = view.x * (level * azimuth.cos()) + view.y * (level * azimuth.sin()) + at.hair * sine;
        (direction, self.both(at, to_eye, direction, colour).1)
    }
}

/// An opaque cylinder of Lambert's law, of albedo `of_colour`.
#[derive(Clone, Copy, Debug)]
pub struct Lambert {
    pub of_colour: fn(DVec3) -> DVec3,
}

impl Scatter for Lambert {
    fn scatter(&self, at: &Meeting, _: DVec3, to_light: DVec3, colour: DVec3) -> DVec3 {
        (self.of_colour)(colour) * (FRAC_1_PI * to_light.dot(at.normal).max(0.0))
    }

    fn sample(&self, at: &Meeting, _: DVec3, _: DVec3, random: [f64; 4]) -> (DVec3, f64) {
        let (radius, angle, cosine) = (random[1].sqrt(), TAU * random[2], (1.0 - random[1]).sqrt());
        let (x, y) = at.normal.any_orthonormal_pair();
        let direction = x * (radius * angle.cos()) + y * (radius * angle.sin()) + at.normal * cosine;
        (direction, cosine * FRAC_1_PI)
    }
}

/// Half of each: a stand-in for a fibre with a scattering medulla.
#[derive(Clone, Copy, Debug)]
pub struct Half {
    pub hair: Chiang,
    pub cylinder: Lambert,
}

impl Half {
    /// Of a hair, and a cylinder of the albedo at which opaque cylinders make fur of the colour: 4C/(1+C)².
    pub fn new(roughness: f64) -> Self {
        let of_colour = |c: DVec3| 4.0 * c / ((c + 1.0) * (c + 1.0));
        Self { hair: Chiang::new(roughness), cylinder: Lambert { of_colour } }
    }
}

impl Scatter for Half {
    fn scatter(&self, at: &Meeting, to_eye: DVec3, to_light: DVec3, colour: DVec3) -> DVec3 {
        0.5 * (self.hair.scatter(at, to_eye, to_light, colour) + self.cylinder.scatter(at, to_eye, to_light, colour))
    }

    fn sample(&self, at: &Meeting, to_eye: DVec3, colour: DVec3, random: [f64; 4]) -> (DVec3, f64) {
        let of_hair = random[0] < 0.5;
        let rest = [(2.0 * random[0]).fract(), random[1], random[2], random[3]];
        let direction = if of_hair {
            self.hair.sample(at, to_eye, colour, rest).0
        } else {
            self.cylinder.sample(at, to_eye, colour, rest).0
        };
        let cosine = direction.dot(at.normal).max(0.0);
        (direction, 0.5 * (self.hair.both(at, to_eye, direction, colour).1 + cosine * FRAC_1_PI))
    }
}
