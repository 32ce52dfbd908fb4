//! Flat fur of one fibre, in which every scattering is followed: what the law's factors are found from.
//!
//! Depth x is hair area above per skin area. Hair leans in the x–z plane, z is the skin's normal. A ray meets hair of
//! direction t at the rate |sin∠| of it per hair area and way, and scatters as the fibre does; a black skin lies at the bottom.

use super::Place;
use super::polynomial::{LOWEST_EYE, LOWEST_LIGHT};
use crate::math::DVec3;
use crate::math::hash::{combine, unit_f64};
use crate::shade::Angles;
use crate::shade::fibre::Fibre;
use crate::shade::fibre::sample::Sampler;
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// Colours followed at once, as absorptions per radius.
pub const COLOURS: usize = 8;
/// Depths at which light is counted; x at the end of the i-th is `DEEPEST` (i/DEPTHS)².
pub const DEPTHS: usize = 14;
/// Hair area per skin area of a slab.
pub const BOTTOM: f64 = 36.0;
/// Mean leans from the normal, degrees.
const LEANS_DEG: [f64; 6] = [2.0, 15.0, 30.0, 45.0, 57.0, 70.0];
/// Spreads of direction, degrees.
const SPREADS_DEG: [f64; 2] = [6.0, 14.0];
/// Directions of light.
const LIGHTS: usize = 24;
/// Directions of eyes.
const EYES: usize = 24;
/// Events after which a photon is given up; what it still holds is told by none of the figures.
const MOST_EVENTS: usize = 4000;

/// Photons followed one after the other.
const CHUNK: usize = 512;

/// How hair stands in a slab.
#[derive(Clone, Copy, Debug)]
pub struct Stand {
    /// Mean direction.
    pub mean: DVec3,
    /// Standard deviation of direction, rad, along each axis across.
    pub spread_rad: f64,
}

impl Stand {
    /// Leaning by `lean_deg` towards +x.
    pub fn new(lean_deg: f64, spread_deg: f64) -> Self {
        let lean = lean_deg.to_radians();
        Self { mean: DVec3::new(libm::sin(lean), 0.0, libm::cos(lean)), spread_rad: spread_deg.to_radians() }
    }

    /// A hair's direction.
    fn draw(&self, draws: &mut Draws) -> DVec3 {
        let radius = self.spread_rad * (-2.0 * libm::log(1.0 - draws.unit())).sqrt();
        let angle = TAU * draws.unit();
        let (x, y) = self.mean.any_orthonormal_pair();
        (self.mean + radius * (x * libm::cos(angle) + y * libm::sin(angle))).normalize()
    }

    /// Mean |sin∠| to a direction: optical depth per hair area and way.
    fn extinction(&self, direction: DVec3) -> f64 {
        const DRAWS: u64 = 512;
        let mut draws = Draws::new(0x5EED);
        let of = |t: DVec3| (1.0 - t.dot(direction).powi(2)).max(0.0).sqrt();
        (0..DRAWS).map(|_| of(self.draw(&mut draws))).sum::<f64>() / DRAWS as f64
    }
}

/// Random numbers of one photon.
struct Draws {
    state: u64,
}

impl Draws {
    fn new(key: u64) -> Self {
        Self { state: combine(key, 0x51AB) }
    }

    fn unit(&mut self) -> f64 {
        // Weyl's sequence, mixed: one step of SplitMix64.
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        unit_f64(crate::math::hash::mix(self.state))
    }
}

/// What was counted for one stand and one light: by depth, eye and colour, what a hair sends per irradiance.
#[derive(Clone, Debug)]
pub struct Counted {
    /// Where: `above` is filled in by depth.
    pub places: Vec<Place<f64>>,
    /// Depths × eyes × colours.
    pub sent: Vec<[f64; COLOURS]>,
}

/// A fibre in a slab.
pub struct Slab<'a> {
    fibre: &'a Fibre,
    sampler: &'a Sampler,
    absorptions: [f64; COLOURS],
}

/// Depth in the middle of an interval.
pub fn depth_at(i: usize) -> f64 {
    super::polynomial::DEEPEST * ((i as f64 + 0.5) / DEPTHS as f64).powi(2)
}

fn width_at(i: usize) -> f64 {
    let end = |i: usize| super::polynomial::DEEPEST * (i as f64 / DEPTHS as f64).powi(2);
    end(i + 1) - end(i)
}

fn interval(x: f64) -> Option<usize> {
    let i = ((x / super::polynomial::DEEPEST).sqrt() * DEPTHS as f64) as usize;
    (i < DEPTHS).then_some(i)
}

/// Evenly spread directions with cosines to z from `low` to 1, on the side of +y, where all is as on the other.
fn directions(count: usize, low: f64) -> Vec<DVec3> {
    // The golden ratio's sequence.
    let of = |i: usize| {
        let z = low + (1.0 - low) * (i as f64 + 0.5) / count as f64;
        let phi = PI * ((i as f64 * 0.618_033_988_75 + 0.25) % 1.0);
        let r = (1.0 - z * z).max(0.0).sqrt();
        DVec3::new(r * libm::cos(phi), r * libm::sin(phi), z)
    };
    (0..count).map(of).collect()
}

/// All around: eyes on both sides of the light's.
fn eyes() -> Vec<DVec3> {
    let half = directions(EYES, LOWEST_EYE);
    half.into_iter().enumerate().map(|(i, v)| if i % 2 == 0 { v } else { DVec3::new(v.x, -v.y, v.z) }).collect()
}

impl<'a> Slab<'a> {
    /// Of a fibre that absorbs so much, per radius.
    pub fn new(fibre: &'a Fibre, sampler: &'a Sampler, absorptions: [f64; COLOURS]) -> Self {
        Self { fibre, sampler, absorptions }
    }

    /// What a thick coat shows under a white sky, of every colour: what leaves of the light that comes in.
    pub fn albedo(&self, stand: &Stand, photons: usize) -> [f64; COLOURS] {
        let chunk = |first: usize| {
            let mut sum = [0.0; COLOURS];
            for photon in first..(first + CHUNK).min(photons) {
                let mut draws = Draws::new(combine(0xA1BE, photon as u64));
                let from = sky(&mut draws);
                let left = self.follow(stand, -from, 1.0, &mut draws, |_, _, _, _, _| {});
                sum.iter_mut().zip(left).for_each(|(sum, left)| *sum += left);
            }
            sum
        };
        let sums: Vec<_> = (0..photons.div_ceil(CHUNK)).into_par_iter().map(|i| chunk(i * CHUNK)).collect();
        let mut all = [0.0; COLOURS];
        sums.iter().for_each(|sum| all.iter_mut().zip(sum).for_each(|(all, sum)| *all += sum / photons as f64));
        all
    }

    /// Light scattered twice or more, over all stands and lights.
    pub fn lights(&self, photons: usize) -> Vec<Counted> {
        let lights = directions(LIGHTS, LOWEST_LIGHT);
        let runs: Vec<(Stand, usize)> =
            stands().into_iter().flat_map(|stand| (0..LIGHTS).map(move |light| (stand, light))).collect();
        let per_run = photons / runs.len();
        let run = |(run, &(stand, light)): (usize, &(Stand, usize))| {
            let to_light = lights[light];
            let extinction = stand.extinction(to_light) / to_light.z;
            self.count(&stand, per_run, run as u64, 2, to_light, extinction, |_| to_light, to_light.z)
        };
        runs.par_iter().enumerate().with_max_len(1).map(run).collect()
    }

    /// All light of a white sky, over all stands.
    pub fn skies(&self, photons: usize) -> Vec<Counted> {
        let stands = stands();
        let per_run = photons / stands.len();
        let run = |(run, stand): (usize, &Stand)| {
            let key = 0x5117 + run as u64;
            self.count(stand, per_run, key, 1, DVec3::Z, 1.0, sky, PI)
        };
        stands.par_iter().enumerate().with_max_len(1).map(run).collect()
    }

    /// Follows photons that carry `flux` per skin area together, and counts what hairs send of the `from`-th scattering on.
    #[expect(clippy::too_many_arguments, reason = "what a run is made of, told once")]
    fn count(
        &self,
        stand: &Stand,
        photons: usize,
        key: u64,
        from: usize,
        to_light: DVec3,
        extinction: f64,
        source: impl Fn(&mut Draws) -> DVec3,
        flux: f64,
    ) -> Counted {
        let eyes = eyes();
        let seen: Vec<f64> = eyes.iter().map(|&eye| stand.extinction(eye)).collect();
        let mut sent = vec![[0.0; COLOURS]; DEPTHS * EYES];
        for photon in 0..photons as u64 {
            let mut draws = Draws::new(combine(key, photon));
            let direction = -source(&mut draws);
            let mut turn = photon as usize;
            let weight = flux / photons as f64;
            self.follow(stand, direction, weight, &mut draws, |order, x, direction, hair, weights| {
                let Some(depth) = interval(x).filter(|_| order >= from) else { return };
                // One eye stands for all: the next one each time.
                turn = (turn + 7) % EYES;
                let eye = eyes[turn];
                let lit = self.fibre.lit(Angles::of_dvectors(hair, -direction, eye));
                let visible = (1.0 - hair.dot(eye).powi(2)).max(0.0).sqrt() / seen[turn];
                let scale = visible * EYES as f64 / width_at(depth);
                let row = &mut sent[depth * EYES + turn];
                for ((sent, weight), absorption) in row.iter_mut().zip(weights).zip(self.absorptions) {
                    *sent += weight * scale * lit.through(absorption);
                }
            });
        }
        let place = |depth: usize, eye: &DVec3| Place {
            above: depth_at(depth),
            depth: depth_at(depth) * extinction,
            light_hair: to_light.dot(stand.mean),
            eye_hair: eye.dot(stand.mean),
            light_eye: to_light.dot(*eye),
            hair_normal: stand.mean.z,
            eye_normal: eye.z,
            light_normal: to_light.z,
        };
        let places = (0..DEPTHS).flat_map(|depth| eyes.iter().map(move |eye| place(depth, eye))).collect();
        Counted { places, sent }
    }

    /// Follows a photon; `meet` is told its order, depth, direction, the hair it meets and its weights before. What leaves upwards.
    fn follow(
        &self,
        stand: &Stand,
        mut direction: DVec3,
        weight: f64,
        draws: &mut Draws,
        mut meet: impl FnMut(usize, f64, DVec3, DVec3, &[f64; COLOURS]),
    ) -> [f64; COLOURS] {
        let (mut x, mut order) = (0.0, 0);
        let mut weights = [weight; COLOURS];
        for _ in 0..MOST_EVENTS {
            // A hair at a right angle would be met this soon; others let some by.
            x -= direction.z * -libm::log(1.0 - draws.unit());
            if x < 0.0 {
                return weights;
            }
            if x > BOTTOM {
                break;
            }
            let hair = stand.draw(draws);
            if draws.unit() >= (1.0 - hair.dot(direction).powi(2)).max(0.0).sqrt() {
                continue;
            }
            order += 1;
            meet(order, x, direction, hair, &weights);
            // Reciprocal: whence light comes may be drawn for where it goes to.
            let back = -direction;
            let random = [draws.unit(), draws.unit(), draws.unit(), draws.unit()];
            let (out, density) = self.sampler.sample(hair, back, 0.0, random);
            let angles = Angles::of_dvectors(hair, out, back);
            let lit = self.fibre.lit(angles);
            let share = angles.cos_in() / density.max(1e-12);
            for (weight, absorption) in weights.iter_mut().zip(self.absorptions) {
                *weight *= share * lit.through(absorption);
            }
            direction = out;
            if weights[0] < 1e-4 * weight {
                // The lightest colour comes first: play for what is left.
                if draws.unit() < 0.5 {
                    break;
                }
                weights.iter_mut().for_each(|weight| *weight *= 2.0);
            }
        }
        [0.0; COLOURS]
    }
}

fn stands() -> Vec<Stand> {
    LEANS_DEG.iter().flat_map(|&lean| SPREADS_DEG.map(|spread| Stand::new(lean, spread))).collect()
}

/// A direction to the sky, by its share of the light.
fn sky(draws: &mut Draws) -> DVec3 {
    let (r2, phi) = (draws.unit(), TAU * draws.unit());
    let r = r2.sqrt();
    DVec3::new(r * libm::cos(phi), r * libm::sin(phi), (1.0 - r2).max(0.0).sqrt())
}
