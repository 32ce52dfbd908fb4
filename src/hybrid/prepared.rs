//! A scene made ready: all that does not hang on the camera.

use super::settings::Settings;
use crate::error::Result;
use crate::math::Vec3;
use crate::metrics::timing::Steps;
use crate::stage::projection::Projection;
use crate::volume::march::content::Content;
use crate::volume::march::volume::{Volume, splits};
use crate::volume::mean::MeanShadow;
use crate::volume::scene::{Above, Lighting, Scene};
use std::time::Instant;

/// Skin, hair and lights made ready to be drawn through any camera. Densities and shadows are filled where the first picture needs
/// them.
pub struct Prepared<'a> {
    /// What is drawn.
    pub scene: Scene<'a>,
    /// What lights it.
    pub lighting: &'a Lighting,
    /// How it is drawn.
    pub settings: Settings,
    /// The skin's smooth normals.
    pub normals: Vec<Vec3>,
    /// Hair area above heights.
    pub above: Above,
    /// What fills the shell; none where no undercoat grows.
    pub content: Option<Content<'a>>,
    /// The key light's shadow in the mean; none where nothing grows.
    pub mean: Option<MeanShadow<'a>>,
    /// What this took.
    pub steps: Steps,
}

/// Makes a scene ready.
///
/// # Errors
/// Names a scattering parameter out of range.
pub fn prepare<'a>(scene: &Scene<'a>, lighting: &'a Lighting, settings: &Settings) -> Result<Prepared<'a>> {
    let start = Instant::now();
    let above = Above::new([scene.guard.map(|(_, fibre)| fibre), scene.undercoat]);
    let normals = scene.skin.smooth_normals();
    let (content, mean) = rayon::join(
        || Content::new(scene, &normals, settings.resolution),
        || MeanShadow::new(scene, lighting.mean_direction(scene.skin), settings.shadow_span),
    );
    let mut steps = Steps::default();
    steps.add_since("shell", start, content.as_ref().map_or(0, |content| content.shell.bytes()));
    Ok(Prepared { scene: *scene, lighting, settings: *settings, normals, above, content, mean, steps })
}

impl Prepared<'_> {
    /// The undercoat as finely as `view` resolves it.
    pub(super) fn volume(&self, view: &Projection) -> Option<Volume<'_>> {
        let content = self.content.as_ref()?;
        Some(Volume::new(content, subdivisions(&self.scene, content, view, &self.settings)))
    }
}

/// Subdivisions d per triangle: sub-elements about as large in pixels as asked for, or as finely as clumps need it where
/// that can be stored, but no finer than what there is to see.
fn subdivisions(scene: &Scene<'_>, content: &Content<'_>, view: &Projection, settings: &Settings) -> Vec<u8> {
    let resolution = &settings.resolution;
    let focal_px = view.focal_px / settings.edge_samples() as f32;
    let detail_m = content.shell.undercoat.detail_m();
    let most = resolution.most_subdivisions.min(10);
    let all = |coarsest_m: f32| -> Vec<u8> {
        let of = |t| {
            let nearest_m = scene.skin.corners_m(t).map(|p| view.camera_from_world(p).z);
            let nearest_m = nearest_m.into_iter().fold(f32::INFINITY, f32::min);
            let wanted_m = resolution.subelement_px * nearest_m.max(view.near_m) / focal_px;
            splits(scene.skin.mean_edge_m(t), wanted_m.min(coarsest_m).max(detail_m)).min(most) as u8
        };
        (0..scene.skin.triangles.len()).map(of).collect()
    };
    let fine = all(resolution.coarsest_details * detail_m);
    let bytes = fine.iter().map(|&d| 1_usize << (2 * d)).sum::<usize>() * resolution.layers as usize;
    if bytes <= MOST_FINE_BYTES { fine } else { all(f32::INFINITY) }
}

/// Bytes of density up to which sub-elements are as fine as clumps need them, whatever pixels ask for.
const MOST_FINE_BYTES: usize = 256 << 20;
