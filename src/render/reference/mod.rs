//! The renderer's yardstick: f64, by another algorithm, slow and plain (`docs/steps/reference.md`).
//!
//! Many rays per pixel; along each, a hierarchy of hairs and one of prisms are asked for all that lies there, optical depths
//! are integrated until two rules agree, and one of the things met is chosen in proportion to how much of it is seen. What
//! it shares with the renderer is the model: fields, crowding, and the shading formulas.

pub mod bvh;
pub mod guard;
pub mod kind;
pub mod medium;
pub mod quadrature;
pub mod shade;
pub mod shell;
pub mod skin;
pub mod trace;

use super::pelt::{Lighting, Pelt};
use super::view::View;
use crate::data::camera::Camera;
use crate::data::film::Film;
use crate::error::Result;
use crate::fur::undercoat::Pattern;
use crate::math::DVec3;
use crate::math::hash::{combine, unit_f64};
use bvh::Ray;
use guard::Guard;
use medium::Medium;
use rayon::prelude::*;
use shade::{Look, Shader, Shadow};
use skin::Skin;
use trace::{Met, Scratch, Tracer};

/// How much work a reference is worth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Pixels per row and rows.
    pub size: [usize; 2],
    /// Most rays per pixel, at least 1.
    pub samples: usize,
    /// Standard error of a pixel's lightness (CIE L*, 0 to 100) from which more rays are not worth it; 0 for the same count
    /// everywhere.
    pub lightness_error: f64,
    /// Decides where in the pixels rays pass.
    pub seed: u64,
    /// Pattern of the undercoat's density.
    pub pattern: Option<Pattern>,
}

/// Most rays per pixel.
pub const SAMPLES: u32 = 4096;

/// Standard error of lightness that a pixel is given rays for.
const LIGHTNESS_ERROR: f64 = 0.5;

impl Settings {
    /// Of a picture with the renderer's own pattern, as many rays as its pixels need.
    pub fn new(size: [usize; 2]) -> Self {
        Self {
            size,
            samples: SAMPLES as usize,
            lightness_error: LIGHTNESS_ERROR,
            seed: 0,
            pattern: Some(Pattern::default()),
        }
    }
}

/// Rays that tell how many more a pixel needs; they are not part of the picture, so that choosing by them adds no bias.
const PILOT: usize = 24;

/// Work of following a shadow to the light, in rays from the eye.
const FOLLOWING: f64 = 3.0;

/// Least share of rays whose shadow is followed.
const LEAST_SHARE: f64 = 1.0 / 32.0;

/// Renders a picture: what [`super::picture::draw`] should have drawn.
///
/// # Errors
/// Names what keeps the camera from looking anywhere, or a scattering parameter out of range.
pub fn draw(pelt: &Pelt<'_>, lighting: &Lighting, camera: &Camera, settings: &Settings) -> Result<Film> {
    let origin_m = pelt.skin.origin_m;
    View::new(camera, origin_m, settings.size)?;
    let normals = pelt.skin.smooth_normals();
    let skin = Skin::new(pelt.skin);
    let guard = pelt.guard.map(|(strands, _)| Guard::new(strands, pelt.skin));
    let medium = Medium::new(pelt, &normals, settings.pattern);
    let scene = Reference {
        pelt,
        tracer: Tracer { skin: &skin, guard: guard.as_ref(), medium: medium.as_ref() },
        shader: Shader::new(pelt, lighting, medium.as_ref(), &skin, &normals)?,
        lens: Lens::new(camera, origin_m, settings.size),
        settings,
    };
    let [width, height] = settings.size;
    let most = settings.samples.max(1);
    let pixels = if settings.lightness_error <= 0.0 || most <= PILOT {
        scene.pixels(|at, key, scratch| scene.rays(at, key, most, 1.0, scratch))
    } else {
        let pilots: Vec<[f64; 2]> = scene
            .pixels(|at, key, scratch| scene.rays(at, combine(key, 1), PILOT, 1.0, scratch).variances_of_lightness());
        scene.pixels(|at, key, scratch| {
            let (count, share) = scene.wanted(around(at, settings.size).map(|i| pilots[i]));
            scene.rays(at, key, count, share, scratch)
        })
    };
    let mut film = Film::new(width, height);
    for (i, sum) in pixels.into_iter().enumerate() {
        sum.into_film(&mut film, i);
    }
    Ok(film)
}

struct Reference<'a> {
    pelt: &'a Pelt<'a>,
    tracer: Tracer<'a>,
    shader: Shader<'a>,
    lens: Lens,
    settings: &'a Settings,
}

impl Reference<'_> {
    /// What `each` makes of every pixel and its key, rows from the top.
    fn pixels<T: Send>(&self, each: impl Fn([usize; 2], u64, &mut Scratch) -> T + Sync) -> Vec<T> {
        let [width, height] = self.settings.size;
        let pixel = |scratch: &mut Scratch, i: usize| {
            each([i % width, i / width], combine(self.settings.seed, i as u64), scratch)
        };
        (0..width * height).into_par_iter().with_max_len(64).map_init(Scratch::default, pixel).collect()
    }

    /// How many rays a pixel needs, and the share of them whose shadow is to be followed, by the largest of some variances of
    /// lightness: where hair is sparse, a pilot of one pixel alone may have met none.
    fn wanted(&self, variances: impl Iterator<Item = [f64; 2]>) -> (usize, f64) {
        let Settings { samples, lightness_error, .. } = *self.settings;
        let [quick, rest] = variances.fold([0.0_f64; 2], |a, b| [a[0].max(b[0]), a[1].max(b[1])]);
        // The share that makes least work of a given error, where following a shadow takes `FOLLOWING` times a ray's work.
        let share = (rest / (FOLLOWING * quick).max(1e-12)).sqrt().clamp(LEAST_SHARE, 1.0);
        let count = (quick + rest / share) / (lightness_error * lightness_error);
        ((count.ceil() as usize).clamp(PILOT, samples), share)
    }

    /// Sums up `count` rays, of which `share` have their shadow followed.
    fn rays(&self, [x, y]: [usize; 2], key: u64, count: usize, share: f64, scratch: &mut Scratch) -> Sum {
        let mut sum = Sum::default();
        for sample in 0..count as u64 {
            let [u, v, chosen] = evenly(key, sample);
            let ray = self.lens.ray(x as f64 + u, y as f64 + v);
            sum.count += 1.0;
            let followed = ((sample + 1) as f64 * share).floor() > (sample as f64 * share).floor();
            sum.followed += f64::from(u8::from(followed));
            let Some(met) = self.tracer.meet(&ray, chosen, scratch) else { continue };
            let look = self.look(&met, ray.direction, Shadow::Mean);
            sum.add(&met, &look);
            if followed {
                sum.correct(look.radiance, self.look(&met, ray.direction, Shadow::Followed).radiance);
            }
        }
        sum
    }

    fn look(&self, met: &Met, direction: DVec3, shadow: Shadow) -> Look {
        match (met, self.pelt.guard, self.tracer.guard) {
            (Met::Guard(c), Some((strands, _)), Some(g)) => self.shader.guard(strands, g, c, direction, shadow),
            (Met::Undercoat(_, place), _, _) => self.shader.undercoat(place, direction, shadow),
            (Met::Skin(_, place), _, _) => self.shader.skin(place, direction, shadow),
            _ => Look::default(),
        }
    }
}

/// A pixel and those around it.
fn around([x, y]: [usize; 2], [width, height]: [usize; 2]) -> impl Iterator<Item = usize> {
    let near = |at: usize, count: usize| at.saturating_sub(1)..(at + 2).min(count);
    near(y, height).flat_map(move |y| near(x, width).map(move |x| y * width + x))
}

/// Three numbers in [0, 1): point `index` of Roberts' sequence (2018) in three dimensions, moved by what `key` gives.
fn evenly(key: u64, index: u64) -> [f64; 3] {
    // 2⁶⁴ times the first three powers of 1/g, g⁴ = g + 1.
    const STEP: [u64; 3] = [0xD1B5_4A32_D192_ED03, 0xABC9_8388_FB8F_AC02, 0x8CB9_2BA7_2F3D_8DD7];
    [0, 1, 2].map(|i| unit_f64(index.wrapping_mul(STEP[i]).wrapping_add(combine(key, 16 + i as u64))))
}

/// A pinhole camera in f64.
struct Lens {
    eye_m: DVec3,
    axes: [DVec3; 3],
    middle: [f64; 2],
    focal_px: f64,
}

impl Lens {
    fn new(camera: &Camera, origin_m: DVec3, size: [usize; 2]) -> Self {
        let [right, up, back] = camera.axes();
        let middle = size.map(|n| 0.5 * n as f64);
        let focal_px = middle[1] / libm::tan(0.5 * camera.vfov_deg.to_radians());
        Self { eye_m: DVec3::from(camera.eye) - origin_m, axes: [right, up, -back], middle, focal_px }
    }

    fn ray(&self, x: f64, y: f64) -> Ray {
        let across = (x - self.middle[0]) / self.focal_px;
        let down = (y - self.middle[1]) / self.focal_px;
        let direction = self.axes[0] * across - self.axes[1] * down + self.axes[2];
        Ray::new(self.eye_m, direction.normalize())
    }
}

/// Sums over a pixel's rays.
#[derive(Default)]
struct Sum {
    count: f64,
    /// With the shadow in the mean.
    light: DVec3,
    luminance_squared: f64,
    /// Rays whose shadow was followed too.
    followed: f64,
    /// What that changed.
    change: DVec3,
    change_squared: f64,
    look: Look,
    depth_m: f64,
    guard: f64,
    undercoat: f64,
    skin: f64,
}

/// Luminance of linear sRGB primaries (Rec. 709).
fn luminance(colour: DVec3) -> f64 {
    colour.dot(DVec3::new(0.2126, 0.7152, 0.0722))
}

impl Sum {
    fn add(&mut self, met: &Met, look: &Look) {
        self.light += look.radiance;
        self.luminance_squared += luminance(look.radiance) * luminance(look.radiance);
        self.look.albedo += look.albedo;
        self.look.tangent += look.tangent;
        self.look.normal += look.normal;
        let (layer, at_m) = match met {
            Met::Guard(crossing) => (&mut self.guard, crossing.enter_m),
            Met::Undercoat(at_m, _) => (&mut self.undercoat, *at_m),
            Met::Skin(at_m, _) => (&mut self.skin, *at_m),
        };
        *layer += 1.0;
        self.depth_m += at_m;
    }

    /// Adds what following the shadow changes of a ray's radiance.
    fn correct(&mut self, quick: DVec3, followed: DVec3) {
        let change = followed - quick;
        self.change += change;
        self.change_squared += luminance(change) * luminance(change);
    }

    /// Mean radiance: expected is that with shadows followed, whatever the quick ones are.
    fn radiance(&self) -> DVec3 {
        (self.light / self.count + self.change / self.followed.max(1.0)).max(DVec3::ZERO)
    }

    /// Variances of one ray's part in the pixel's lightness: with its shadow in the mean, and of what following it changes.
    /// L* goes with the cube root of luminance.
    fn variances_of_lightness(&self) -> [f64; 2] {
        let slope = 116.0 / 3.0 * libm::pow(luminance(self.radiance()).clamp(0.0, 1.0) + 0.01, -2.0 / 3.0);
        let variance = |sum: DVec3, squared: f64, count: f64| {
            let mean = luminance(sum) / count;
            (squared / count - mean * mean).max(0.0) * count / (count - 1.0) * slope * slope
        };
        [
            variance(self.light, self.luminance_squared, self.count),
            variance(self.change, self.change_squared, self.followed),
        ]
    }

    fn into_film(self, film: &mut Film, i: usize) {
        let met = self.guard + self.undercoat + self.skin;
        let mean = |v: DVec3| (v / self.count).as_vec3();
        film.radiance[i] = self.radiance().as_vec3();
        film.albedo[i] = mean(self.look.albedo);
        film.tangent[i] = mean(self.look.tangent);
        film.normal[i] = mean(self.look.normal);
        film.depth_m[i] = if met > 0.0 { (self.depth_m / met) as f32 } else { 0.0 };
        film.alpha[i] = (met / self.count) as f32;
        film.guard[i] = (self.guard / self.count) as f32;
        film.undercoat[i] = (self.undercoat / self.count) as f32;
    }
}
