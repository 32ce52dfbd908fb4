//! Scales a symmetric kernel such that it sends back a given share of light for every direction, and stays symmetric.

use super::{FibreLobe, SCALE_TERMS};
use crate::math::solve::least_squares;
use std::f64::consts::PI;

/// Directions along the hair.
const STEPS: usize = 180;
/// Greatest softness: shares change with Fresnel's law near the poles, however wide a lobe is.
const MOST_SOFT: f64 = 0.5;
/// Rounds of scaling for a first guess: each halves what is left over, about.
const ROUNDS: usize = 6;
/// Rounds of Gauss and Newton's method then.
const REFINEMENTS: usize = 8;

fn theta(i: usize) -> f64 {
    ((i as f64 + 0.5) / STEPS as f64 - 0.5) * PI
}

/// Terms of D.
fn terms(sine: f64, cosine: f64, softness: f64) -> [f64; SCALE_TERMS] {
    let per = 1.0 / (cosine + softness);
    let q = softness * per;
    [1.0, q, q * q, q * q * q, cosine, sine, sine * q, sine * q * q, sine * cosine].map(|term| term * per)
}

/// Shares of light by direction along the hair.
pub(super) type Shares = Vec<f64>;

/// A function of sin θ, for every direction along the hair.
pub(super) fn shares(of: impl Fn(f64) -> f64) -> Shares {
    (0..STEPS).map(|i| of(libm::sin(theta(i))).max(1e-9)).collect()
}

fn directions() -> Vec<[f64; 2]> {
    (0..STEPS).map(|i| [libm::sin(theta(i)), libm::cos(theta(i))]).collect()
}

/// cos² θ_i dθ_i times the kernel, in rows of one eye.
fn kernel_of(lobe: &FibreLobe, directions: &[[f64; 2]]) -> Vec<f64> {
    let step = PI / STEPS as f64;
    let row = |&[so, co]: &[f64; 2]| {
        let of = move |&[si, ci]: &[f64; 2]| {
            let level = (ci * co).sqrt();
            lobe.kernel(ci * co - si * so, si * co + ci * so, level) * ci * ci * step
        };
        directions.iter().map(of).collect::<Vec<_>>()
    };
    directions.iter().flat_map(row).collect()
}

/// What a lobe sends back of all light.
pub(super) fn sent(lobe: &FibreLobe) -> Shares {
    let directions = directions();
    let d: Vec<f64> = directions.iter().map(|&[s, c]| lobe.scale_at(s, c)).collect();
    let kernel = kernel_of(lobe, &directions);
    kernel.chunks(STEPS).zip(&d).map(|(row, here)| here * row.iter().zip(&d).map(|(k, d)| k * d).sum::<f64>()).collect()
}

/// A lobe of variance `variance` that sends back these shares of all light, without colour, before it is tilted by `tilt_rad`.
///
/// D(θ_o) ∫ K(θ_i, θ_o) D(θ_i) cos² θ_i dθ_i = ρ(θ_o) is solved for the factors of D's terms: a first guess by Sinkhorn and
/// Knopp's scaling (1967, symmetric), then least squares of the relative error over all θ_o. A tilted lobe is solved without
/// its tilt: narrow and tilted it cannot be reciprocal and have the same share on both sides, as light that it takes from a
/// low angle to a high one leaves through a wider cone than it came by.
pub(super) fn scaled(tilt_rad: f64, variance: f64, shares: &Shares) -> FibreLobe {
    fitted(tilt_rad, variance, shares, shares)
}

/// The same where errors count over `by`: those of a lobe that is little of all light need not be as small as its share is.
pub(super) fn fitted(tilt_rad: f64, variance: f64, shares: &Shares, by: &Shares) -> FibreLobe {
    let start = FibreLobe {
        tilt: 0.0,
        sharpness: (1.0 / variance) as f32,
        softness: libm::sqrt(variance).min(MOST_SOFT) as f32,
        scale: [0.0; SCALE_TERMS],
    };
    let directions = directions();
    let kernel = kernel_of(&start, &directions);
    let softness = f64::from(start.softness);
    let own: Vec<[f64; SCALE_TERMS]> = directions.iter().map(|&[s, c]| terms(s, c, softness)).collect();
    // A first guess, fitted by relative error: where D is small it is seen as well as where it is large.
    let mut d: Vec<f64> = shares.iter().map(|share| libm::sqrt(*share)).collect();
    for _ in 0..ROUNDS {
        let sums: Vec<f64> = kernel.chunks(STEPS).map(|row| row.iter().zip(&d).map(|(k, d)| k * d).sum()).collect();
        d.iter_mut().zip(shares).zip(&sums).for_each(|((d, share), sum)| *d = libm::sqrt(*d * share / sum.max(1e-300)));
    }
    let rows: Vec<_> = own.iter().zip(&d).map(|(terms, d)| (terms.map(|t| t / d), 1.0)).collect();
    let mut scale = least_squares(&rows);
    for _ in 0..REFINEMENTS {
        let rows: Vec<_> = (0..STEPS)
            .map(|o| {
                let row = &kernel[o * STEPS..(o + 1) * STEPS];
                let mut sums = [0.0; SCALE_TERMS];
                for (k, terms) in row.iter().zip(&own) {
                    sums.iter_mut().zip(terms).for_each(|(sum, t)| *sum += k * t);
                }
                let (here, around) = (dot(&scale, &own[o]), dot(&scale, &sums));
                // By how much the sent share changes with each factor, and what is missing of it.
                let change: [f64; SCALE_TERMS] = std::array::from_fn(|t| (here * sums[t] + own[o][t] * around) / by[o]);
                (change, (shares[o] - here * around) / by[o])
            })
            .collect();
        let step = least_squares(&rows);
        scale.iter_mut().zip(step).for_each(|(factor, step)| *factor += step);
    }
    FibreLobe { tilt: libm::sin(2.0 * tilt_rad) as f32, scale: scale.map(|x| x as f32), ..start }
}

fn dot(a: &[f64; SCALE_TERMS], b: &[f64; SCALE_TERMS]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
