//! Photons through a smooth cylinder with a scattering core: where the shares, paths and directions of lobes come from.

use super::FibreParameters;
use crate::math::DVec3;
use crate::math::hash::{combine, unit_f64};
use std::f64::consts::{PI, TAU};

/// Inclinations, even in sin θ.
pub(super) const SLANTS: usize = 12;
/// Photons of each.
const PHOTONS: usize = 12_000;
/// Scatterings and reflections inside after which a photon counts as gone its way.
const MOST_EVENTS: usize = 400;
/// How far forward the medulla scatters (Henyey and Greenstein): mean cosine.
const FORWARD: f64 = 0.4;
/// Absorption per radius at which paths count: of a medium brown.
const BROWN: f64 = 0.4;

/// One class of photons over all inclinations.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Class {
    /// Share of light at each inclination, the least first.
    pub share: [f64; SLANTS],
    /// Path through the fibre in radii, where it is crossed at a right angle.
    pub path: f64,
    /// Mean of cos φ.
    pub cosine: f64,
    /// Mean of cos² φ.
    pub square: f64,
    /// Mean of |φ|, rad.
    pub angle_rad: f64,
    /// Variance of |φ|.
    pub variance: f64,
    /// By how much of itself sin θ_i goes on to −sin θ_o.
    pub along: f64,
}

/// Surface reflection, straight through, once or more reflected inside, scattered.
pub(super) type Classes = [Class; super::LOBES];

/// sin θ of an inclination.
pub(super) fn slant(i: usize) -> f64 {
    (i as f64 + 0.5) / SLANTS as f64
}

#[derive(Default)]
struct Sum {
    count: [f64; SLANTS],
    kept: f64,
    cosine: f64,
    square: f64,
    angle: f64,
    angle2: f64,
    along: [f64; 2],
}

struct Draws(u64, u64);

impl Draws {
    fn unit(&mut self) -> f64 {
        self.1 += 1;
        unit_f64(combine(self.0, self.1))
    }
}

/// Simulates photons without absorption.
pub(super) fn simulate(fibre: &FibreParameters) -> Classes {
    let mut sums: [Sum; super::LOBES] = Default::default();
    for i in 0..SLANTS {
        let sine = slant(i);
        let cosine = (1.0 - sine * sine).sqrt();
        let crossing = 1.0 / (1.0 - sine * sine / f64::from(fibre.index).powi(2)).sqrt();
        for photon in 0..PHOTONS {
            let mut draws = Draws(combine(0xF1B2, (i * PHOTONS + photon) as u64), 0);
            let h = 2.0 * (photon as f64 + draws.unit()) / PHOTONS as f64 - 1.0;
            // The photon comes from +x and goes down the fibre, z.
            let direction = DVec3::new(-cosine, 0.0, -sine);
            let (class, out, path) = follow(fibre, direction, h, &mut draws);
            let sum = &mut sums[class];
            sum.count[i] += 1.0;
            sum.kept += libm::exp(-BROWN * path / crossing);
            let across = libm::hypot(out.x, out.y).max(1e-12);
            let u = out.x / across;
            let phi = libm::acos(u.clamp(-1.0, 1.0));
            sum.cosine += u;
            sum.square += u * u;
            sum.angle += phi;
            sum.angle2 += phi * phi;
            // Directions point away: light's sine is +sine.
            sum.along[0] -= sine * out.z;
            sum.along[1] += sine * sine;
        }
    }
    sums.map(|sum| {
        let n = sum.count.iter().sum::<f64>().max(1e-9);
        let angle_rad = sum.angle / n;
        Class {
            share: sum.count.map(|c| c / PHOTONS as f64),
            path: -libm::log((sum.kept / n).clamp(1e-9, 1.0)) / BROWN,
            cosine: sum.cosine / n,
            square: if n > 1.0 { sum.square / n } else { 0.5 },
            angle_rad,
            variance: (sum.angle2 / n - angle_rad * angle_rad).max(0.0),
            along: sum.along[0] / sum.along[1].max(1e-9),
        }
    })
}

/// Its class, its direction where it leaves, and its path inside in radii.
fn follow(fibre: &FibreParameters, direction: DVec3, h: f64, draws: &mut Draws) -> (usize, DVec3, f64) {
    let index = f64::from(fibre.index);
    let mut at = DVec3::new((1.0 - h * h).max(0.0).sqrt(), h, 0.0);
    if draws.unit() < reflectance(direction.dot(at).abs(), 1.0 / index) {
        return (0, direction - 2.0 * direction.dot(at) * at, 0.0);
    }
    let mut direction = refracted(direction, at, 1.0 / index);
    let (mut reflections, mut scatterings, mut path) = (0, 0, 0.0);
    for _ in 0..MOST_EVENTS {
        let surface_m = leaving(at, direction, 1.0);
        if let Some(distance) = scattered(fibre, at, direction, surface_m, draws) {
            at += direction * distance;
            path += distance;
            direction = turned(direction, draws);
            scatterings += 1;
            continue;
        }
        at += direction * surface_m;
        path += surface_m;
        let normal = DVec3::new(at.x, at.y, 0.0).normalize();
        if draws.unit() >= reflectance(direction.dot(normal).abs(), index) {
            direction = refracted(direction, -normal, index);
            break;
        }
        direction -= 2.0 * direction.dot(normal) * normal;
        reflections += 1;
    }
    let class = if scatterings > 0 { 3 } else { 1 + usize::from(reflections > 0) };
    (class, direction, path)
}

/// Unpolarised Fresnel reflectance; `ratio` is the index in front over that behind... of the side that light comes from.
fn reflectance(cosine: f64, ratio: f64) -> f64 {
    let sine2 = ratio * ratio * (1.0 - cosine * cosine);
    if sine2 >= 1.0 {
        return 1.0;
    }
    let t = (1.0 - sine2).sqrt();
    let (s, p) = ((ratio * cosine - t) / (ratio * cosine + t), (cosine - ratio * t) / (cosine + ratio * t));
    0.5 * (s * s + p * p)
}

/// Through a surface whose normal points to where light comes from.
fn refracted(direction: DVec3, normal: DVec3, ratio: f64) -> DVec3 {
    let cosine = -direction.dot(normal);
    let t = (1.0 - ratio * ratio * (1.0 - cosine * cosine)).max(0.0).sqrt();
    (ratio * direction + (ratio * cosine - t) * normal).normalize()
}

/// Distance from inside a cylinder to its wall.
fn leaving(at: DVec3, direction: DVec3, radius: f64) -> f64 {
    let a = (direction.x * direction.x + direction.y * direction.y).max(1e-12);
    let b = at.x * direction.x + at.y * direction.y;
    let c = at.x * at.x + at.y * at.y - radius * radius;
    ((-b + (b * b - a * c).max(0.0).sqrt()) / a).max(0.0)
}

/// Distance to a scattering in the medulla before the wall, if there is one.
fn scattered(fibre: &FibreParameters, at: DVec3, direction: DVec3, surface: f64, draws: &mut Draws) -> Option<f64> {
    let (radius, rate) = (f64::from(fibre.medulla), f64::from(fibre.scattering));
    let a = (direction.x * direction.x + direction.y * direction.y).max(1e-12);
    let b = at.x * direction.x + at.y * direction.y;
    let root = b * b - a * (at.x * at.x + at.y * at.y - radius * radius);
    if root <= 0.0 || rate <= 0.0 {
        return None;
    }
    let (enter, leave) = (((-b - root.sqrt()) / a).max(0.0), (-b + root.sqrt()) / a);
    let distance = enter - libm::log(1.0 - draws.unit()) / rate;
    (leave > enter && distance < leave.min(surface)).then_some(distance)
}

/// Henyey and Greenstein 1941.
fn turned(direction: DVec3, draws: &mut Draws) -> DVec3 {
    let g = FORWARD;
    let part = (1.0 - g * g) / (1.0 - g + 2.0 * g * draws.unit());
    let cosine = ((1.0 + g * g - part * part) / (2.0 * g)).clamp(-1.0, 1.0);
    let sine = (1.0 - cosine * cosine).sqrt();
    let phi = TAU * draws.unit();
    let (x, y) = direction.any_orthonormal_pair();
    (direction * cosine + (x * libm::cos(phi) + y * libm::sin(phi)) * sine).normalize()
}

/// What a von Mises distribution about 0 of this mean cosine is concentrated by (bisection).
pub(super) fn concentration(mean_cosine: f64) -> f64 {
    let of = |sharpness: f64| {
        let mean = |f: &dyn Fn(f64) -> f64| (0..256).map(|i| f((f64::from(i) + 0.5) * PI / 256.0)).sum::<f64>();
        let weight = |phi: f64| libm::exp(sharpness * (libm::cos(phi) - 1.0));
        mean(&|phi| libm::cos(phi) * weight(phi)) / mean(&weight)
    };
    let (mut low, mut high) = (0.01, 400.0);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if of(middle) < mean_cosine { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}
