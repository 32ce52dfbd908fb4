//! `furrier render`.

use super::axes::AxesArgs;
use super::console::Console;
use super::output;
use super::recipe::UnitName;
use super::stage::StageArgs;
use crate::asset::strands;
use crate::bake::picture::{Grown, Only, PictureRequest};
use crate::data::camera::Camera;
use crate::data::film::Layers;
use crate::error::{Error, Result};
use crate::hybrid::device::{Device, Drawn};
use crate::hybrid::resolve::Blending;
use crate::hybrid::{Picture, Settings};
use crate::math::DVec3;
use crate::metrics::timing::{Report, Steps};
use crate::preset::Preset;
use crate::reference;
use crate::reference::walk::{self, Bounces, Noise, Walked};
use crate::stage::defocus::{self, Lens};
use crate::stage::file::Format;
use crate::stage::options::Options;
use crate::stage::projection::Projection;
use crate::volume::scene::Lighting;
use clap::{Args, ValueEnum};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::Instant;

/// Draw fur hair by hair, over an undercoat followed as a volume
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  furrier render sample:hat -o hat.png --preset mink
  furrier render bunny.glb -o bunny.exr --preset rabbit --quality final --size 1920x1137
  furrier render bunny.glb -o lit.png --env studio.hdr --light dir:-1,-2,-1:5,5,5 --orbit 60,20,1
  furrier render bunny.glb -o guard.png --only guard --report guard.json
  furrier render bunny.glb -o close.png --orbit 30,15,0.4 --f-number 2.8
  furrier render sample:creature -o walk.png --pose walk@0.25
  furrier render bunny.glb -o bunny.png --export-strands bunny.usda
  furrier render bunny.glb -o truth.exr --quality reference --bounces all --lines 256

An .exr holds every layer: radiance, alpha, distance, normal, tangent, albedo, and the parts of guard hair and undercoat.")]
pub struct Render {
    /// A glTF or OBJ file, or sample:NAME
    input: String,
    /// The picture to write: .png or .exr
    #[arg(short, long, value_name = "OUT.png|exr")]
    output: PathBuf,
    /// A built-in preset or a TOML file
    #[arg(long, value_name = "NAME|FILE", default_value = "fox")]
    preset: String,
    /// Change a value of the preset; repeatable
    #[arg(long = "set", value_name = "table.key=value")]
    settings: Vec<String>,
    /// Fur this material alone; repeatable
    #[arg(long = "material", value_name = "NAME")]
    materials: Vec<String>,
    /// What a unit of the file means
    #[arg(long, value_enum, default_value = "auto")]
    units: UnitName,
    #[command(flatten)]
    axes: AxesArgs,
    #[command(flatten)]
    stage: StageArgs,
    /// Let the environment's light fall on the undercoat too, not on guard hair and skin alone
    #[arg(long, requires = "env")]
    env_on_undercoat: bool,
    /// What draws: a hardware GPU where there is one, the CPU, or a GPU, software ones too, by a part of its name
    #[arg(long, value_name = "auto|cpu|gpu[:NAME]", default_value = "auto")]
    device: String,
    /// How much work to spend
    #[arg(long, value_enum, default_value = "preview")]
    quality: Quality,
    /// Follow light from hair to hair in a reference, through so many scatterings at most or through all: an unbiased picture with
    /// noise, which the report tells
    #[arg(long, value_name = "N|all")]
    bounces: Option<BouncesName>,
    /// Lines per pixel of a reference, each looked at whole; where they differ, up to five times as many. With --bounces, the
    /// number of paths per pixel
    #[arg(long, value_name = "N", default_value_t = reference::LINES, value_parser = clap::value_parser!(u32).range(1..))]
    lines: u32,
    /// Where the lines or paths of a reference lie: two pictures of different numbers tell its noise
    #[arg(long, value_name = "N", default_value_t = 0)]
    ray_seed: u64,
    /// Which hair to draw
    #[arg(long, value_enum, default_value = "hybrid")]
    only: Hair,
    /// Blend undercoat as one fragment per ray, faded by hair behind it, with this attenuation in 1/m
    #[arg(long, value_name = "PER_M")]
    simplified: Option<f32>,
    /// Give the camera a lens: the f-number on 35 mm film; without, everything is sharp
    #[arg(long, value_name = "N")]
    f_number: Option<f32>,
    /// The distance that is sharp, m from the eye along its line of sight [default: what stands in the middle]
    #[arg(long, value_name = "M", requires = "f_number")]
    focus: Option<f32>,
    /// Decides all that is random
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Take the pose of an animation, by name or number, at a time into it
    #[arg(long, value_name = "ANIMATION@SECONDS")]
    pose: Option<String>,
    /// Write the guard hairs to this file, as curves in the input's units; undercoat is a volume and has none
    #[arg(long, value_name = "FILE.usda|.hair")]
    export_strands: Option<PathBuf>,
    /// Write times, memory and counts to this JSON file
    #[arg(long, value_name = "FILE.json")]
    report: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Quality {
    /// One sample per pixel; thin hairs are fewer and wider
    Preview,
    /// Four samples per pixel, sixteen in small pictures, shorter steps
    Final,
    /// Another algorithm in f64, ray by ray: minutes to hours, to measure the others by
    Reference,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Hair {
    /// Guard hair
    Guard,
    /// Undercoat
    Undercoat,
    /// Both
    Hybrid,
}

impl Render {
    /// Draws and writes.
    ///
    /// # Errors
    /// Where the input, an option or a parameter cannot be used, or a file not written.
    pub fn run(self, console: &Console) -> Result<()> {
        let format = Format::of(&self.output, "--output")?;
        output::check(&self.output, &[Path::new(&self.input)])?;
        let strands = self.export_strands.as_deref().map(|file| Ok((file, strands::Format::of(file)?))).transpose()?;
        if let Some((file, _)) = &strands {
            output::check(file, &[Path::new(&self.input), &self.output])?;
        }
        if let Some(file) = &self.report {
            let mut others = vec![Path::new(&self.input), &self.output];
            others.extend(strands.map(|(file, _)| file));
            output::check(file, &others)?;
        }
        let stage = Options { environment_on_undercoat: self.env_on_undercoat, ..self.stage.options()? };
        let size = stage.size.map(|n| n as usize);
        self.check_bounces()?;
        let device = self.device.parse::<Device>()?;
        let grown = Grown::new(&self.request()?)?;
        grown.notes.iter().for_each(|note| console.note(note));
        let camera = stage.camera(&grown.subject)?;
        let lighting = Lighting::new(&stage.lit(&grown.subject, &camera)?);
        lighting.notes(grown.scene().skin).iter().for_each(|note| console.note(note));
        self.check_lens()?;
        let mut noise = None;
        let mut drawn = match (self.quality, self.bounces) {
            (Quality::Reference, Some(bounces)) => {
                let (drawn, found) = self.walk(&grown, &lighting, &camera, size, bounces.0)?;
                noise = Some(found);
                drawn
            }
            (Quality::Reference, None) => self.reference(&grown, &lighting, &camera, size)?,
            _ => {
                let layers = match (format, self.f_number) {
                    (Format::Exr, _) => Layers::All,
                    (_, Some(_)) => Layers::LightAndDepth,
                    (_, None) => Layers::Light,
                };
                grown.draw_on(&device, &lighting, &camera, &Settings { layers, ..self.settings_of(size) })?
            }
        };
        drawn.notes.iter().for_each(|note| console.warning(note));
        self.defocus(&mut drawn.picture, &camera, &grown)?;
        let picture = &drawn.picture;
        output::bytes(&self.output, &format.encode(&picture.film, &stage.development)?)?;
        if let Some((file, format)) = strands {
            let name = Path::new(&self.input).file_stem().and_then(|name| name.to_str()).unwrap_or("fur");
            let name = name.strip_prefix("sample:").unwrap_or(name);
            output::bytes(file, &strands::encode(&grown.export(name), format)?)?;
        }
        let report = report(&drawn, noise);
        if let Some(file) = &self.report {
            output::json(file, &report)?;
        }
        console.result(&report, |out| {
            let ms = report["total_ms"].as_f64().unwrap_or(0.0);
            let [width, height] = size;
            let device = &drawn.device;
            writeln!(out, "{}: {width} × {height}, drawn by {device} in {:.1} s", self.output.display(), ms * 1e-3)?;
            let Some(Noise { mean, median_pixel }) = noise else { return Ok(()) };
            let [mean, median] = [mean, median_pixel].map(|error| 100.0 * error);
            writeln!(out, "standard error: {mean:.3} % of the mean luminance, {median:.1} % of a pixel's (median)")
        })
    }

    fn request(&self) -> Result<PictureRequest> {
        Ok(PictureRequest {
            input: self.input.clone(),
            reading: self.axes.reading()?,
            preset: Preset::load(&self.preset)?.with_settings(&self.settings)?,
            materials: self.materials.clone(),
            units: self.units.units(),
            seed: self.seed,
            pose: self.pose.as_deref().map(pose).transpose()?,
            only: match self.only {
                Hair::Guard => Only::Guard,
                Hair::Undercoat => Only::Undercoat,
                Hair::Hybrid => Only::Hybrid,
            },
        })
    }

    fn check_lens(&self) -> Result<()> {
        let refuse = |what: &str, field: &str, found: f32, expected: &str| {
            Err(Error::usage(what).with_field(field).with_found(found).with_expected(expected))
        };
        match (self.f_number, self.focus) {
            (Some(n), _) if !(0.1..=1000.0).contains(&n) => {
                refuse("there is no such lens", "--f-number", n, "0.1 to 1000")
            }
            (_, Some(m)) if !(m > 0.0 && m.is_finite()) => {
                refuse("nothing can be sharp there", "--focus", m, "a distance above 0")
            }
            _ => Ok(()),
        }
    }

    /// Depth of field, where the camera has a lens.
    fn defocus(&self, picture: &mut Picture, camera: &Camera, grown: &Grown) -> Result<()> {
        let Some(f_number) = self.f_number else { return Ok(()) };
        let start = Instant::now();
        let size = [picture.film.width, picture.film.height];
        let view = Projection::new(camera, grown.origin_m(), size)?;
        let target_m = DVec3::from(camera.eye).distance(DVec3::from(camera.target)) as f32;
        let focus_m = self.focus.or_else(|| defocus::middle_depth_m(&picture.film, &view)).unwrap_or(target_m);
        let lens = Lens::of_f_number(f_number, camera.vfov_deg.to_radians() as f32, focus_m);
        picture.film = defocus::defocus(&picture.film, &view, &lens);
        picture.steps.add_since("depth of field", start, 64 * picture.film.alpha.len());
        Ok(())
    }

    fn reference(&self, grown: &Grown, lighting: &Lighting, camera: &Camera, size: [usize; 2]) -> Result<Drawn> {
        let start = Instant::now();
        let settings =
            reference::Settings { lines: self.lines as usize, seed: self.ray_seed, ..reference::Settings::new(size) };
        let film = grown.reference(lighting, camera, &settings)?;
        let mut steps = Steps::default();
        steps.add_since("reference", start, 0);
        let picture = Picture { film, steps, ..Picture::default() };
        Ok(Drawn { picture, device: "cpu".into(), notes: Vec::new() })
    }

    fn check_bounces(&self) -> Result<()> {
        match (self.quality, self.bounces) {
            (Quality::Preview | Quality::Final, Some(_)) => {
                Err(Error::usage("only a reference follows light from hair to hair")
                    .with_field("--bounces")
                    .with_hint("add `--quality reference`"))
            }
            _ => Ok(()),
        }
    }

    /// The picture by paths, and its noise.
    fn walk(
        &self,
        grown: &Grown,
        lighting: &Lighting,
        camera: &Camera,
        size: [usize; 2],
        bounces: Bounces,
    ) -> Result<(Drawn, Noise)> {
        let start = Instant::now();
        let settings = walk::Settings { size, paths: self.lines as usize, bounces, seed: self.ray_seed };
        let Walked { film, noise } = grown.walk(lighting, camera, &settings)?;
        let mut steps = Steps::default();
        steps.add_since("paths", start, 0);
        let picture = Picture { film, steps, ..Picture::default() };
        Ok((Drawn { picture, device: "cpu".into(), notes: Vec::new() }, noise))
    }

    fn settings_of(&self, size: [usize; 2]) -> Settings {
        let mut settings = match self.quality {
            Quality::Final => Settings::best(size),
            Quality::Preview | Quality::Reference => Settings::preview(size),
        };
        if let Some(attenuation_per_m) = self.simplified {
            settings.blending = Blending::Simplified { attenuation_per_m };
        }
        settings
    }
}

/// Reads `ANIMATION@SECONDS`; the name may hold an @ itself.
fn pose(text: &str) -> Result<(String, f64)> {
    let parts = text.rsplit_once('@').and_then(|(name, seconds)| Some((name.to_owned(), seconds.parse().ok()?)));
    parts.filter(|(_, seconds): &(String, f64)| seconds.is_finite()).ok_or_else(|| {
        Error::usage("the pose cannot be read")
            .with_field("--pose")
            .with_found(text)
            .with_expected("ANIMATION@SECONDS: an animation's name or number, and a time")
            .with_hint("`--pose Walk@0.4`, or `--pose 0@0.4` for the first animation")
    })
}

/// How many scatterings are followed, as a command line says it.
#[derive(Clone, Copy, Debug)]
struct BouncesName(Bounces);

impl FromStr for BouncesName {
    type Err = &'static str;

    fn from_str(text: &str) -> std::result::Result<Self, Self::Err> {
        let number = || text.parse().ok().filter(|&most: &u32| most > 0).map(Bounces::Most);
        let bounces = if text == "all" { Some(Bounces::All) } else { number() };
        bounces.map(Self).ok_or("expected a number from 1 on, or all")
    }
}

/// The rows of Andersen et al. 2016, Table 1; `noise` of a picture by paths.
fn report(drawn: &Drawn, noise: Option<Noise>) -> Value {
    let picture = &drawn.picture;
    let counts = &picture.counts;
    let mut report = Report::new(&drawn.device, picture.steps.clone(), picture.steps.total_ms());
    for (name, count) in [
        ("strands", counts.strands),
        ("segments", counts.segments),
        ("fragments", counts.fragments),
        ("steps", counts.steps),
        ("subelements", counts.subelements),
    ] {
        report.count(name, count);
    }
    let mut more = json!({ "notes": drawn.notes, "coverage": picture.film.coverage() });
    if let Some(Noise { mean, median_pixel }) = noise {
        more["noise"] = json!({ "mean": mean, "median_pixel": median_pixel });
    }
    output::report(&report, more)
}
