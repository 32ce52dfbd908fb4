//! The renderer's yardstick: f64, by another algorithm, slow and plain (`docs/steps/reference.md`).
//!
//! Some lines per pixel, each cut where hairs begin and cease to be seen; along a ray through each part, all that lies there is
//! put together in exact order. What it shares with the renderer is the
//! model: fields, crowding, and the shading formulas.

pub mod along;
pub mod bvh;
pub mod cone;
pub mod crowd;
pub mod fold;
pub mod guard;
pub mod interval;
pub mod kind;
pub mod lens;
pub mod light;
pub mod line;
pub mod medium;
pub mod point;
pub mod shade;
pub mod shell;
pub mod sight;
pub mod skin;
pub mod sum;
pub mod trace;
pub mod walk;

use crate::data::camera::Camera;
use crate::data::film::Film;
use crate::error::Result;
use crate::fur::undercoat::Pattern;
use crate::math::DVec3;
use crate::math::hash::{combine, unit_f64};
use crate::stage::projection::Projection;
use crate::volume::scene::{Lighting, Scene};
use guard::GuardCones;
use lens::Pinhole;
use medium::DMedium;
use rayon::prelude::*;
use shade::{Appearance, Shader};
use skin::SkinBvh;
use sum::{Pick, Sum, luminance, variance};
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
pub const LINES: u32 = 16;

/// Standard error of lightness above which a pixel is given more.
const LIGHTNESS_ERROR: f64 = 0.15;

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
const LEAST: [f64; 2] = [2e-3, 0.01];

/// Renders a picture: what [`crate::hybrid::draw`] should have drawn.
///
/// # Errors
/// Names what keeps the camera from looking anywhere.
pub fn draw(scene: &Scene<'_>, lighting: &Lighting, camera: &Camera, settings: &Settings) -> Result<Film> {
    let origin_m = scene.skin.origin_m;
    Projection::new(camera, origin_m, settings.size)?;
    let normals = scene.skin.smooth_normals();
    let skin = SkinBvh::new(scene.skin);
    let guard = scene.guard.map(|(strands, _)| GuardCones::new(strands, scene.skin));
    let medium = DMedium::new(scene, &normals, settings.pattern);
    let tracer = Tracer { skin: &skin, guard: guard.as_ref(), medium: medium.as_ref() };
    let shader = Shader::new(scene, lighting, &tracer, &normals);
    let reference = Reference { tracer, shader, lens: Pinhole::new(camera, origin_m, settings.size) };
    let [width, height] = settings.size;
    let all = |key: u64, lines: &(dyn Fn(usize) -> usize + Sync)| -> Vec<Sum> {
        let pixel = |scratch: &mut Scratch, i: usize| {
            reference.pixel([i % width, i / width], combine(key, i as u64), lines(i), scratch)
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
    lens: Pinhole,
}

impl Reference<'_> {
    /// Looks at all lines of a pixel.
    fn pixel(&self, [x, y]: [usize; 2], key: u64, count: usize, scratch: &mut Scratch) -> Sum {
        if count == 0 {
            return Sum::default();
        }
        let pixel = self.lens.pixel([x as f64, y as f64]);
        let column = self.tracer.begin(&pixel, scratch);
        let mut picks = [0_usize, 1].map(|kind| Pick::new(LEAST[kind], unit_f64(combine(key, !(kind as u64)))));
        let mut sum = Sum::of(count);
        let mut bright = Vec::with_capacity(count);
        for i in 0..count {
            let (at, points) = lens::point(i, count, key);
            let key = combine(key, i as u64);
            let line = if column { pixel.column(at) } else { pixel.row(at) };
            let before = luminance(sum.appearance.radiance);
            let depth_m = self.tracer.line(&line, at, &points, combine(key, 1), scratch, |seen, ray, share| {
                sum.cover(seen, share);
                let kind = usize::from(matches!(seen, Seen::Undercoat(_)));
                let weight = picks[kind].weight(share);
                if weight > 0.0 {
                    sum.add(&self.appearance(seen, ray.direction), weight);
                }
            });
            sum.depth_m += depth_m;
            bright.push(luminance(sum.appearance.radiance) - before);
        }
        sum.variance = variance(&bright);
        sum
    }

    fn appearance(&self, seen: &Seen, direction: DVec3) -> Appearance {
        match seen {
            Seen::Guard { strand, along_strand } => self.shader.guard(*strand, *along_strand, direction),
            Seen::Undercoat(point) => self.shader.undercoat(point, direction),
            Seen::Skin(point) => self.shader.skin(point, direction),
        }
    }
}

/// A pixel and those around it.
fn around([x, y]: [usize; 2], [width, height]: [usize; 2]) -> impl Iterator<Item = usize> {
    let near = |at: usize, count: usize| at.saturating_sub(1)..(at + 2).min(count);
    near(y, height).flat_map(move |y| near(x, width).map(move |x| y * width + x))
}
