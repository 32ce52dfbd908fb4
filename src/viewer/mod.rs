//! Floor 9: pictures of a coat or of how it lies: one, or several around it on a contact sheet.

pub mod bald;
pub mod channel;
pub mod chart;
mod combing;
pub mod cost;
mod notes;
mod occluder;
mod shoot;
mod shown;
pub mod sitting;
pub mod stage;
pub mod subject;

pub use channel::Channel;
pub use chart::Chart;
pub use combing::{Combing, LENGTHS, OUT_OF_LINE, SLANTS_DEG, step_texels};
pub use shoot::Told;
pub use shown::{CHANNELS, Shown, parse_show};

use crate::asset::Asset;
use crate::data::coat::Coat;
use crate::data::image::Image8;
use crate::error::{Error, Result};
use crate::gpu::Choice;
use crate::metrics::timing::Report;
use crate::runtime::{Blending, Picture};
use crate::stage::camera::{Orbit, Viewpoint};
use crate::stage::file::Format;
use crate::stage::{exr, options, png, tone};
use shoot::{Take, shoot};

/// How to look at a coat.
#[derive(Clone, Debug)]
pub struct ViewOptions {
    /// Which adapter draws.
    pub device: Choice,
    /// Camera, light and development.
    pub stage: options::Options,
    /// What to draw.
    pub show: Shown,
    /// Animation by name or number, and seconds into it; `None` is the rest pose.
    pub moment: Option<(String, f64)>,
    /// Shading samples along a pixel's edge, 1 to 8. Edges are sampled four times as often in any case.
    pub samples: u32,
    /// Whether the key light casts the shadow of one limb on another; charts have none.
    pub shadow_map: bool,
    /// Whether the report says what pictures cost, which takes a further pass.
    pub count: bool,
    /// Whether depths are those of hair too, which takes a further pass; else of the skin alone.
    pub depths: bool,
    /// Level of detail, 0 being the finest, or the coarsest there is; none to choose by size.
    pub level: Option<usize>,
    /// How shells and fins come together in a pixel.
    pub blend: Blending,
    /// How the coat is combed anew.
    pub combing: Combing,
    /// A thing beside the asset, in its units and axes. It is no part of what the camera is framed for.
    pub occluder: Option<Asset>,
}

impl Default for ViewOptions {
    fn default() -> Self {
        Self {
            device: Choice::Auto,
            stage: options::Options::default(),
            show: Shown::default(),
            moment: None,
            samples: 1,
            shadow_map: true,
            depths: false,
            level: None,
            count: false,
            blend: Blending::Sorted,
            combing: Combing::default(),
            occluder: None,
        }
    }
}

/// A picture, as light and as a file holds it, and what it cost.
#[derive(Clone, Debug)]
pub struct Shot {
    /// Linear light, premultiplied.
    pub picture: Picture,
    /// Developed: RGBA8 in sRGB coding.
    pub image: Image8,
    /// Steps, counts, device.
    pub report: Report,
    /// What the colours of a chart mean, one sentence each.
    pub legend: Vec<String>,
    /// What may not be as expected, one sentence each.
    pub notes: Vec<String>,
}

impl Shot {
    /// As a file of this kind: developed, or the light and depth as they are.
    ///
    /// # Errors
    /// Where the picture is too large for the format.
    pub fn encode(&self, format: Format) -> Result<Vec<u8>> {
        encode(&self.picture, &self.image, format)
    }
}

/// A picture as a file of this kind: developed, or the light and depth as they are.
///
/// # Errors
/// Where it is too large for the format.
pub fn encode(picture: &Picture, image: &Image8, format: Format) -> Result<Vec<u8>> {
    match format {
        Format::Png => png::encode(image),
        Format::Exr => exr::encode(&picture.film()),
    }
}

/// One picture of `asset` wearing `coat`.
///
/// # Errors
/// [`crate::error::Kind::Device`] without an adapter, naming the package that brings one; [`crate::error::Kind::Usage`] for an
/// unknown animation or a size that does not fit; [`crate::error::Kind::Input`] for broken textures.
pub fn screenshot(asset: &Asset, coat: &Coat, options: &ViewOptions) -> Result<Shot> {
    of_all(asset, coat, options, vec![options.stage.viewpoint.clone()], |mut pictures| pictures.remove(0))
}

/// A contact sheet of `views` pictures, 1 to 64, evenly around the asset, row by row.
///
/// # Errors
/// As [`screenshot`]; [`crate::error::Kind::Usage`] for a number of views out of range, or a camera, which cannot turn.
pub fn turntable(asset: &Asset, coat: &Coat, options: &ViewOptions, views: u32) -> Result<Shot> {
    if !(1..=64).contains(&views) {
        return Err(Error::usage("the number of views is out of range")
            .with_parameter("turntable")
            .with_found(views)
            .with_expected("1 to 64"));
    }
    let columns = f64::from(views).sqrt().ceil() as u32;
    of_all(asset, coat, options, around(options, views)?, |pictures| sheet(&pictures, columns))
}

/// Pictures one after another, 1 to 9999, each given to `each` as light and as a file shows it: over the length of the animation that is asked
/// for, or, where none is or a time in it is (`still`), once around the asset. The last is followed by the first, if the animation is a loop.
///
/// # Errors
/// As [`screenshot`] and as `each`; [`crate::error::Kind::Usage`] for a number of pictures out of range, or a camera, which cannot turn.
pub fn sequence(
    asset: &Asset,
    coat: &Coat,
    options: &ViewOptions,
    (frames, still): (u32, bool),
    each: &mut dyn FnMut(&Picture, &Image8) -> Result<()>,
) -> Result<Told> {
    if !(1..=9999).contains(&frames) {
        return Err(Error::usage("the number of pictures is out of range")
            .with_parameter("frames")
            .with_found(frames)
            .with_expected("1 to 9999"));
    }
    let takes: Vec<Take> = match &options.moment {
        Some((name, _)) if !still => {
            let seconds = asset.animation_seconds(asset.animation(name)?)?;
            let at = |i| seconds * f64::from(i) / f64::from(frames);
            let take = |i| Take { viewpoint: options.stage.viewpoint.clone(), moment: Some((name.clone(), at(i))) };
            (0..frames).map(take).collect()
        }
        _ => {
            let take = |viewpoint| Take { viewpoint, moment: options.moment.clone() };
            around(options, frames)?.into_iter().map(take).collect()
        }
    };
    shoot(asset, coat, options, &takes, &mut |picture| {
        let image = tone::develop(&picture.film(), &options.stage.development);
        each(&picture, &image)
    })
}

/// As many viewpoints evenly around the asset, from that of the options on.
fn around(options: &ViewOptions, views: u32) -> Result<Vec<Viewpoint>> {
    let Viewpoint::Orbit(orbit) = options.stage.viewpoint else {
        return Err(Error::usage("what turns around the asset turns by itself")
            .with_parameter("camera")
            .with_found("a camera")
            .with_expected("no camera, or `orbit`"));
    };
    let turned = |i| Orbit { azimuth_deg: orbit.azimuth_deg + 360.0 * f64::from(i) / f64::from(views), ..orbit };
    Ok((0..views).map(|i| Viewpoint::Orbit(turned(i))).collect())
}

fn bytes_of(image: &Image8) -> u64 {
    image.pixels.len() as u64
}

/// Takes pictures from all `viewpoints` and makes one of them.
fn of_all(
    asset: &Asset,
    coat: &Coat,
    options: &ViewOptions,
    viewpoints: Vec<Viewpoint>,
    joined: impl FnOnce(Vec<Picture>) -> Picture,
) -> Result<Shot> {
    let take = |viewpoint| Take { viewpoint, moment: options.moment.clone() };
    let takes: Vec<Take> = viewpoints.into_iter().map(take).collect();
    let mut pictures = Vec::with_capacity(takes.len());
    let Told { mut recorder, legend, notes } = shoot(asset, coat, options, &takes, &mut |picture| {
        pictures.push(picture);
        Ok(())
    })?;
    let develop = || {
        let picture = joined(pictures);
        let image = tone::develop(&picture.film(), &options.stage.development);
        (picture, image)
    };
    let (picture, image) = recorder.step("draw: develop", develop, |(_, image)| bytes_of(image));
    Ok(Shot { picture, image, report: recorder.finish(), legend, notes })
}

/// Pictures of one size side by side; what is left over at the end is empty.
fn sheet(pictures: &[Picture], columns: u32) -> Picture {
    let [width, height] = pictures[0].size;
    let rows = (pictures.len() as u32).div_ceil(columns);
    let [wide, high] = [width * columns, height * rows];
    let mut pixels = vec![[0.0; 4]; wide as usize * high as usize];
    let mut depth_m = vec![0.0; pixels.len()];
    for (i, picture) in (0..).zip(pictures) {
        let (left, top) = (i % columns * width, i / columns * height);
        for y in 0..height {
            let (from, to) = ((y * width) as usize, ((top + y) * wide + left) as usize);
            let count = width as usize;
            pixels[to..to + count].copy_from_slice(&picture.pixels[from..from + count]);
            depth_m[to..to + count].copy_from_slice(&picture.depth_m[from..from + count]);
        }
    }
    Picture { size: [wide, high], pixels, depth_m }
}
