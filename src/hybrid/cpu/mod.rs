//! The hybrid renderer on the CPU: bands of rows, and tiles within them (`docs/steps/strands.md`).

mod bands;
mod compose;
mod film;
mod gather;
mod pass;
mod rasterise;
mod run;
mod scratch;
mod tile;
mod undercoat;

use super::picture::Picture;
use super::prepared::Prepared;
use crate::data::camera::Camera;
use crate::error::Result;
use crate::volume::march::shadows::Shadows;
pub(super) use film::{add, finish};
use pass::Pass;
use std::time::Instant;

/// Draws what was made ready.
///
/// # Errors
/// Names what keeps the camera from looking anywhere.
pub fn draw(prepared: &Prepared<'_>, camera: &Camera) -> Result<Picture> {
    let start = Instant::now();
    let view = prepared.settings.view(camera, prepared.scene.skin.origin_m)?;
    let volume = prepared.volume(&view);
    let shadows = volume.as_ref().map(|v| Shadows::new(v, prepared.mean.as_ref(), prepared.lighting.key));
    let mut picture = Picture::default();
    picture.steps.add_since("shell", start, 0);
    picture.film = Pass::new(prepared, shadows.as_ref(), view).run(&mut picture);
    finish(&mut picture.film, prepared.settings.edge_samples());
    if let Some(shadows) = &shadows {
        let threads = rayon::current_num_threads() as f64;
        let [density_ms, shadow_ms] = [shadows.volume.filling_ms() / threads, shadows.filling_ms() / threads];
        // Both are filled when a march first needs them.
        picture.steps.take("march", density_ms + shadow_ms);
        picture.steps.add("densities", density_ms, shadows.volume.bytes() as u64);
        picture.steps.add("shadows", shadow_ms, shadows.bytes() as u64);
        picture.counts.subelements = shadows.volume.bytes() as u64;
    }
    Ok(picture)
}
