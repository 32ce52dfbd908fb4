//! Fibres from what a preset says.

use super::azimuth::{Around, Azimuth};
use super::scale::{fitted, scaled, sent, shares};
use super::simulate::{self, Class, SLANTS, concentration, simulate};
use super::{Fibre, FibreLobe, FibreModel, FibreParameters, LOBES};
use crate::math::solve::least_squares;
use std::f64::consts::PI;

impl Fibre {
    /// Of a model, which the parameters describe where it is `medulla`.
    pub fn new(model: FibreModel, parameters: &FibreParameters) -> Self {
        match model {
            FibreModel::Medulla => medullated(parameters),
            FibreModel::Sadeghi => sadeghi(),
            FibreModel::KajiyaKay => kajiya_kay(0.9, 0.05, 8.0),
        }
    }
}

/// Variances of θ_i + θ_o of the three lobes of the cuticle (Chiang et al. 2016, eq. 7 and Marschner's halves and doubles).
fn variances(roughness: f64) -> [f64; 3] {
    let b = roughness;
    let v = (0.726 * b + 0.812 * b * b + 3.7 * libm::pow(b, 20.0)).powi(2);
    [v, 0.25 * v, 4.0 * v]
}

/// Variance around the hair, rad² (Chiang et al. 2016, eq. 8: a logistic of this scale).
fn azimuthal_variance(roughness: f64) -> f64 {
    let b = roughness;
    let scale = 0.265 * b + 1.194 * b * b + 5.372 * libm::pow(b, 22.0);
    (scale * PI).powi(2) / 3.0
}

/// Least variance along the hair of what the medulla scatters.
const LEAST_MEDULLA: f64 = 0.3;

/// A cylinder of keratin around a scattering core.
fn medullated(p: &FibreParameters) -> Fibre {
    let classes = simulate(p);
    let [surface, through, inner, medulla] = &classes;
    let around = azimuthal_variance(f64::from(p.azimuthal_roughness));
    let reflectance = ((f64::from(p.index) - 1.0) / (f64::from(p.index) + 1.0)).powi(2);
    let azimuth = Azimuth::new(&Around {
        mirror: reflectance,
        through: concentration((-through.cosine).max(0.01) * libm::exp(-0.5 * around)),
        inner: [0.0, 0.0],
        glint_sharpness: 1.0 / (inner.variance + around).max(0.01),
        glint_rad: inner.angle_rad,
        medulla: [medulla.cosine, medulla.square],
    });
    let tilt = f64::from(p.tilt_deg).to_radians();
    let [r, tt, trt] = variances(f64::from(p.roughness));
    let own = if medulla.along > 1e-3 { (0.25 / medulla.along).max(LEAST_MEDULLA) } else { EVEN };
    // Without a medulla the fourth lobe is what the others leave over, which goes through as they do.
    let own_path = if medulla.share.iter().sum::<f64>() > 0.0 { medulla.path } else { through.path };
    let lobe = |class: &Class, tilt, variance| scaled(tilt, variance, &shares(|sine| at(&class.share, sine)));
    let cuticle = [lobe(surface, -tilt, r), lobe(through, 0.5 * tilt, tt), lobe(inner, 1.5 * tilt, trt)];
    Fibre {
        lobes: filled(cuticle, own, 1.0),
        paths: [surface.path, through.path, inner.path, own_path].map(|path| path as f32),
        azimuth,
        inverse_index_squared: 1.0 / (p.index * p.index),
    }
}

/// Lobes, and a fourth that sends back what they leave over of `albedo`: without a medulla too, tilted lobes leave a little.
fn filled(lobes: [FibreLobe; 3], variance: f64, albedo: f64) -> [FibreLobe; LOBES] {
    let sum: Vec<f64> = lobes.iter().map(sent).fold(Vec::new(), |sum, own| {
        if sum.is_empty() { own } else { sum.iter().zip(own).map(|(a, b)| a + b).collect() }
    });
    // Where they send more than that, all of them send less.
    let most = sum.iter().fold(0.0_f64, |most, &x| most.max(x));
    let less = (albedo * (1.0 - LEFT_OVER) / most).min(1.0);
    let lobes = lobes.map(|lobe| FibreLobe { scale: lobe.scale.map(|x| x * less.sqrt() as f32), ..lobe });
    let rest: Vec<f64> = sum.iter().map(|x| (albedo - x * less).max(1e-9)).collect();
    // Errors of what all lobes send together are to be small.
    let mean = rest.iter().sum::<f64>() / rest.len() as f64;
    let by = rest.iter().map(|rest| 0.5 * (rest + mean)).collect();
    let [a, b, c] = lobes;
    [a, b, c, fitted(0.0, variance, &rest, &by)]
}

/// Least share of light that is left to the fourth lobe.
const LEFT_OVER: f64 = 0.002;

/// Least share at any inclination, of the mean one.
const LEAST_SHARE: f64 = 0.1;

/// A smooth curve through simulated shares, at an inclination: a polynomial of cos θ.
fn at(shares: &[f64; SLANTS], sine: f64) -> f64 {
    let terms = |sine: f64| {
        let c = (1.0 - sine * sine).max(0.0).sqrt();
        [1.0, c, c * c, c * c * c]
    };
    let rows: Vec<_> = shares.iter().enumerate().map(|(i, &share)| (terms(simulate::slant(i)), share)).collect();
    let curve = least_squares(&rows);
    let mean = shares.iter().sum::<f64>() / SLANTS as f64;
    curve.iter().zip(terms(sine)).map(|(a, b)| a * b).sum::<f64>().max(LEAST_SHARE * mean)
}

/// A lobe of Sadeghi et al. 2010: albedo, shift and width along the hair in degrees.
type ArtistLobe = [f64; 3];

/// Their brunette: R, TT and TRT, with the cuticle's tilt of 3 to 5° that Marschner et al. 2003 measured.
const BRUNETTE: [ArtistLobe; 3] = [[0.08, -4.0, 6.0], [0.12, 2.0, 5.0], [0.2, 6.0, 11.0]];
/// Albedo of what is scattered all around.
const DIFFUSE: f64 = 0.5;

/// Sadeghi et al. 2010, with what their lobes leave over as light that is scattered all around. Widths are of (θ_i + θ_o)/2.
fn sadeghi() -> Fibre {
    let lobe = |&[albedo, shift, width]: &ArtistLobe| {
        scaled(shift.to_radians(), (2.0 * width.to_radians()).powi(2), &shares(|_| albedo))
    };
    let albedo = DIFFUSE + BRUNETTE.iter().map(|lobe| lobe[0]).sum::<f64>();
    let [r, tt, trt] = &BRUNETTE;
    Fibre {
        lobes: filled([lobe(r), lobe(tt), lobe(trt)], EVEN, albedo),
        paths: [0.0, 1.0, 2.0, 1.0],
        azimuth: Azimuth::new(&Around {
            mirror: 1.0,
            through: 1.0 / 30.0_f64.to_radians().powi(2),
            inner: [0.75, 0.0],
            glint_sharpness: 1.0 / 10.0_f64.to_radians().powi(2),
            glint_rad: 35.0_f64.to_radians(),
            medulla: [0.0, 0.5],
        }),
        inverse_index_squared: 0.0,
    }
}

/// Variance of a lobe that is the same all along the hair.
const EVEN: f64 = 250.0;

/// Kajiya and Kay 1989: `diffuse` tinted, `specular` on the mirror cone, the same all around.
fn kajiya_kay(diffuse: f64, specular: f64, exponent: f64) -> Fibre {
    Fibre {
        lobes: [
            FibreLobe { softness: 1.0, ..FibreLobe::default() },
            FibreLobe { softness: 1.0, ..FibreLobe::default() },
            scaled(0.0, 1.0 / exponent, &shares(|_| specular)),
            scaled(0.0, EVEN, &shares(|_| diffuse)),
        ],
        paths: [0.0, 0.0, 0.0, 1.0],
        azimuth: Azimuth::new(&Around {
            mirror: 1.0,
            through: 1.0,
            inner: [0.0, 1.0],
            glint_sharpness: 1.0,
            glint_rad: 0.0,
            medulla: [0.0, 0.5],
        }),
        inverse_index_squared: 0.0,
    }
}
