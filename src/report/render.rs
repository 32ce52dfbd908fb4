//! The hybrid renderer's settings against what they cost.

use super::{Point, mark_front};
use crate::bake::picture::Grown;
use crate::data::camera::Camera;
use crate::data::film::Film;
use crate::error::Result;
use crate::hybrid::resolve::Blending;
use crate::hybrid::{Picture, Settings};
use crate::metrics::compare::{LinearImage, compare};
use crate::metrics::timing::SCHEMA_VERSION;
use crate::volume::march::Stepping;
use crate::volume::march::content::Resolution;
use crate::volume::scene::Lighting;
use serde::Serialize;

/// What errors are measured against, and its own noise.
#[derive(Clone, Debug, Serialize)]
pub struct Yardstick {
    /// What it is.
    pub name: String,
    /// How long it took, ms; none of a picture that was given.
    pub ms: Option<f64>,
}

/// Everything that a sweep found.
#[derive(Clone, Debug, Serialize)]
pub struct Sweep {
    /// Version of the report files' layout.
    pub schema_version: u32,
    /// What was drawn.
    pub input: String,
    /// Pixels.
    pub size: [usize; 2],
    /// What computed, and on how many threads.
    pub device: String,
    /// Of how many runs the quickest counts.
    pub repeats: u32,
    /// What errors are measured against.
    pub yardstick: Yardstick,
    /// One per way to draw it; the defaults of preview and final first.
    pub points: Vec<Point>,
    /// What the defaults of final draw.
    #[serde(skip)]
    pub picture: Film,
}

/// How to sweep.
#[derive(Clone, Debug)]
pub struct Options {
    /// What the report calls the scene.
    pub input: String,
    /// Pixels.
    pub size: [usize; 2],
    /// Where from.
    pub camera: Camera,
    /// What falls on it.
    pub lighting: Lighting,
    /// Runs per point, at least 1; the quickest counts.
    pub repeats: u32,
    /// What to measure against and what it is called, of the same size and view; else the finest setting is.
    pub reference: Option<(String, LinearImage)>,
}

/// A way to draw: what was changed from which defaults, to what.
struct Way {
    sweep: String,
    value: f64,
    settings: Settings,
    defaults: Option<&'static str>,
}

type Change = fn(&mut Settings, f64);

/// Every control of the renderer and the values it is tried at.
const CONTROLS: [(&str, &[f64], Change); 11] = [
    ("optical depth of a step", &[0.05, 0.1, 0.5, 1.0, 2.0], |s, v| s.stepping.depth = v as f32),
    ("length of a step, layers", &[0.125, 0.25, 0.5, 1.0, 4.0, 8.0], |s, v| s.stepping.layers = v as f32),
    ("most subdivisions d", &[0.0, 2.0, 4.0, 5.0, 6.0, 8.0], |s, v| s.resolution.most_subdivisions = v as u32),
    ("edge of a sub-element, px", &[0.75, 3.0, 6.0, 12.0], |s, v| s.resolution.subelement_px = v as f32),
    ("largest sub-element, details", &[1.0, 2.0, 4.0], |s, v| s.resolution.coarsest_details = v as f32),
    ("columns of the mean shadow, heights apart", &[0.05, 0.1, 0.2, 10.0], |s, v| s.shadow_span = v as f32),
    ("layers", &[4.0, 8.0, 32.0, 64.0], |s, v| s.resolution.layers = v as u32),
    ("virtual fragments", &[1.0, 4.0, 8.0, 16.0, 30.0], |s, v| s.blending = Blending::Virtual { fragments: v as u32 }),
    ("simplified blending, a per m", &[0.0, 100.0, 1000.0, 10000.0], |s, v| {
        s.blending = Blending::Simplified { attenuation_per_m: v as f32 };
    }),
    ("least width of hair, px", &[0.0, 0.25, 0.35, 0.5, 0.7, 1.0, 1.4], |s, v| s.hair_px = v as f32),
    ("samples per pixel", &[1.0, 4.0, 16.0], |s, v| s.halvings = (v as u32).ilog2() / 2),
];

/// Draws a scene in every way and compares each picture with the yardstick: the finest setting.
///
/// # Errors
/// As [`Grown::draw`], or where the reference is of another size; `progress` is told what is being drawn.
pub fn sweep(grown: &Grown, options: &Options, progress: &mut dyn FnMut(&str)) -> Result<Sweep> {
    let draw = |settings: &Settings| grown.draw(&options.lighting, &options.camera, settings);
    let drawn;
    let (truth, yardstick) = match &options.reference {
        Some((name, light)) => (light, Yardstick { name: name.clone(), ms: None }),
        None => {
            progress("yardstick");
            let finest = draw(&finest(options.size))?;
            drawn = LinearImage::from(&finest.film);
            (&drawn, Yardstick { name: "the finest setting".into(), ms: Some(ms(&finest)) })
        }
    };
    let (mut points, mut shown) = (Vec::new(), Film::default());
    for way in ways(options.size) {
        progress(&format!("{} = {}", way.sweep, way.value));
        let mut best: Option<Picture> = None;
        for _ in 0..options.repeats.max(1) {
            let picture = draw(&way.settings)?;
            if best.as_ref().is_none_or(|best| ms(&picture) < ms(best)) {
                best = Some(picture);
            }
        }
        if let Some(picture) = best {
            points.push(point(&way, &picture, truth)?);
            if way.defaults == Some("final") {
                shown = picture.film;
            }
        }
    }
    mark_front(&mut points);
    Ok(Sweep {
        schema_version: SCHEMA_VERSION,
        input: options.input.clone(),
        size: options.size,
        device: format!("cpu, {} threads", rayon::current_num_threads()),
        repeats: options.repeats.max(1),
        yardstick,
        points,
        picture: shown,
    })
}

/// Time of all of a picture's steps, ms.
fn ms(picture: &Picture) -> f64 {
    picture.steps.total_ms()
}

fn point(way: &Way, picture: &Picture, truth: &LinearImage) -> Result<Point> {
    let film: &Film = &picture.film;
    let difference = compare(truth, &LinearImage::from(film))?;
    Ok(Point {
        sweep: way.sweep.clone(),
        value: way.value,
        ms: ms(picture),
        bytes: picture.steps.0.iter().map(|step| step.bytes).max().unwrap_or(0),
        flip: difference.flip,
        flip_p95: difference.flip_p95,
        rel_mse: difference.rel_mse,
        bias: difference.bias,
        steps: picture.counts.steps,
        fragments: picture.counts.fragments,
        pareto: false,
        defaults: way.defaults,
    })
}

/// Twice as fine in every control as the finest that is tried, where that can be paid for.
fn finest(size: [usize; 2]) -> Settings {
    Settings {
        halvings: 3,
        blending: Blending::Virtual { fragments: 64 },
        stepping: Stepping { depth: 0.04, layers: 0.125 },
        resolution: Resolution { layers: 64, subelement_px: 0.5, most_subdivisions: 8, ..Resolution::default() },
        shadow_span: 0.05,
        ..Settings { size, ..Settings::default() }
    }
}

/// The defaults, then each with one control changed at a time.
fn ways(size: [usize; 2]) -> Vec<Way> {
    let defaults = [("preview", Settings::preview(size)), ("final", Settings::best(size))];
    let whole = |(name, settings): &(&'static str, Settings)| Way {
        sweep: (*name).to_owned(),
        value: 0.0,
        settings: *settings,
        defaults: Some(name),
    };
    let mut ways: Vec<Way> = defaults.iter().map(whole).collect();
    for (name, settings) in defaults {
        for (control, values, change) in CONTROLS {
            for &value in values {
                let mut changed = settings;
                change(&mut changed, value);
                if changed != settings {
                    ways.push(Way { sweep: format!("{name}: {control}"), value, settings: changed, defaults: None });
                }
            }
        }
    }
    ways
}
