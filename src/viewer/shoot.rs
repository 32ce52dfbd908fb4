//! Pictures taken one after another of one asset, with all that they share made once.

use super::bald::{self, Baldness};
use super::cost::{self, Cost};
use super::subject::subject;
use super::{Shown, ViewOptions, bytes_of, channel, chart, notes, occluder, sitting, stage};
use crate::asset::Asset;
use crate::data::coat::Coat;
use crate::data::subject::Subject;
use crate::error::{Error, Result};
use crate::gpu::Gpu;
use crate::metrics::timing::Recorder;
use crate::runtime::gpu::{KeyShadow, Prepared, Renderer};
use crate::runtime::{Blending, Frame, Picture, Show};
use crate::stage::camera::Viewpoint;
use crate::stage::light::Lit;
use std::time::Instant;

/// A picture that is to be taken.
#[derive(Clone, Debug, PartialEq)]
pub struct Take {
    /// From where.
    pub viewpoint: Viewpoint,
    /// As [`ViewOptions::moment`].
    pub moment: Option<(String, f64)>,
}

/// What is told of pictures when all are taken.
#[derive(Debug)]
pub struct Told {
    /// Times, counts, device.
    pub recorder: Recorder,
    /// What colours mean, one sentence each.
    pub legend: Vec<String>,
    /// What may not be as expected, one sentence each.
    pub notes: Vec<String>,
}

/// Takes pictures of `asset` wearing `coat`; `each` is given them in their order. Those that follow each other in one moment of an animation share
/// its pose.
///
/// # Errors
/// As [`screenshot`](super::screenshot), and as `each`.
pub fn shoot(
    asset: &Asset,
    coat: &Coat,
    options: &ViewOptions,
    takes: &[Take],
    each: &mut dyn FnMut(Picture) -> Result<()>,
) -> Result<Told> {
    if options.occluder.is_some() && !matches!(options.show, Shown::Coat(_)) {
        return Err(Error::usage(format!("{} is shown of the asset alone", options.show))
            .with_parameter("occluder")
            .with_expected("some of skin, shells, fins to `show` beside it"));
    }
    let mut recorder = Recorder::new("");
    let gpu = recorder.step("open device", || Gpu::open(&options.device), |_| 0)?;
    recorder.device(gpu.adapter.to_string());
    let textures = recorder.step(
        "decode textures",
        || stage::textures(asset, coat),
        |decoded| decoded.as_ref().map_or(0, |all| all.images.values().map(bytes_of).sum()),
    )?;
    let renderer = recorder.step(
        "passes and tiles",
        || Renderer::new(&gpu, &coat.tiles, options.samples),
        |renderer| renderer.as_ref().map_or(0, Renderer::tile_bytes),
    )?;
    let subject = subject(asset, coat)?;
    let stage = &options.stage;
    // The studio's light and a chart's turn with the camera; all other stands still.
    let plain = matches!(options.show, Shown::Chart(chart) if chart.plain());
    let turns = plain || stage.lights.is_empty() && stage.environment.is_none();
    let still = if turns {
        None
    } else {
        Some(recorder.step("lights", || stage.lit(&subject, &stage.camera(&subject)?), |_| 0)?)
    };
    let notes = textures.notes.iter().cloned().chain(notes::coarsest(coat, options.level)).collect();
    let mut studio = Studio {
        asset,
        coat,
        options,
        textures,
        renderer: &renderer,
        subject,
        still,
        baldness: Baldness::default(),
        costs: Cost::default(),
        told: Told { recorder, legend: Vec::new(), notes },
    };
    for run in takes.chunk_by(|a, b| a.moment == b.moment) {
        studio.moment(run, each)?;
    }
    Ok(studio.done())
}

/// What all pictures share.
struct Studio<'a> {
    asset: &'a Asset,
    coat: &'a Coat,
    options: &'a ViewOptions,
    textures: stage::Textures,
    renderer: &'a Renderer<'a>,
    subject: Subject,
    /// Light that does not turn with the camera.
    still: Option<Lit>,
    baldness: Baldness,
    costs: Cost,
    told: Told,
}

impl Studio<'_> {
    /// Takes pictures of one pose.
    fn moment(&mut self, takes: &[Take], each: &mut dyn FnMut(Picture) -> Result<()>) -> Result<()> {
        let Self { asset, coat, options, renderer, .. } = *self;
        let (recorder, textures) = (&mut self.told.recorder, &self.textures);
        let pose = match takes.first().and_then(|take| take.moment.as_ref()) {
            Some((name, seconds)) => asset.pose(asset.animation(name)?, *seconds)?,
            None => asset.rest_pose()?,
        };
        let outline = chart::tile_outline();
        let drawing = |chart| {
            let chart::Drawing { scene, legend } = chart::draw(asset, coat, &pose, chart, &outline)?;
            Ok((scene, Show { skin: true, shells: false, fins: false }, legend))
        };
        let staged = || match options.show {
            Shown::Coat(show) => Ok((stage::scene(asset, coat, textures, &pose), show, Vec::new())),
            Shown::Chart(chart) => drawing(chart),
            _ => Ok((stage::scene(asset, coat, textures, &pose), Show::default(), Vec::new())),
        };
        let (mut scene, show, legend) = recorder.step("pose", staged, |_| 0)?;
        options.combing.comb(&mut scene);
        let origin_m = self.subject.origin_m;
        if let Some(thing) = &options.occluder {
            scene.skins.push(occluder::skin(thing, coat.metres_per_unit, origin_m)?);
        }
        let points_m = stage::points_m(&scene);
        let mut prepared = recorder.step(
            "geometry",
            || renderer.prepare(&scene),
            |prepared| prepared.as_ref().map_or(0, Prepared::bytes),
        )?;
        let marked = (options.show == Shown::Bald).then(|| bald::marked(&scene));
        let mut over_skin = marked.as_ref().map(|marked| renderer.prepare(marked)).transpose()?;
        add_new(&mut self.told.legend, legend);
        for take in takes {
            let start = Instant::now();
            let camera = take.viewpoint.camera(&self.subject, options.stage.aspect())?;
            let view = Frame {
                shadow_map: options.shadow_map && !matches!(options.show, Shown::Chart(_)),
                depths: options.depths,
                level: options.level,
                ..sitting::frame(&camera, origin_m, &points_m, options.stage.size, self.lit(&camera)?)
            };
            let recorder = &mut self.told.recorder;
            recorder.row("draw: camera and light", ms_since(start), 0);
            let (mut picture, shadow) = draw(&mut prepared, &view, (show, options.blend), recorder)?;
            if let Some(over_skin) = &mut over_skin {
                let hair = recorder.step("hair over skin", || over_skin.hair_over_skin(&view), |_| 0)?;
                picture = bald::picture(&hair, &picture);
                let here = Baldness::of(&hair);
                self.baldness.furred += here.furred;
                self.baldness.bald += here.bald;
            }
            if let Shown::Channel(channel) = options.show {
                let seen = channel::Seen { renderer, scene: &scene, frame: &view, blend: options.blend };
                let drawn = || channel::draw(channel, &mut prepared, &seen, &picture);
                let (drawn, legend) = recorder.step("channel", drawn, |_| 0)?;
                picture = drawn;
                add_new(&mut self.told.legend, legend);
            }
            if counted(options) {
                let cost = recorder.step("cost", || prepared.cost(&view, show, options.blend), |_| 0)?;
                self.costs.add(&cost, &picture);
                if options.show == Shown::Cost {
                    picture = cost::picture(&cost);
                }
            }
            add_new(&mut self.told.notes, notes::shadow(shadow));
            each(picture)?;
        }
        Ok(())
    }

    fn lit(&self, camera: &crate::data::camera::Camera) -> Result<Lit> {
        let stage = &self.options.stage;
        match (&self.still, self.options.show) {
            (Some(lit), _) => Ok(lit.clone()),
            (None, Shown::Chart(chart)) => {
                let lit = chart::lit(chart, -camera.axes()[2].as_vec3());
                let ambient = stage.ambient.filter(|_| !chart.plain()).unwrap_or(lit.ambient);
                Ok(Lit { ambient, ..lit })
            }
            (None, _) => stage.lit(&self.subject, camera),
        }
    }

    fn done(self) -> Told {
        let Self { options, baldness, costs, mut told, .. } = self;
        if counted(options) {
            let [fragments, reads] = costs.per_covered_pixel();
            told.recorder.mean("fragments_per_covered_pixel", fragments);
            told.recorder.mean("reads_per_covered_pixel", reads);
            if options.show == Shown::Cost {
                told.legend.push(format!(
                    "{reads:.1} texels are read for each pixel that shows anything, by {fragments:.1} fragments: none dark blue, a quarter of {most} blue, \
                     half green, three quarters yellow, {most} and more red",
                    most = cost::MOST_READS
                ));
            }
        }
        if options.show == Shown::Bald {
            told.recorder.count("furred pixels", baldness.furred);
            told.recorder.count("bald pixels", baldness.bald);
            told.legend.push(format!(
                "{:.3} % of the furred skin that is seen is bald (red): less than half of the hair over it that grows there",
                100.0 * baldness.share()
            ));
        }
        told
    }
}

/// Whether what pictures cost is counted.
fn counted(options: &ViewOptions) -> bool {
    options.count && matches!(options.show, Shown::Coat(_)) || options.show == Shown::Cost
}

/// Sentences that do not stand there yet.
fn add_new(told: &mut Vec<String>, more: impl IntoIterator<Item = String>) {
    for sentence in more {
        if !told.contains(&sentence) {
            told.push(sentence);
        }
    }
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
