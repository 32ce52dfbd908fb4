//! Light followed from hair to hair: paths from the eye, every scattering up to a number or all (`docs/steps/walk.md`).
//!
//! In goes what [`crate::reference::draw`] takes, and how each kind of hair scatters ([`scatter::Scatter`]); out comes a film that
//! is right in the mean, and how noisy it is. Guard hairs are the round cones, undercoat the volume and skin the triangles of the
//! reference beside it; nothing is shared with it beyond those but the lights.

mod formulas;
mod hairs;
mod noise;
mod path;
pub mod scatter;
mod site;
mod space;
mod tree;

pub use formulas::FibreWalk;
pub use noise::Noise;
pub use site::Fibres;

use super::lens::{Pinhole, PinholePixel};
use super::medium::DMedium;
use super::shade::Appearance;
use super::skin::SkinBvh;
use super::sum::Sum;
use super::trace::Seen;
use crate::data::camera::Camera;
use crate::data::film::Film;
use crate::error::Result;
use crate::fur::undercoat::Pattern;
use crate::math::hash::{Stream, combine, unit_f64};
use crate::math::{DVec3, Vec3};
use crate::stage::projection::Projection;
use crate::volume::scene::{Lighting, Scene};
use hairs::Hairs;
use noise::Spread;
use path::Walker;
use rayon::prelude::*;
use site::Sites;
use space::{Met, Scratch, Space};

/// How many scatterings are followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bounces {
    /// So many at most, at least 1: light that met hair or skin once, and so on.
    Most(u32),
    /// All.
    All,
}

impl Bounces {
    /// Whether no more are followed after so many.
    pub(crate) fn end_at(self, scatterings: u32) -> bool {
        matches!(self, Self::Most(most) if scatterings >= most)
    }
}

/// How much work a picture is worth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Pixels per row and rows.
    pub size: [usize; 2],
    /// Paths per pixel, at least 1.
    pub paths: usize,
    /// How many scatterings are followed.
    pub bounces: Bounces,
    /// Chooses the paths.
    pub seed: u64,
}

impl Settings {
    /// All scatterings.
    pub fn new(size: [usize; 2]) -> Self {
        Self { size, paths: super::LINES as usize, bounces: Bounces::All, seed: 0 }
    }
}

/// A picture and how sure it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Walked {
    /// The picture.
    pub film: Film,
    /// Its noise.
    pub noise: Noise,
}

/// Paths that one thread follows at a time.
const BLOCK: usize = 256;

/// A scene made ready for walks.
#[derive(Debug)]
pub struct Ready<'a> {
    scene: &'a Scene<'a>,
    normals: &'a [Vec3],
    skin: SkinBvh,
    guard: Option<Hairs<'a>>,
    medium: Option<DMedium<'a>>,
}

impl<'a> Ready<'a> {
    /// Sorts a scene's hair and skin; `normals` are the skin's smooth ones.
    pub fn new(scene: &'a Scene<'a>, normals: &'a [Vec3], pattern: Option<Pattern>) -> Self {
        Self {
            scene,
            normals,
            skin: SkinBvh::new(scene.skin),
            guard: scene.guard.map(|(strands, _)| Hairs::new(strands, scene.skin)),
            // Where all hair is met one by one, there is no volume.
            medium: scene.undercoat.and_then(|_| DMedium::new(scene, normals, pattern)),
        }
    }
}

/// Renders a picture with hair that scatters by the scene's own formulas.
///
/// # Errors
/// Names what keeps the camera from looking anywhere.
pub fn draw(scene: &Scene<'_>, lighting: &Lighting, camera: &Camera, settings: &Settings) -> Result<Walked> {
    let normals = scene.skin.smooth_normals();
    let ready = Ready::new(scene, &normals, Some(Pattern::default()));
    draw_ready(&ready, lighting, camera, settings)
}

/// The same of a scene made ready before.
///
/// # Errors
/// Names what keeps the camera from looking anywhere.
pub fn draw_ready(ready: &Ready<'_>, lighting: &Lighting, camera: &Camera, settings: &Settings) -> Result<Walked> {
    let hair = ready.scene.scattering;
    let [guard, undercoat] = [&hair.guard, &hair.undercoat].map(FibreWalk::new);
    draw_with(ready, Fibres { guard: &guard, undercoat: &undercoat }, lighting, camera, settings)
}

/// Renders a picture with hair that scatters as `fibres` do.
///
/// # Errors
/// Names what keeps the camera from looking anywhere.
pub fn draw_with(
    ready: &Ready<'_>,
    fibres: Fibres<'_>,
    lighting: &Lighting,
    camera: &Camera,
    settings: &Settings,
) -> Result<Walked> {
    let Ready { scene, normals, skin, guard, medium } = ready;
    let origin_m = scene.skin.origin_m;
    Projection::new(camera, origin_m, settings.size)?;
    let slope = scene.undercoat.map_or(0.0, |fibre| libm::tan(f64::from(fibre.shape.jitter_deg).to_radians()));
    let walker = Walker {
        space: Space { skin, guard: guard.as_ref(), medium: medium.as_ref() },
        sites: Sites { scene, normals, fibres, slope },
        lighting,
        bounces: settings.bounces,
    };
    let lens = Pinhole::new(camera, origin_m, settings.size);
    let [width, height] = settings.size;
    let paths = settings.paths.max(1);
    let pixel = |i: usize| {
        let pixel = lens.pixel([(i % width) as f64, (i / width) as f64]);
        let key = combine(settings.seed, i as u64);
        let blocks: Vec<(Sum, Spread)> = (0..paths.div_ceil(BLOCK))
            .into_par_iter()
            .map_init(Scratch::default, |scratch, block| {
                let from = block * BLOCK;
                walker.paths(&pixel, from..(from + BLOCK).min(paths), key, scratch)
            })
            .collect();
        // In order, so that any number of threads gives the same sum.
        blocks.iter().fold((Sum::default(), Spread::default()), |mut all, block| {
            all.0.add_all(&block.0);
            all.1.add_all(&block.1);
            all
        })
    };
    let (sums, spreads): (Vec<Sum>, Vec<Spread>) = (0..width * height).into_par_iter().map(pixel).unzip();
    let mut film = Film::new(width, height);
    for (i, sum) in sums.into_iter().enumerate() {
        sum.into_film(&mut film, i);
    }
    Ok(Walked { film, noise: Noise::new(&spreads) })
}

impl Walker<'_> {
    /// Follows some of a pixel's paths.
    fn paths(
        &self,
        pixel: &PinholePixel<'_>,
        which: std::ops::Range<usize>,
        key: u64,
        scratch: &mut Scratch,
    ) -> (Sum, Spread) {
        let (mut sum, mut spread) = (Sum::of(which.len()), Spread::default());
        for i in which {
            let mut random = Stream::new(combine(key, 1 + i as u64));
            let [x, y] = spot(i, key);
            let ray = pixel.row(y).ray(x);
            let mut radiance = DVec3::ZERO;
            if let Some((at_m, met, site)) = self.first(&ray, &mut random, scratch) {
                let (albedo, tangent, normal) = (site.colour, site.tangent, site.normal);
                radiance = self.radiance(site, &mut random, scratch);
                sum.cover(&seen(&met), 1.0);
                sum.add(&Appearance { radiance, albedo, tangent, normal }, 1.0);
                sum.depth_m += at_m;
            }
            spread.add(radiance);
        }
        (sum, spread)
    }
}

fn seen(met: &Met) -> Seen {
    match *met {
        Met::Guard(crossing) => Seen::Guard { strand: crossing.strand, along_strand: crossing.along_strand },
        Met::Undercoat(point) => Seen::Undercoat(point),
        Met::Skin(point) => Seen::Skin(point),
    }
}

/// Where in a pixel path `i` begins: shares of the plastic number's powers (Roberts 2018, R₂), shifted at random, so that any
/// number of paths share the pixel evenly.
fn spot(i: usize, key: u64) -> [f64; 2] {
    const STEPS: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_3];
    [0, 1].map(|axis: usize| (unit_f64(combine(key, !(axis as u64))) + STEPS[axis] * i as f64).fract())
}
