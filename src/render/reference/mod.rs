//! The renderer's yardstick: f64, by another algorithm, slow and plain (`docs/steps/reference.md`).
//!
//! Some lines per pixel, each cut where hairs begin and cease to be seen; along a ray through each part, all that lies there is
//! put together in exact order, optical depths integrated until two rules agree. What it shares with the renderer is the
//! model: fields, crowding, and the shading formulas.

pub mod along;
pub mod bvh;
pub mod cone;
pub mod crowd;
pub mod guard;
pub mod kind;
pub mod line;
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
use guard::Guard;
use line::Line;
use medium::Medium;
use rayon::prelude::*;
use shade::{Look, Shader};
use skin::Skin;
use trace::{Scratch, Seen, Tracer};

/// How much work a reference is worth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Pixels per row and rows.
    pub size: [usize; 2],
    /// Lines per pixel, at least 1.
    pub lines: usize,
    /// Standard error of a pixel's lightness (CIE L*, 0 to 100) above which it is given more lines; infinite for the same count
    /// everywhere.
    pub lightness_error: f64,
    /// Decides where in the pixels lines lie.
    pub seed: u64,
    /// Pattern of the undercoat's density.
    pub pattern: Option<Pattern>,
}

/// Lines per pixel, at first.
pub const LINES: u32 = 8;

/// Standard error of lightness above which a pixel is given more.
const LIGHTNESS_ERROR: f64 = 0.3;

/// Times as many as at first that it is given at most.
const MOST: f64 = 4.0;

impl Settings {
    /// Of a picture with the renderer's own pattern.
    pub fn new(size: [usize; 2]) -> Self {
        Self {
            size,
            lines: LINES as usize,
            lightness_error: LIGHTNESS_ERROR,
            seed: 0,
            pattern: Some(Pattern::default()),
        }
    }
}

/// What takes less than this share of a line is shaded as seldom as it takes less, and then counts for this share: guard hair
/// and skin, and undercoat, whose shadows are not kept.
const LEAST: [f64; 2] = [2e-3, 0.03];

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
    let tracer = Tracer { skin: &skin, guard: guard.as_ref(), medium: medium.as_ref() };
    let shader = Shader::new(pelt, lighting, &tracer, &normals)?;
    let scene = Reference { tracer, shader, lens: Lens::new(camera, origin_m, settings.size) };
    let [width, height] = settings.size;
    let all = |key: u64, lines: &(dyn Fn(usize) -> usize + Sync)| -> Vec<Sum> {
        let pixel = |scratch: &mut Scratch, i: usize| {
            scene.pixel([i % width, i / width], combine(key, i as u64), lines(i), scratch)
        };
        (0..width * height).into_par_iter().with_max_len(64).map_init(Scratch::default, pixel).collect()
    };
    let mut sums = all(settings.seed, &|_| settings.lines.max(1));
    // As many lines more as the pixels around a pixel need: chosen without a look at its own, so that no bias is added.
    let errors: Vec<f64> = sums.iter().map(Sum::lightness_error).collect();
    let more = all(combine(settings.seed, 1), &|i| {
        let around = around([i % width, i / width], settings.size).filter(|&j| j != i);
        let error = around.map(|j| errors[j]).fold(0.0, f64::max);
        let wanted = settings.lines as f64 * (error / settings.lightness_error.max(1e-6) - 1.0);
        if settings.lines >= 2 { wanted.clamp(0.0, MOST * settings.lines as f64).round() as usize } else { 0 }
    });
    sums.iter_mut().zip(&more).for_each(|(sum, more)| sum.join(more));
    let mut film = Film::new(width, height);
    for (i, sum) in sums.into_iter().enumerate() {
        sum.into_film(&mut film, i);
    }
    Ok(film)
}

struct Reference<'a> {
    tracer: Tracer<'a>,
    shader: Shader<'a>,
    lens: Lens,
}

impl Reference<'_> {
    /// Looks at all lines of a pixel.
    fn pixel(&self, [x, y]: [usize; 2], key: u64, count: usize, scratch: &mut Scratch) -> Sum {
        if count == 0 {
            return Sum::default();
        }
        let corner = [x as f64, y as f64];
        let column = self.tracer.lies_across(&self.lens.row(corner, 0.5), &self.lens.column(corner, 0.5), scratch);
        let mut picks = [0_usize, 1]
            .map(|kind| Pick { least: LEAST[kind], passed: LEAST[kind] * unit_f64(combine(key, !(kind as u64))) });
        let mut sum = Sum { lines: count as f64, ..Sum::default() };
        let mut before = None;
        for i in 0..count {
            let key = combine(key, i as u64);
            let at = (i as f64 + unit_f64(key)) / count as f64;
            let line = if column { self.lens.column(corner, at) } else { self.lens.row(corner, at) };
            let depth_m = self.tracer.line(&line, combine(key, 1), scratch, |seen, ray, share| {
                sum.cover(seen, share);
                let kind = usize::from(matches!(seen, Seen::Undercoat(_)));
                let weight = picks[kind].weight(share);
                if weight > 0.0 {
                    sum.add(&self.look(seen, ray.direction), weight);
                }
            });
            sum.depth_m += depth_m;
            sum.compare(&mut before);
        }
        sum
    }

    fn look(&self, seen: &Seen, direction: DVec3) -> Look {
        match seen {
            Seen::Guard { strand, knot } => self.shader.guard(*strand, *knot, direction),
            Seen::Undercoat(place) => self.shader.undercoat(place, direction),
            Seen::Skin(place) => self.shader.skin(place, direction),
        }
    }
}

/// Chooses evenly among small shares: whenever their sum passes a multiple of the least.
struct Pick {
    least: f64,
    passed: f64,
}

impl Pick {
    /// What a share counts for: it is the share in the mean, and 0 or no less than the least.
    fn weight(&mut self, share: f64) -> f64 {
        if share >= self.least {
            return share;
        }
        self.passed += share;
        if self.passed < self.least {
            return 0.0;
        }
        self.passed -= self.least;
        self.least
    }
}

/// A pixel and those around it.
fn around([x, y]: [usize; 2], [width, height]: [usize; 2]) -> impl Iterator<Item = usize> {
    let near = |at: usize, count: usize| at.saturating_sub(1)..(at + 2).min(count);
    near(y, height).flat_map(move |y| near(x, width).map(move |x| y * width + x))
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

    fn direction(&self, x: f64, y: f64) -> DVec3 {
        let across = (x - self.middle[0]) / self.focal_px;
        let down = (y - self.middle[1]) / self.focal_px;
        self.axes[0] * across - self.axes[1] * down + self.axes[2]
    }

    /// A row of the pixel with this corner.
    fn row(&self, [x, y]: [f64; 2], at: f64) -> Line {
        Line { eye_m: self.eye_m, base: self.direction(x, y + at), step: self.axes[0] / self.focal_px }
    }

    /// A column of it.
    fn column(&self, [x, y]: [f64; 2], at: f64) -> Line {
        Line { eye_m: self.eye_m, base: self.direction(x + at, y), step: -self.axes[1] / self.focal_px }
    }
}

/// Luminance of linear sRGB primaries (Rec. 709).
fn luminance(colour: DVec3) -> f64 {
    colour.dot(DVec3::new(0.2126, 0.7152, 0.0722))
}

/// Sums over a pixel's lines.
#[derive(Default)]
struct Sum {
    lines: f64,
    /// Σ of the squared differences of luminance between a line and the one before.
    unlike: f64,
    look: Look,
    depth_m: f64,
    guard: f64,
    undercoat: f64,
    skin: f64,
}

impl Sum {
    fn add(&mut self, look: &Look, share: f64) {
        self.look.radiance += look.radiance * share;
        self.look.albedo += look.albedo * share;
        self.look.tangent += look.tangent * share;
        self.look.normal += look.normal * share;
    }

    fn cover(&mut self, seen: &Seen, share: f64) {
        *match seen {
            Seen::Guard { .. } => &mut self.guard,
            Seen::Undercoat(_) => &mut self.undercoat,
            Seen::Skin(_) => &mut self.skin,
        } += share;
    }

    /// Takes note of how unlike the last line is to the one before, whose sum this was.
    fn compare(&mut self, before: &mut Option<[f64; 2]>) {
        let sum = luminance(self.look.radiance);
        let line = sum - before.map_or(0.0, |[sum, _]| sum);
        if let Some([_, last]) = *before {
            self.unlike += (line - last) * (line - last);
        }
        *before = Some([sum, line]);
    }

    /// Standard error of the pixel's lightness (CIE L*, 0 to 100), which goes with the cube root of luminance.
    fn lightness_error(&self) -> f64 {
        let count = self.lines.max(2.0);
        let slope = 116.0 / 3.0 * libm::pow(luminance(self.look.radiance) / count + 1e-3, -2.0 / 3.0);
        (0.5 * self.unlike / (count - 1.0) / count).sqrt() * slope
    }

    /// Adds other lines of the pixel.
    fn join(&mut self, other: &Self) {
        self.lines += other.lines;
        self.look.radiance += other.look.radiance;
        self.look.albedo += other.look.albedo;
        self.look.tangent += other.look.tangent;
        self.look.normal += other.look.normal;
        self.depth_m += other.depth_m;
        self.guard += other.guard;
        self.undercoat += other.undercoat;
        self.skin += other.skin;
    }

    fn into_film(self, film: &mut Film, i: usize) {
        let met = self.guard + self.undercoat + self.skin;
        let part = 1.0 / self.lines.max(1.0);
        let mean = |v: DVec3| (v * part).as_vec3();
        film.radiance[i] = mean(self.look.radiance);
        film.albedo[i] = mean(self.look.albedo);
        film.tangent[i] = mean(self.look.tangent);
        film.normal[i] = mean(self.look.normal);
        film.depth_m[i] = if met > 0.0 { (self.depth_m / met) as f32 } else { 0.0 };
        film.alpha[i] = (met * part) as f32;
        film.guard[i] = (self.guard * part) as f32;
        film.undercoat[i] = (self.undercoat * part) as f32;
    }
}
