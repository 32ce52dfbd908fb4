//! A coat that sits for many pictures: device, textures and geometry are made ready once.

use super::cost::Cost;
use super::stage;
use super::subject::subject;
use crate::asset::Asset;
use crate::data::camera::Camera;
use crate::data::coat::Coat;
use crate::error::Result;
use crate::gpu::{Choice, Gpu};
use crate::math::{DVec3, Vec3};
use crate::runtime::gpu::{Drawn, Prepared, Renderer};
use crate::runtime::{Blending, Frame, Picture, Show};
use crate::stage::camera::depth_range_m;
use crate::stage::light::Lit;

/// An asset and its coat in the rest pose, on a device.
pub struct Sitting<'a> {
    prepared: Prepared<'a>,
    origin_m: DVec3,
    points_m: Vec<Vec3>,
    /// What draws.
    pub device: String,
}

/// Makes `coat` ready on a device and hands it to `work`.
///
/// # Errors
/// [`crate::error::Kind::Device`] without an adapter; [`crate::error::Kind::Input`] for broken textures; and as `work`.
pub fn sit<T>(
    asset: &Asset,
    coat: &Coat,
    device: &Choice,
    work: impl FnOnce(&mut Sitting<'_>) -> Result<T>,
) -> Result<T> {
    let gpu = Gpu::open(device)?;
    let textures = stage::textures(asset, coat)?;
    let scene = stage::scene(asset, coat, &textures, &asset.rest_pose()?);
    let renderer = Renderer::new(&gpu, &coat.tiles, 1)?;
    work(&mut Sitting {
        prepared: renderer.prepare(&scene)?,
        origin_m: subject(asset, coat)?.origin_m,
        points_m: stage::points_m(&scene),
        device: gpu.adapter.to_string(),
    })
}

impl Sitting<'_> {
    /// One picture of skin, shells and fins, in this level of detail or in that which the runtime chooses.
    ///
    /// # Errors
    /// As [`Prepared::draw`].
    pub fn draw(&mut self, camera: &Camera, lit: Lit, size: [u32; 2], level: Option<usize>) -> Result<Drawn> {
        self.prepared.draw(&self.frame(camera, lit, size, level), Show::default())
    }

    /// Texels that are read for each pixel that shows anything in `picture`, which was drawn so.
    ///
    /// # Errors
    /// As [`Prepared::cost`].
    pub fn reads(&mut self, camera: &Camera, lit: Lit, picture: &Picture, level: Option<usize>) -> Result<f64> {
        let counted =
            self.prepared.cost(&self.frame(camera, lit, picture.size, level), Show::default(), Blending::Sorted)?;
        let mut cost = Cost::default();
        cost.add(&counted, picture);
        Ok(cost.per_covered_pixel()[1])
    }

    fn frame(&self, camera: &Camera, lit: Lit, size: [u32; 2], level: Option<usize>) -> Frame {
        Frame { level, ..frame(camera, self.origin_m, &self.points_m, size, lit) }
    }
}

/// What the runtime needs to know of a camera and lights, before which `points_m` lie around `origin_m`.
pub fn frame(camera: &Camera, origin_m: DVec3, points_m: &[Vec3], size: [u32; 2], lit: Lit) -> Frame {
    let [near_m, far_m] = depth_range_m(camera, points_m, origin_m);
    let aspect = f64::from(size[0].max(1)) / f64::from(size[1].max(1));
    Frame {
        clip_from_world: camera.clip_from_world(origin_m, aspect, near_m, far_m).as_mat4(),
        eye: (DVec3::from(camera.eye) - origin_m).as_vec3().extend(1.0),
        size,
        lights: lit.lights,
        ambient: lit.ambient,
        shadow_map: true,
        depths: false,
        level: None,
    }
}
