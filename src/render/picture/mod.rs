//! A picture of a pelt through a camera: bands of rows, and tiles within them (`docs/steps/strands.md`).

mod brush;
mod film;
mod gather;
mod pass;
mod tile;
mod undercoat;

use super::march::Stepping;
use super::march::volume::{Resolution, Volume, splits};
use super::mean::MeanShadow;
use super::pelt::{Lighting, Pelt};
use super::resolve::Blending;
use super::strands::thin::Thinning;
use super::view::View;
use crate::data::camera::Camera;
use crate::data::film::{Film, Layers};
use crate::error::Result;
use crate::fur::undercoat::Undercoat;
use crate::math::DVec3;
pub(in crate::render) use film::{add, finish};
use pass::Pass;
use std::time::Instant;

/// How a picture is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Pixels per row and rows.
    pub size: [usize; 2],
    /// Pixels are drawn as 2^halvings × 2^halvings samples, at most [`MOST_HALVINGS`], and averaged. Andersen et al. 2016 use
    /// four samples.
    pub halvings: u32,
    /// How guard hair and undercoat are ordered.
    pub blending: Blending,
    /// How finely rays are followed through undercoat.
    pub stepping: Stepping,
    /// How finely undercoat is stored.
    pub resolution: Resolution,
    /// How far apart columns of the shadow in the mean stand at most, in heights of the tips; infinite for those over the skin's
    /// vertices alone.
    pub shadow_span: f32,
    /// Width, px, that guard hairs have at least at their roots: where single ones are thinner, fewer are drawn, each wider; 0 draws
    /// every hair as it is.
    pub hair_px: f32,
    /// Transmittance below which what is seen already stands for what is behind it.
    pub opaque: f32,
    /// Memory for the strands of a band of rows, bytes: smaller budgets give more bands and the same picture.
    pub band_bytes: usize,
    /// What the film holds.
    pub layers: Layers,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            size: [512, 512],
            halvings: 0,
            blending: Blending::Virtual { fragments: 8 },
            stepping: Stepping::default(),
            resolution: Resolution::default(),
            shadow_span: 0.1,
            hair_px: 0.0,
            opaque: 1e-3,
            band_bytes: 256 << 20,
            layers: Layers::All,
        }
    }
}

impl Settings {
    /// One sample per pixel, no finer than a first look needs: hair and sub-elements as fine as pixels show them.
    pub fn preview(size: [usize; 2]) -> Self {
        Self {
            size,
            hair_px: 0.5,
            opaque: 0.0125,
            stepping: Stepping { depth: 0.5, layers: 2.0 },
            resolution: Resolution { subelement_px: 3.0, ..Resolution::default() },
            shadow_span: f32::INFINITY,
            ..Self::default()
        }
    }

    /// Andersen et al. 2016's four samples per pixel, or sixteen in small pictures, with shorter steps and more virtual
    /// fragments.
    pub fn best(size: [usize; 2]) -> Self {
        Self {
            size,
            halvings: if size[0] * size[1] <= SMALL { 2 } else { 1 },
            blending: Blending::Virtual { fragments: 8 },
            opaque: 0.004,
            stepping: Stepping { depth: 0.15, layers: 0.25 },
            resolution: Resolution { coarsest_details: 2.0, ..Resolution::default() },
            ..Self::default()
        }
    }

    /// Samples along a pixel's edge.
    pub fn edge_samples(&self) -> usize {
        1 << self.halvings.min(MOST_HALVINGS)
    }

    /// How hair too thin for its pixels is drawn in a view of samples.
    pub(in crate::render) fn thinning(&self, view: &View) -> Thinning {
        Thinning::new(view, self.hair_px * self.edge_samples() as f32)
    }

    /// What the camera shows, sample by sample, of a mesh at `origin_m`.
    ///
    /// # Errors
    /// As [`View::new`].
    pub(in crate::render) fn view(&self, camera: &Camera, origin_m: DVec3) -> Result<View> {
        View::new(camera, origin_m, self.size.map(|n| n * self.edge_samples()))
    }
}

/// Pixels of a picture small enough for them to be wider than clumps are fine, and to cost little.
const SMALL: usize = 1 << 17;

/// Most halvings of a pixel's edge: a tile's 32 samples are then four pixels.
pub const MOST_HALVINGS: u32 = 3;

/// A step's cost: one row of Andersen et al. 2016, Table 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The step.
    pub name: &'static str,
    /// Time, ms. Steps that run tile by tile are given by their share of the threads' time.
    pub ms: f64,
    /// Memory held at most, bytes.
    pub bytes: usize,
}

/// A picture and what it took.
#[derive(Clone, Debug)]
pub struct Picture {
    /// The film.
    pub film: Film,
    /// Time and memory per step.
    pub rows: Vec<Row>,
    /// Strands drawn, pieces and fragments of them, summed over bands.
    pub counts: Counts,
}

/// How much was drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Strands that were not hidden.
    pub strands: u64,
    /// Their pieces.
    pub pieces: u64,
    /// Fragments of guard hair composited.
    pub fragments: u64,
    /// Steps through undercoat.
    pub steps: u64,
    /// Sub-elements filled.
    pub subelements: u64,
}

/// Renders a picture.
///
/// # Errors
/// Names what keeps the camera from looking anywhere, or a scattering parameter out of range.
pub fn draw(pelt: &Pelt<'_>, lighting: &Lighting, camera: &Camera, settings: &Settings) -> Result<Picture> {
    let mut picture = Picture { film: Film::default(), rows: Vec::new(), counts: Counts::default() };
    let normals = pelt.skin.smooth_normals();
    let start = Instant::now();
    let view = settings.view(camera, pelt.skin.origin_m)?;
    let subdivisions = subdivisions(pelt, &view, settings);
    let to_light = lighting.key.to_light;
    let (volume, mean) = rayon::join(
        || Volume::new(pelt, &normals, to_light, settings.resolution, subdivisions),
        || MeanShadow::new(pelt, to_light, settings.shadow_span),
    );
    row(&mut picture, "shell", start, volume.as_ref().map_or(0, |v| v.shell().bytes()));
    let thinning = settings.thinning(&view);
    let scene = Pass::new(pelt, lighting, &normals, volume.as_ref(), mean.as_ref(), view, thinning, settings)?;
    picture.film = scene.run(&mut picture);
    finish(&mut picture.film, settings.edge_samples());
    if let Some(volume) = &volume {
        let [density, shadow] = volume.bytes();
        let share = 1.0 / rayon::current_num_threads() as f64;
        let [density_ms, shadow_ms] = volume.filling_ms();
        // Both are filled when a march first needs them.
        if let Some(march) = picture.rows.iter_mut().find(|row| row.name == "march") {
            march.ms = (march.ms - (density_ms + shadow_ms) * share).max(0.0);
        }
        picture.rows.push(Row { name: "densities", ms: density_ms * share, bytes: density });
        picture.rows.push(Row { name: "shadows", ms: shadow_ms * share, bytes: shadow });
        picture.counts.subelements = density as u64;
    }
    Ok(picture)
}

/// Subdivisions d per triangle: sub-elements about as large in pixels as asked for, or as finely as clumps need it where
/// that can be stored, but no finer than what there is to see.
pub(in crate::render) fn subdivisions(pelt: &Pelt<'_>, view: &View, settings: &Settings) -> Vec<u8> {
    let Some(fibre) = pelt.undercoat else { return Vec::new() };
    let resolution = &settings.resolution;
    let focal_px = view.focal_px / settings.edge_samples() as f32;
    let detail_m = Undercoat::new(fibre, resolution.pattern).detail_m();
    let most = resolution.most_subdivisions.min(10);
    let all = |coarsest_m: f32| -> Vec<u8> {
        let of = |t| {
            let nearest_m = pelt.skin.corners_m(t).map(|p| view.camera_from_world(p).z);
            let nearest_m = nearest_m.into_iter().fold(f32::INFINITY, f32::min);
            let wanted_m = resolution.subelement_px * nearest_m.max(view.near_m) / focal_px;
            splits(pelt.skin.mean_edge_m(t), wanted_m.min(coarsest_m).max(detail_m)).min(most) as u8
        };
        (0..pelt.skin.triangles.len()).map(of).collect()
    };
    let fine = all(resolution.coarsest_details * detail_m);
    let bytes = fine.iter().map(|&d| 1_usize << (2 * d)).sum::<usize>() * resolution.layers as usize;
    if bytes <= MOST_FINE_BYTES { fine } else { all(f32::INFINITY) }
}

/// Bytes of density up to which sub-elements are as fine as clumps need them, whatever pixels ask for.
const MOST_FINE_BYTES: usize = 256 << 20;

/// Rows of steps that ran tile by tile since `start`, by their shares of the threads' time.
fn shares<const N: usize>(picture: &mut Picture, start: Instant, parts: [(&'static str, u64); N]) {
    let all_ns: u64 = parts.iter().map(|(_, ns)| ns).sum();
    let ms = start.elapsed().as_secs_f64() * 1e3;
    for (name, ns) in parts {
        add_row(picture, name, ms * ns as f64 / all_ns.max(1) as f64, 0);
    }
}

/// Gives what was filled of the mean shadow since it had taken `before_ms` a row of its own, out of the step that needed it.
fn mean_row(picture: &mut Picture, step: &str, mean: Option<&MeanShadow<'_>>, before_ms: f64) {
    let Some(mean) = mean else { return };
    let ms = (mean.filling_ms() - before_ms) / rayon::current_num_threads() as f64;
    if let Some(row) = picture.rows.iter_mut().find(|row| row.name == step) {
        row.ms = (row.ms - ms).max(0.0);
    }
    add_row(picture, "mean shadow", ms, mean.bytes());
}

fn row(picture: &mut Picture, name: &'static str, start: Instant, bytes: usize) {
    add_row(picture, name, start.elapsed().as_secs_f64() * 1e3, bytes);
}

fn add_row(picture: &mut Picture, name: &'static str, ms: f64, bytes: usize) {
    match picture.rows.iter_mut().find(|row| row.name == name) {
        Some(row) => {
            row.ms += ms;
            row.bytes = row.bytes.max(bytes);
        }
        None => picture.rows.push(Row { name, ms, bytes }),
    }
}
