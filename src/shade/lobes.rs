//! The single-scattering lobes of guard hair (Sadeghi et al. 2010, "An artist friendly hair shading system"), with a
//! diffuse part for what the hairs scatter among each other.

use super::{Angles, Real};
use crate::error::{Error, Result};
use std::f64::consts::PI;

/// One lobe as an artist sets it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lobe {
    /// Largest part of the light that it sends back, over all eye directions, in [0, 1].
    pub albedo: f64,
    /// Shift of the highlight along the hair, rad; negative is towards the root.
    pub shift_rad: f64,
    /// Standard deviation along the hair, rad, of (θ_i + θ_o)/2; in [0.01, 1].
    pub width_rad: f64,
}

/// What guard hair does with light. The sum of all albedos is at most 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LobeParameters {
    /// Reflection at the cuticle; untinted.
    pub r: Lobe,
    /// Straight through; tinted once by the hair's colour.
    pub tt: Lobe,
    /// Standard deviation of TT around the hair, rad; in [0.05, 3].
    pub tt_azimuth_rad: f64,
    /// Once reflected inside; tinted twice.
    pub trt: Lobe,
    /// Share of TRT in its two glints, in [0, 1].
    pub glint: f64,
    /// Angle of the glints from the light's plane, rad.
    pub glint_angle_rad: f64,
    /// Standard deviation of a glint around the hair, rad; in [0.02, 3].
    pub glint_width_rad: f64,
    /// Albedo of the Kajiya–Kay diffuse part; tinted once.
    pub diffuse: f64,
}

impl Default for LobeParameters {
    /// Sadeghi et al.'s brunette, with the cuticle's tilt of 3 to 5° that Marschner et al. 2003 measured.
    fn default() -> Self {
        let degrees = f64::to_radians;
        Self {
            r: Lobe { albedo: 0.08, shift_rad: degrees(-4.0), width_rad: degrees(6.0) },
            tt: Lobe { albedo: 0.12, shift_rad: degrees(2.0), width_rad: degrees(5.0) },
            tt_azimuth_rad: degrees(30.0),
            trt: Lobe { albedo: 0.2, shift_rad: degrees(6.0), width_rad: degrees(11.0) },
            glint: 0.25,
            glint_angle_rad: degrees(35.0),
            glint_width_rad: degrees(10.0),
            diffuse: 0.5,
        }
    }
}

/// A [`LobeParameters`] with its lobes normalised, ready to evaluate.
#[derive(Clone, Copy, Debug)]
pub struct Lobes<R> {
    /// R, TT and TRT.
    pub lobes: [Prepared<R>; 3],
    /// −1 / (2σ²) of TT around the hair.
    pub tt_azimuth_scale: R,
    /// Share of TRT in its glints.
    pub glint: R,
    /// Angle of the glints from the light's plane, rad.
    pub glint_angle_rad: R,
    /// −1 / (2σ²) of a glint around the hair.
    pub glint_scale: R,
    /// S of the diffuse part, 1/sr.
    pub diffuse: R,
    /// 1 over the integral around the hair of R's and TRT's azimuthal part.
    pub surround_norm: R,
    /// The same of the glints.
    pub glint_norm: R,
    /// The same of TT.
    pub tt_norm: R,
}

/// One lobe along the hair.
#[derive(Clone, Copy, Debug)]
pub struct Prepared<R> {
    /// Albedo over the lobe's own integral.
    pub albedo: R,
    /// Shift along the hair, rad.
    pub shift_rad: R,
    /// −1 / (2σ²).
    pub scale: R,
}

impl<R: Real> Prepared<R> {
    /// The part along the hair, where (θ_i + θ_o)/2 is `half_rad`.
    #[inline(always)]
    fn along(&self, half_rad: R) -> R {
        let x = half_rad - self.shift_rad;
        self.albedo * (self.scale * x * x).exp()
    }

    #[inline(always)]
    fn map<S>(&self, of: impl Fn(R) -> S) -> Prepared<S> {
        Prepared { albedo: of(self.albedo), shift_rad: of(self.shift_rad), scale: of(self.scale) }
    }
}

/// S, 1/sr, split by how often the hair's colour tints it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scattered<R> {
    /// Not tinted: R.
    pub plain: R,
    /// Tinted once: TT and diffuse.
    pub once: R,
    /// Tinted twice: TRT.
    pub twice: R,
}

impl<R: Real> Lobes<R> {
    /// Checks and normalises.
    ///
    /// Each lobe is divided by the largest value, over all eye directions, of its integral ∫ S cos θ_i dω_i, so its albedo
    /// is what it sends back at most.
    ///
    /// # Errors
    /// Names the parameter outside its range, or says by how much the albedos pass 1.
    pub fn new(parameters: &LobeParameters) -> Result<Self> {
        check(parameters)?;
        let around_r = integrate(0.0, PI, 512, |phi| 2.0 * libm::cos(0.5 * phi));
        let gauss = |x: f64, sigma: f64| libm::exp(-0.5 * (x / sigma) * (x / sigma));
        let around_tt = integrate(0.0, PI, 512, |phi| 2.0 * gauss(PI - phi, parameters.tt_azimuth_rad));
        let around_glint =
            integrate(0.0, PI, 512, |phi| 2.0 * gauss(phi - parameters.glint_angle_rad, parameters.glint_width_rad));
        let prepare = |lobe: &Lobe| Prepared {
            albedo: R::of(lobe.albedo / largest_along(lobe)),
            shift_rad: R::of(lobe.shift_rad),
            scale: R::of(-0.5 / (lobe.width_rad * lobe.width_rad)),
        };
        Ok(Self {
            lobes: [prepare(&parameters.r), prepare(&parameters.tt), prepare(&parameters.trt)],
            tt_azimuth_scale: R::of(-0.5 / (parameters.tt_azimuth_rad * parameters.tt_azimuth_rad)),
            glint: R::of(parameters.glint),
            glint_angle_rad: R::of(parameters.glint_angle_rad),
            glint_scale: R::of(-0.5 / (parameters.glint_width_rad * parameters.glint_width_rad)),
            diffuse: R::of(parameters.diffuse / (PI * PI)),
            surround_norm: R::of(1.0 / around_r),
            glint_norm: R::of(1.0 / around_glint),
            tt_norm: R::of(1.0 / around_tt),
        })
    }

    /// The same in other numbers.
    #[inline(always)]
    pub fn map<S>(&self, of: impl Fn(R) -> S + Copy) -> Lobes<S> {
        Lobes {
            lobes: [self.lobes[0].map(of), self.lobes[1].map(of), self.lobes[2].map(of)],
            tt_azimuth_scale: of(self.tt_azimuth_scale),
            glint: of(self.glint),
            glint_angle_rad: of(self.glint_angle_rad),
            glint_scale: of(self.glint_scale),
            diffuse: of(self.diffuse),
            surround_norm: of(self.surround_norm),
            glint_norm: of(self.glint_norm),
            tt_norm: of(self.tt_norm),
        }
    }

    /// S for the given directions; symmetric in light and eye.
    #[inline(always)]
    pub fn scatter(&self, angles: Angles<R>) -> Scattered<R> {
        let one = R::of(1.0);
        let half = R::of(0.5);
        let (theta_in, theta_out) = (angles.sin_in.asin(), angles.sin_out.asin());
        let half_rad = half * (theta_in + theta_out);
        let cos_difference = (half * (theta_in - theta_out)).cos().max(R::of(1e-3));
        let spread = one / (cos_difference * cos_difference);
        let [r, tt, trt] = &self.lobes;
        let (r, tt, trt) = (r.along(half_rad) * spread, tt.along(half_rad) * spread, trt.along(half_rad) * spread);
        let azimuth_rad = angles.cos_azimuth.acos();
        let surround = (half * (one + angles.cos_azimuth)).max(R::of(0.0)).sqrt() * self.surround_norm;
        let behind = R::of(PI) - azimuth_rad;
        let beside = azimuth_rad - self.glint_angle_rad;
        let glint = (self.glint_scale * beside * beside).exp() * self.glint_norm;
        let through = (self.tt_azimuth_scale * behind * behind).exp() * self.tt_norm;
        Scattered {
            plain: r * surround,
            once: tt * through + self.diffuse,
            twice: trt * (surround + self.glint * (glint - surround)),
        }
    }
}

/// Largest ∫ M cos²θ_i / cos²θ_d dθ_i over eye inclinations.
fn largest_along(lobe: &Lobe) -> f64 {
    (-44..=44).map(|step| along(lobe, f64::from(step) * (PI / 90.0))).fold(0.0, f64::max)
}

fn along(lobe: &Lobe, theta_out: f64) -> f64 {
    integrate(-0.5 * PI, 0.5 * PI, 1024, |theta_in| {
        let x = (0.5 * (theta_in + theta_out) - lobe.shift_rad) / lobe.width_rad;
        let ratio = libm::cos(theta_in) / libm::cos(0.5 * (theta_in - theta_out)).max(1e-3);
        libm::exp(-0.5 * x * x) * ratio * ratio
    })
}

fn integrate(from: f64, to: f64, steps: u32, f: impl Fn(f64) -> f64) -> f64 {
    let step = (to - from) / f64::from(steps);
    (0..steps).map(|i| f(from + (f64::from(i) + 0.5) * step)).sum::<f64>() * step
}

fn check(parameters: &LobeParameters) -> Result<()> {
    let lobe = |name: &'static str, lobe: &Lobe| {
        [
            (format!("{name}.albedo"), lobe.albedo, 0.0, 1.0),
            (format!("{name}.width_rad"), lobe.width_rad, 0.01, 1.0),
            (format!("{name}.shift_rad"), lobe.shift_rad, -1.0, 1.0),
        ]
    };
    let own = [
        ("tt_azimuth_rad".to_owned(), parameters.tt_azimuth_rad, 0.05, 3.0),
        ("glint".to_owned(), parameters.glint, 0.0, 1.0),
        ("glint_angle_rad".to_owned(), parameters.glint_angle_rad, 0.0, PI),
        ("glint_width_rad".to_owned(), parameters.glint_width_rad, 0.02, 3.0),
        ("diffuse".to_owned(), parameters.diffuse, 0.0, 1.0),
    ];
    let lobes = [lobe("r", &parameters.r), lobe("tt", &parameters.tt), lobe("trt", &parameters.trt)];
    for (field, value, low, high) in lobes.into_iter().flatten().chain(own) {
        if !(low..=high).contains(&value) {
            return Err(Error::usage("a parameter of guard hair's scattering is out of range")
                .with_field(field)
                .with_found(value)
                .with_expected(format!("{low} to {high}")));
        }
    }
    let sum = parameters.r.albedo + parameters.tt.albedo + parameters.trt.albedo + parameters.diffuse;
    if sum > 1.0 + 1e-9 {
        return Err(Error::usage("guard hair would send back more light than it receives")
            .with_field("r.albedo + tt.albedo + trt.albedo + diffuse")
            .with_found(sum)
            .with_expected("at most 1")
            .with_hint("lower diffuse first: it stands for what the lobes leave over"));
    }
    Ok(())
}
