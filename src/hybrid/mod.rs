//! Floor 5: the hybrid renderer (Andersen et al. 2016): guard hair as ribbons over undercoat that is marched through.
//!
//! [`prepare`] makes a scene and its lights ready, once for all cameras; [`device::draw`] draws a [`Picture`] of that on the CPU
//! or on a graphics device, band by band, the same picture on either.

mod cpu;
pub mod device;
pub mod entrances;
pub mod flat;
pub mod gpu;
pub mod guard_light;
mod picture;
pub mod prepared;
pub mod resolve;
mod settings;
pub mod skin;
pub mod strands;
pub mod undercoat_light;

pub use picture::{Counts, Picture};
pub use prepared::{Prepared, prepare};
pub use settings::{MOST_HALVINGS, Settings};

use crate::data::camera::Camera;
use crate::error::Result;
use crate::volume::scene::{Lighting, Scene};

/// Draws one picture on the CPU: [`prepare`] and [`Prepared::draw`] in one, and the steps of both.
///
/// # Errors
/// As those.
pub fn draw(scene: &Scene<'_>, lighting: &Lighting, camera: &Camera, settings: &Settings) -> Result<Picture> {
    prepare(scene, lighting, settings)?.draw_alone(camera)
}

impl Prepared<'_> {
    /// Draws through a camera, on the CPU.
    ///
    /// # Errors
    /// Names what keeps the camera from looking anywhere.
    pub fn draw(&self, camera: &Camera) -> Result<Picture> {
        cpu::draw(self, camera)
    }

    /// [`Self::draw`], with what it took to make this ready among the picture's steps.
    ///
    /// # Errors
    /// As [`Self::draw`].
    pub fn draw_alone(&self, camera: &Camera) -> Result<Picture> {
        let mut picture = self.draw(camera)?;
        picture.steps = self.steps.followed_by(&picture.steps);
        Ok(picture)
    }
}
