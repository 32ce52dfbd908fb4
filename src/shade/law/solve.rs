//! From what was counted in slabs to the law's factors.

use super::colour::Colouring;
use super::polynomial::{self, COLOUR_TERMS, SKY_TERMS, TERMS};
use super::slab::{COLOURS, Counted, Slab};
use super::{Law, Place};
use crate::math::solve::positive;
use crate::shade::fibre::Fibre;
use crate::shade::fibre::sample::Sampler;
use rayon::prelude::*;

/// Colours that the law is made for, the lightest first.
pub const SHOWN: [f64; COLOURS] = [0.93, 0.8, 0.62, 0.42, 0.24, 0.12, 0.06, 0.03];
/// Rounds of Newton's method.
const ROUNDS: usize = 12;

/// The law of a fibre; `photons` for light and for the sky each.
pub fn law(fibre: &Fibre, sampler: &Sampler, colouring: &Colouring, photons: usize) -> Law {
    let worn = SHOWN.map(|colour| colouring.worn::<f64>(colour));
    let slab = Slab::new(fibre, sampler, worn.map(|worn| worn.absorption));
    let logits = worn.map(|worn| worn.logit);
    let light = factors::<TERMS>(&slab.lights(photons), &logits, polynomial::light::<f64>);
    let sky = factors::<SKY_TERMS>(&slab.skies(photons / 4), &logits, polynomial::sky::<f64>);
    Law { light, sky }
}

/// A fit for one colour: factors, and how firmly they are held (Fisher's information).
struct Fit {
    factors: Vec<f64>,
    information: Vec<f64>,
}

/// By the likelihood of a Poisson process of this mean: where little was counted it weighs little, and unlike least squares of
/// logarithms it keeps the sum.
fn factors<const N: usize>(
    counted: &[Counted],
    logits: &[f64; COLOURS],
    terms: fn(&Place<f64>) -> [f64; N],
) -> [[f32; COLOUR_TERMS]; N] {
    let rows: Vec<([f64; N], f64)> =
        counted.iter().flat_map(|run| run.places.iter().map(|place| (terms(place), seen(place)))).collect();
    let sent: Vec<&[f64; COLOURS]> = counted.iter().flat_map(|run| &run.sent).collect();
    let fits: Vec<Fit> = (0..COLOURS).into_par_iter().map(|colour| fit(&rows, &sent, colour)).collect();
    // One cubic for all colours that comes nearest to each fit, as firmly as it holds.
    let size = N * COLOUR_TERMS;
    let (mut matrix, mut b) = (vec![0.0; size * size], vec![0.0; size]);
    for (fit, &logit) in fits.iter().zip(logits) {
        let powers = [1.0, logit, logit * logit, logit * logit * logit];
        for i in 0..N {
            let pull: f64 = (0..N).map(|j| fit.information[i * N + j] * fit.factors[j]).sum();
            for (p, power) in powers.iter().enumerate() {
                b[i * COLOUR_TERMS + p] += power * pull;
                for j in 0..N {
                    for (r, other) in powers.iter().enumerate() {
                        matrix[(i * COLOUR_TERMS + p) * size + j * COLOUR_TERMS + r] +=
                            power * other * fit.information[i * N + j];
                    }
                }
            }
        }
    }
    let x = positive(&matrix, &b);
    std::array::from_fn(|i| std::array::from_fn(|p| x[i * COLOUR_TERMS + p] as f32))
}

/// How much of a picture a place is: what lies deep, or is seen from behind, is seen less.
fn seen(place: &Place<f64>) -> f64 {
    let depth = place.above.sqrt() * (libm::exp(-place.above) + 0.05);
    if place.eye_normal < 0.0 { 0.5 * depth } else { depth }
}

fn fit<const N: usize>(rows: &[([f64; N], f64)], sent: &[&[f64; COLOURS]], colour: usize) -> Fit {
    let mean = sent.iter().map(|sent| sent[colour]).sum::<f64>() / sent.len() as f64;
    let mut factors = vec![0.0; N];
    factors[0] = libm::log(mean.max(1e-300));
    let mut information = vec![0.0; N * N];
    for _ in 0..ROUNDS {
        information.fill(0.0);
        let mut pull = vec![0.0; N];
        for ((row, seen), sent) in rows.iter().zip(sent) {
            let exponent: f64 = row.iter().zip(&factors).map(|(t, f)| t * f).sum();
            // Early rounds may overshoot.
            let expected = libm::exp(exponent.clamp(-40.0, 4.0));
            // Per its mean, so that every colour counts alike.
            let (expected, found) = (seen * expected / mean, seen * sent[colour] / mean);
            for i in 0..N {
                pull[i] += row[i] * (found - expected);
                for j in 0..=i {
                    information[i * N + j] += expected * row[i] * row[j];
                }
            }
        }
        for i in 0..N {
            for j in 0..i {
                information[j * N + i] = information[i * N + j];
            }
            information[i * N + i] += 1e-6;
        }
        let step = positive(&information, &pull);
        let longest = step.iter().fold(0.0_f64, |longest, x| longest.max(x.abs()));
        let share = (2.0 / longest).min(1.0);
        factors.iter_mut().zip(step).for_each(|(factor, step)| *factor += share * step);
    }
    Fit { factors, information }
}
