//! Floor 9: pictures of a coat or of how it lies: one, or several around it on a contact sheet.

pub mod bald;
pub mod channel;
pub mod chart;
pub mod cost;
mod notes;
mod occluder;
mod shown;
pub mod sitting;
pub mod stage;
pub mod subject;

pub use channel::Channel;
pub use chart::Chart;
pub use shown::{CHANNELS, Shown, parse_show};

use crate::asset::Asset;
use crate::data::coat::Coat;
use crate::data::image::Image8;
use crate::error::{Error, Result};
use crate::gpu::{Choice, Gpu};
use crate::metrics::timing::{Recorder, Report};
use crate::runtime::gpu::{KeyShadow, Prepared, Renderer};
use crate::runtime::{Blending, Combing, Frame, Picture, Show};
use crate::stage::camera::{Orbit, Viewpoint};
use crate::stage::file::Format;
use crate::stage::light::Lit;
use crate::stage::{exr, options, png, tone};
use bald::Baldness;
use cost::Cost;
use std::time::Instant;
use subject::subject;

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
        match format {
            Format::Png => png::encode(&self.image),
            Format::Exr => exr::encode(&self.picture.film()),
        }
    }
}

/// One picture of `asset` wearing `coat`.
///
/// # Errors
/// [`crate::error::Kind::Device`] without an adapter, naming the package that brings one; [`crate::error::Kind::Usage`] for an
/// unknown animation or a size that does not fit; [`crate::error::Kind::Input`] for broken textures.
pub fn screenshot(asset: &Asset, coat: &Coat, options: &ViewOptions) -> Result<Shot> {
    let mut shots = shoot(asset, coat, options, std::slice::from_ref(&options.stage.viewpoint))?;
    let picture = shots.pictures.remove(0);
    Ok(shots.developed(picture, options))
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
    let Viewpoint::Orbit(orbit) = options.stage.viewpoint else {
        return Err(Error::usage("a turntable turns by itself")
            .with_parameter("camera")
            .with_found("a camera")
            .with_expected("no camera, or `orbit`"));
    };
    let turned = |i| Orbit { azimuth_deg: orbit.azimuth_deg + 360.0 * f64::from(i) / f64::from(views), ..orbit };
    let viewpoints: Vec<_> = (0..views).map(|i| Viewpoint::Orbit(turned(i))).collect();
    let mut shots = shoot(asset, coat, options, &viewpoints)?;
    let columns = f64::from(views).sqrt().ceil() as u32;
    let picture = shots.recorder.step("draw: sheet", || sheet(&shots.pictures, columns), |_| 0);
    Ok(shots.developed(picture, options))
}

fn bytes_of(image: &Image8) -> u64 {
    image.pixels.len() as u64
}

struct Shots {
    pictures: Vec<Picture>,
    recorder: Recorder,
    legend: Vec<String>,
    notes: Vec<String>,
}

impl Shots {
    fn developed(mut self, picture: Picture, options: &ViewOptions) -> Shot {
        let develop = || tone::develop(&picture.film(), &options.stage.development);
        let image = self.recorder.step("draw: develop", develop, bytes_of);
        Shot { picture, image, report: self.recorder.finish(), legend: self.legend, notes: self.notes }
    }
}

fn shoot(asset: &Asset, coat: &Coat, options: &ViewOptions, viewpoints: &[Viewpoint]) -> Result<Shots> {
    if options.occluder.is_some() && !matches!(options.show, Shown::Coat(_)) {
        return Err(Error::usage(format!("{} is shown of the asset alone", options.show))
            .with_parameter("occluder")
            .with_expected("some of skin, shells, fins to `show` beside it"));
    }
    let mut recorder = Recorder::new("");
    let gpu = recorder.step("open device", || Gpu::open(&options.device), |_| 0)?;
    recorder.device(gpu.adapter.to_string());
    let pose = match &options.moment {
        Some((name, seconds)) => asset.pose(asset.animation(name)?, *seconds)?,
        None => asset.rest_pose()?,
    };
    let textures = recorder.step(
        "decode textures",
        || stage::textures(asset, coat),
        |decoded| decoded.as_ref().map_or(0, |all| all.images.values().map(bytes_of).sum()),
    )?;
    let outline = chart::tile_outline();
    let drawing = |chart| {
        let chart::Drawing { scene, legend } = chart::draw(asset, coat, &pose, chart, &outline)?;
        Ok((scene, Show { skin: true, shells: false, fins: false }, legend))
    };
    let staged = || match options.show {
        Shown::Coat(show) => Ok((stage::scene(asset, coat, &textures, &pose), show, Vec::new())),
        Shown::Chart(chart) => drawing(chart),
        _ => Ok((stage::scene(asset, coat, &textures, &pose), Show::default(), Vec::new())),
    };
    let (mut scene, show, legend) = recorder.step("pose", staged, |_| 0)?;
    options.combing.comb(&mut scene);
    let charted = matches!(options.show, Shown::Chart(_));
    let subject = subject(asset, coat)?;
    let origin_m = subject.origin_m;
    if let Some(thing) = &options.occluder {
        scene.skins.push(occluder::skin(thing, coat.metres_per_unit, origin_m)?);
    }
    let points_m = stage::points_m(&scene);
    let renderer = recorder.step(
        "passes and tiles",
        || Renderer::new(&gpu, &coat.tiles, options.samples),
        |renderer| renderer.as_ref().map_or(0, Renderer::tile_bytes),
    )?;
    let mut prepared = recorder.step(
        "geometry",
        || renderer.prepare(&scene),
        |prepared| prepared.as_ref().map_or(0, Prepared::bytes),
    )?;
    let stage = &options.stage;
    // The studio's light and a chart's turn with the camera; all other stands still.
    let plain = matches!(options.show, Shown::Chart(chart) if chart.plain());
    let turns = plain || stage.lights.is_empty() && stage.environment.is_none();
    let still = if turns {
        None
    } else {
        Some(recorder.step("lights", || stage.lit(&subject, &stage.camera(&subject)?), |_| 0)?)
    };
    let (mut baldness, mut costs) = (Baldness::default(), Cost::default());
    let counted = options.count && matches!(options.show, Shown::Coat(_)) || options.show == Shown::Cost;
    let marked = (options.show == Shown::Bald).then(|| bald::marked(&scene));
    let mut over_skin = marked.as_ref().map(|marked| renderer.prepare(marked)).transpose()?;
    let mut pictures = Vec::with_capacity(viewpoints.len());
    let mut legend = legend;
    let mut notes: Vec<String> = textures.notes.iter().cloned().chain(notes::coarsest(coat, options.level)).collect();
    for viewpoint in viewpoints {
        let start = Instant::now();
        let camera = viewpoint.camera(&subject, stage.aspect())?;
        let lit = if let Some(lit) = &still {
            lit.clone()
        } else if let Shown::Chart(chart) = options.show {
            let lit = chart::lit(chart, -camera.axes()[2].as_vec3());
            Lit { ambient: stage.ambient.filter(|_| !plain).unwrap_or(lit.ambient), ..lit }
        } else {
            stage.lit(&subject, &camera)?
        };
        let view = Frame {
            shadow_map: options.shadow_map && !charted,
            depths: options.depths,
            level: options.level,
            ..sitting::frame(&camera, origin_m, &points_m, stage.size, lit)
        };
        recorder.row("draw: camera and light", ms_since(start), 0);
        let (mut picture, shadow) = draw(&mut prepared, &view, (show, options.blend), &mut recorder)?;
        notes.extend(notes::shadow(shadow).filter(|new| !notes.contains(new)));
        if let Some(over_skin) = &mut over_skin {
            let hair = recorder.step("hair over skin", || over_skin.hair_over_skin(&view), |_| 0)?;
            picture = bald::picture(&hair, &picture);
            let here = Baldness::of(&hair);
            (baldness.furred, baldness.bald) = (baldness.furred + here.furred, baldness.bald + here.bald);
        }
        if let Shown::Channel(channel) = options.show {
            let seen = channel::Seen { renderer: &renderer, scene: &scene, frame: &view, blend: options.blend };
            let drawn = recorder.step("channel", || channel::draw(channel, &mut prepared, &seen, &picture), |_| 0)?;
            picture = drawn.0;
            legend.extend(drawn.1.into_iter().filter(|new| !legend.contains(new)).collect::<Vec<_>>());
        }
        if counted {
            let cost = recorder.step("cost", || prepared.cost(&view, show, options.blend), |_| 0)?;
            costs.add(&cost, &picture);
            if options.show == Shown::Cost {
                picture = cost::picture(&cost);
            }
        }
        pictures.push(picture);
    }
    if counted {
        let [fragments, reads] = costs.per_covered_pixel();
        recorder.mean("fragments_per_covered_pixel", fragments);
        recorder.mean("reads_per_covered_pixel", reads);
        if options.show == Shown::Cost {
            legend.push(format!(
                "{reads:.1} texels are read for each pixel that shows anything, by {fragments:.1} fragments: none dark blue, a quarter of {most} blue, \
                 half green, three quarters yellow, {most} and more red",
                most = cost::MOST_READS
            ));
        }
    }
    if options.show == Shown::Bald {
        recorder.count("furred pixels", baldness.furred);
        recorder.count("bald pixels", baldness.bald);
        legend.push(format!(
            "{:.3} % of the furred skin that is seen is bald (red): less than half of the hair over it that grows there",
            100.0 * baldness.share()
        ));
    }
    Ok(Shots { pictures, recorder, legend, notes })
}

/// Draws one view. What it costs is in the rows that begin with `draw:`, to the last of it; what is in others is paid once.
fn draw(
    prepared: &mut Prepared<'_>,
    view: &Frame,
    (show, blend): (Show, Blending),
    recorder: &mut Recorder,
) -> Result<(Picture, KeyShadow)> {
    let start = Instant::now();
    let drawn = prepared.draw_by(view, show, blend)?;
    let mut on_device = 0.0;
    for pass in &drawn.passes {
        on_device += pass.ms.unwrap_or(0.0);
        recorder.row(&format!("draw: {}", pass.name), pass.ms.unwrap_or(0.0), pass.bytes);
        recorder.count("draw calls", pass.draw_calls);
        recorder.count("triangles", pass.triangles);
    }
    // Where the adapter has no clock, all of the passes stands here.
    recorder.row("draw: wait and read back", ms_since(start) - on_device, drawn.target_bytes);
    recorder.count("pictures", 1);
    recorder.mean("level", f64::from(drawn.level));
    recorder.mean("height_px", f64::from(drawn.height_px));
    Ok((drawn.picture, drawn.shadow))
}

fn ms_since(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
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
