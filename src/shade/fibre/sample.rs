//! Random directions of light for a given eye, by tables of the lobes.

use super::{Fibre, LOBES};
use crate::math::DVec3;
use crate::shade::Angles;
use std::f64::consts::PI;

/// Inclinations, for the eye and for light.
const ALONG: usize = 120;
/// Azimuths from 0 to π.
const AROUND: usize = 96;

/// Tables that random directions are drawn from. Densities are constant within a bin, so they are known exactly.
#[derive(Clone, Debug)]
pub struct Sampler {
    /// Per lobe, eye and light: summed shares.
    along: Vec<f64>,
    /// Per lobe: summed shares of azimuths.
    around: Vec<f64>,
    /// Per lobe and eye: share of all light.
    shares: Vec<[f64; LOBES]>,
    /// Paths of the lobes at a right angle.
    paths: [f64; LOBES],
}

fn inclination(i: usize) -> f64 {
    ((i as f64 + 0.5) / ALONG as f64 - 0.5) * PI
}

impl Sampler {
    /// Of a fibre.
    pub fn new(fibre: &Fibre) -> Self {
        let (mut along, mut around) = (Vec::new(), Vec::new());
        let mut shares = vec![[0.0; LOBES]; ALONG];
        let step = PI / ALONG as f64;
        for (p, lobe) in fibre.lobes.iter().enumerate() {
            for (o, share) in shares.iter_mut().enumerate() {
                let (so, co) = (libm::sin(inclination(o)), libm::cos(inclination(o)));
                let mut sum = 0.0;
                let first = along.len();
                for i in 0..ALONG {
                    let (si, ci) = (libm::sin(inclination(i)), libm::cos(inclination(i)));
                    let kernel = lobe.kernel(ci * co - si * so, si * co + ci * so, (ci * co).sqrt());
                    sum += lobe.scale_at(si, ci).max(0.0) * kernel * ci * ci;
                    along.push(sum);
                }
                // A little of every direction, so that none is left out between two bins.
                let least = 1e-4 * sum / ALONG as f64;
                along[first..].iter_mut().enumerate().for_each(|(i, x)| *x += least * (i + 1) as f64);
                let total = along[along.len() - 1];
                along[first..].iter_mut().for_each(|x| *x /= total.max(1e-300));
                share[p] = sum * lobe.scale_at(so, co).max(0.0) * step;
            }
            let first = around.len();
            let mut sum = 0.0;
            for i in 0..AROUND {
                sum += fibre.azimuth.at(libm::cos((i as f64 + 0.5) * PI / AROUND as f64))[p].max(1e-5);
                around.push(sum);
            }
            around[first..].iter_mut().for_each(|x| *x /= sum);
        }
        Self { along, around, shares, paths: fibre.paths.map(f64::from) }
    }

    /// How likely each lobe is chosen for hair that absorbs `absorption` per radius.
    fn chances(&self, eye: usize, absorption: f64) -> [f64; LOBES] {
        let mut chances = self.shares[eye];
        for (chance, path) in chances.iter_mut().zip(self.paths) {
            *chance = *chance * libm::exp(-absorption * path) + 1e-9;
        }
        let sum: f64 = chances.iter().sum();
        chances.map(|chance| chance / sum)
    }

    /// A direction towards light, for hair along `hair` seen from `to_eye`, and its density per solid angle.
    pub fn sample(&self, hair: DVec3, to_eye: DVec3, absorption: f64, random: [f64; 4]) -> (DVec3, f64) {
        let eye = bin(hair.dot(to_eye));
        let chances = self.chances(eye, absorption);
        let (mut lobe, mut left) = (0, random[0]);
        while lobe < LOBES - 1 && left >= chances[lobe] {
            left -= chances[lobe];
            lobe += 1;
        }
        let row = (lobe * ALONG + eye) * ALONG;
        let theta = (draw(&self.along[row..row + ALONG], random[1]) / ALONG as f64 - 0.5) * PI;
        let phi = draw(&self.around[lobe * AROUND..(lobe + 1) * AROUND], random[2]) * PI / AROUND as f64;
        let phi = if random[3] < 0.5 { phi } else { -phi };
        let x = (to_eye - hair * hair.dot(to_eye)).normalize_or(hair.any_orthonormal_vector());
        let y = hair.cross(x);
        let (sine, cosine) = (libm::sin(theta), libm::cos(theta));
        let to_light = hair * sine + (x * libm::cos(phi) + y * libm::sin(phi)) * cosine;
        (to_light, self.density_of(eye, chances, hair, to_eye, to_light))
    }

    /// The density per solid angle with which [`Self::sample`] gives a direction.
    pub fn density(&self, hair: DVec3, to_eye: DVec3, to_light: DVec3, absorption: f64) -> f64 {
        let eye = bin(hair.dot(to_eye));
        self.density_of(eye, self.chances(eye, absorption), hair, to_eye, to_light)
    }

    fn density_of(&self, eye: usize, chances: [f64; LOBES], hair: DVec3, to_eye: DVec3, to_light: DVec3) -> f64 {
        let angles = Angles::of_dvectors(hair, to_light, to_eye);
        let i = bin(angles.sin_in);
        let phi = libm::acos(angles.cos_azimuth.clamp(-1.0, 1.0)) / PI * AROUND as f64;
        let a = (phi as usize).min(AROUND - 1);
        let share = |sums: &[f64], i: usize| sums[i] - if i > 0 { sums[i - 1] } else { 0.0 };
        let per_rad = ALONG as f64 / PI * (AROUND as f64 / PI) * 0.5;
        let mut density = 0.0;
        for (lobe, chance) in chances.into_iter().enumerate() {
            let row = (lobe * ALONG + eye) * ALONG;
            let along = share(&self.along[row..row + ALONG], i);
            density += chance * along * share(&self.around[lobe * AROUND..(lobe + 1) * AROUND], a);
        }
        density * per_rad / angles.cos_in().max(1e-6)
    }
}

fn bin(sine: f64) -> usize {
    let x = libm::asin(sine.clamp(-1.0, 1.0)) / PI + 0.5;
    ((x * ALONG as f64) as usize).min(ALONG - 1)
}

/// A place among summed shares, in bins.
fn draw(sums: &[f64], random: f64) -> f64 {
    let i = sums.partition_point(|&sum| sum <= random).min(sums.len() - 1);
    let before = if i > 0 { sums[i - 1] } else { 0.0 };
    i as f64 + ((random - before) / (sums[i] - before).max(1e-300)).clamp(0.0, 1.0)
}
