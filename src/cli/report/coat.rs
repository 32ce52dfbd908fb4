//! `furrier report coat`.

use super::checked_outputs;
use crate::asset::coat::{Fallback, read_coat};
use crate::asset::write;
use crate::bake::picture::{Only, PictureRequest};
use crate::bake::{Method, Request, bake};
use crate::cli::bake::{Layout, UnitName};
use crate::cli::compare::check_limit;
use crate::cli::console::Console;
use crate::cli::output;
use crate::cli::stage::size;
use crate::coat::summary::summarise;
use crate::error::{Error, Kind, Result};
use crate::gpu::Choice;
use crate::hybrid::device::Device;
use crate::metrics::compare::LinearImage;
use crate::metrics::timing::SCHEMA_VERSION;
use crate::preset::Preset;
use crate::report::coat::keep::{Cost, Drawing, Keep};
use crate::report::coat::key::Key;
use crate::report::coat::summary::Group;
use crate::report::coat::{Fur, Options, Report, look, table, views};
use crate::stage::png;
use crate::stage::rig::Rig;
use crate::viewer::sitting::sit;
use clap::Args;
use serde_json::{Value, json};
use std::path::PathBuf;
use std::time::Instant;

/// Look at a coat from many sides beside the fur that it stands for
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  furrier report coat sample:hat -o hat.json --preset mink --views 4 --distances 1,4
  furrier report coat bunny.glb -o bunny.json --distances 1:8,0.35:2,2:2,4:2,8:2 --lights studio,rim
  furrier report coat sample:torus -o torus.json --preset sheep --size 256x256 --max-flip 0.05

The coat is baked and drawn as `view` draws it, the fur as `render --quality final` does, in one light and through one camera. \
Beside hat.json stand hat.csv, hat.svg and hat.png: per light and distance three rows, render, coat and FLIP, a column per view. \
hat.parts/ keeps finished pictures: a report that was stopped goes on where it was, and a render is drawn again only where what it \
shows has changed. docs/steps/report-coat.md says what is measured.")]
pub struct Coat {
    /// A .glb, .gltf or .obj file, or sample:NAME
    input: String,
    /// The report to write; a .csv, a .svg, a .png and a folder .parts go beside it
    #[arg(short, long, value_name = "OUT.json")]
    output: PathBuf,
    /// A built-in preset or a TOML file
    #[arg(long, value_name = "NAME|FILE", default_value = "fox")]
    preset: String,
    /// Change a value of the preset; repeatable
    #[arg(long = "set", value_name = "TABLE.KEY=VALUE")]
    settings: Vec<String>,
    /// Fur this material alone; repeatable
    #[arg(long = "material", value_name = "NAME")]
    materials: Vec<String>,
    /// What one unit of the file is
    #[arg(long, value_enum, default_value_t = UnitName::Auto)]
    units: UnitName,
    /// How the skin is laid out in the plane, as `bake` does it
    #[arg(long, value_enum, default_value_t = Layout::Lapped)]
    parameterisation: Layout,
    /// Layers, the opaque skin included: overrides the preset's shells.layers
    #[arg(long, value_name = "N")]
    layers: Option<u32>,
    /// Texels along a tile's edge, or along the atlas's: overrides the preset's shells.texture_size
    #[arg(long, value_name = "N")]
    texture_size: Option<u32>,
    /// Where random numbers start
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    /// Pixels of each picture
    #[arg(long, value_name = "WxH", default_value = "512x512")]
    size: String,
    /// Views around the asset at each distance, 1 to 64
    #[arg(long, value_name = "N", default_value_t = 8)]
    views: usize,
    /// Distances, as factors on that at which the asset just fits, 0.05 to 100; each may have a number of views of its own
    #[arg(long, value_name = "DISTANCE[:VIEWS],…", default_value = "1,2,4,8")]
    distances: String,
    /// Lights: from the eye; from the left; from behind; from everywhere; or three lights and what comes from everywhere
    #[arg(long, value_name = "front,side,rim,sky,studio", default_value = "studio,front")]
    lights: String,
    /// Exit with 1 where the mean FLIP is over the floor by more than this
    #[arg(long, value_name = "FLIP")]
    max_flip: Option<f64>,
    /// What draws fur, as in `render`; the coat is drawn by the adapter named here, or by any there is
    #[arg(long, value_name = "auto|cpu|gpu[:NAME]", default_value = "auto")]
    device: String,
}

impl Coat {
    /// Bakes, looks, measures and writes.
    ///
    /// # Errors
    /// Where the input or an option cannot be used, there is no adapter, a file cannot be written, or the limit is exceeded.
    pub fn run(self, console: &Console) -> Result<()> {
        check_limit(self.max_flip)?;
        let [csv, svg, png_file] = checked_outputs(&self.output, &self.input)?;
        let size = size(&self.size)?;
        let distances = views::parse(&self.distances, self.views)?;
        let lights = lights(&self.lights)?;
        let device: Device = self.device.parse()?;
        let preset = Preset::load(&self.preset)?.with_settings(&self.settings)?;
        let mut keep = Keep::open(&self.output.with_extension("parts"))?;
        let progress = console.progress();
        progress.step("bake");
        let (coat_key, file) = self.baked(&preset, &mut keep, console)?;
        let (asset, coat) = read_coat(&file)?;
        progress.step("grow");
        let fur = Fur::new(self.picture(preset.clone()), device.clone(), size)?;
        fur.notes().iter().for_each(|note| console.note(note));
        let choice = match &device {
            Device::Gpu(choice) => choice.clone(),
            Device::Auto | Device::Cpu => Choice::Auto,
        };
        let coat_bytes = summarise(&coat).vram_bytes as u64;
        let (report, adapter) = sit(&asset, &coat, &choice, |sitting| {
            let adapter = sitting.device.clone();
            let options = Options { size, lights, distances, coat: coat_key.with(&adapter), coat_bytes };
            let mut draw = |camera: &_, lit| {
                let start = Instant::now();
                let drawn = sitting.draw(camera, lit, size)?;
                let triangles = drawn.passes.iter().map(|pass| pass.triangles).sum();
                let cost = Cost { ms: start.elapsed().as_secs_f64() * 1e3, triangles: Some(triangles) };
                Ok(Drawing { picture: LinearImage::from(&drawn.picture.film()), cost })
            };
            let report = look(&options, &fur, &mut keep, &mut draw, &mut |what| progress.step(what))?;
            Ok((report, adapter))
        })?;
        progress.finish();
        report.notes.iter().for_each(|note| console.warning(note));
        let all = self.json(&report, &fur, size, &adapter);
        let title = format!("{}, {}, {} × {}, coat by {adapter}", self.input, self.preset, size[0], size[1]);
        let files = [
            (csv, table::csv(&report.pictures).into_bytes()),
            (svg, report.plot(&title).into_bytes()),
            (png_file, png::encode(&report.sheet)?),
            (self.output.clone(), output::json_bytes(&self.output, &all)?),
        ];
        let files: Vec<(PathBuf, &[u8])> = files.iter().map(|(path, bytes)| (path.clone(), bytes.as_slice())).collect();
        write::all(&files, &[PathBuf::from(&self.input)])?;
        console.result(&all, |out| self.print(&report, out))?;
        let excess = report.summary.excess.flip;
        match self.max_flip {
            Some(limit) if excess > limit => {
                Err(Error::new(Kind::Difference, "the coat is off by more than the limit")
                    .with_file(&self.output)
                    .with_field("summary.excess.flip")
                    .with_found(format!("{excess:.4}"))
                    .with_expected(format!("at most {limit}")))
            }
            _ => Ok(()),
        }
    }

    /// The coat's file, baked where this program has not baked the same before; and what decides it.
    fn baked(&self, preset: &Preset, keep: &mut Keep, console: &Console) -> Result<(Key, PathBuf)> {
        let mut preset = preset.clone();
        preset.shells.layers = self.layers.unwrap_or(preset.shells.layers);
        preset.shells.texture_size = self.texture_size.unwrap_or(preset.shells.texture_size);
        let preset = preset.checked()?;
        let method = match self.parameterisation {
            Layout::Lapped => Method::Lapped,
            Layout::Atlas => Method::Atlas { texels: self.texture_size },
            Layout::Uv => Method::Uv(0),
        };
        let key = Key::default().program()?.asset(&self.input)?.preset(&preset)?;
        let key = key.with((&self.materials, self.units.units(), method, self.seed));
        let out = keep.coat_file(key);
        if !out.is_file() {
            let baked = bake(
                &Request {
                    input: self.input.clone(),
                    out: out.clone(),
                    preset,
                    presets: Vec::new(),
                    materials: self.materials.clone(),
                    units: self.units.units(),
                    method,
                    seed: self.seed,
                    fallback: Fallback::None,
                    judge: false,
                    cache: None,
                },
                &mut |_| {},
            )?;
            baked.warnings.iter().for_each(|warning| console.warning(warning));
        }
        Ok((key, out))
    }

    fn picture(&self, preset: Preset) -> PictureRequest {
        PictureRequest {
            input: self.input.clone(),
            preset,
            materials: self.materials.clone(),
            units: self.units.units(),
            seed: self.seed,
            only: Only::Hybrid,
            pose: None,
        }
    }

    fn json(&self, report: &Report, fur: &Fur, size: [u32; 2], adapter: &str) -> Value {
        json!({
            "schema_version": SCHEMA_VERSION,
            "input": self.input,
            "preset": self.preset,
            "size": size,
            "seed": self.seed,
            "coat_device": adapter,
            "render_device": self.device,
            "hair_m": fur.hair_m(),
            "drawn": report.drawn,
            "pictures": report.pictures.iter().map(|picture| picture.value()).collect::<Vec<_>>(),
            "summary": report.summary,
        })
    }

    fn print(&self, report: &Report, out: &mut dyn std::io::Write) -> std::io::Result<()> {
        writeln!(out, "light   distance     FLIP    floor   fringe     bias coverage  views")?;
        for Group { light, distance, pictures, mean, excess } in &report.summary.by_light_and_distance {
            let (flip, floor, fringe) = (mean.flip, mean.flip - excess.flip, mean.fringe_flip.unwrap_or(f64::NAN));
            let (bias, coverage) = (mean.bias * 100.0, mean.coverage);
            writeln!(
                out,
                "{light:<7} {distance:8} {flip:8.4} {floor:8.4} {fringe:8.4} {bias:+7.2}% {coverage:+8.2} {pictures:6}"
            )?;
        }
        let excess = report.summary.excess.flip;
        writeln!(out, "FLIP over the floor: {excess:.4}; {}", self.output.display())
    }
}

/// Reads lights with commas between, each once.
fn lights(text: &str) -> Result<Vec<Rig>> {
    let mut all: Vec<Rig> = Vec::new();
    for name in text.split(',') {
        let rig = name.parse()?;
        if all.contains(&rig) {
            return Err(Error::usage("lights are asked for twice").with_field("--lights").with_found(name));
        }
        all.push(rig);
    }
    Ok(all)
}
