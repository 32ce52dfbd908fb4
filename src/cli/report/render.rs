//! `furrier report render`.

use super::checked_outputs;
use crate::asset::write;
use crate::bake::picture::{Grown, Only, PictureRequest};
use crate::cli::axes::AxesArgs;
use crate::cli::console::Console;
use crate::cli::output;
use crate::cli::recipe::UnitName;
use crate::cli::stage::StageArgs;
use crate::error::Result;
use crate::metrics::compare::load;
use crate::preset::Preset;
use crate::report::{plot, render, table};
use crate::stage::file::Format;
use crate::volume::scene::Lighting;
use clap::Args;
use std::path::PathBuf;

/// Draw a scene with every control of `render` changed in turn
#[derive(Debug, Args)]
#[command(after_long_help = "\
Example:
  furrier report render sample:hat -o hat.json --preset mink --size 256x256

Beside hat.json stand hat.csv, hat.svg and hat.png, which is what the defaults of final draw. Errors are against the finest setting or --reference; times are of drawing alone.")]
pub struct Render {
    /// A glTF or OBJ file, or sample:NAME
    input: String,
    /// The report to write; a .csv, a .svg and a .png go beside it
    #[arg(short, long, value_name = "OUT.json")]
    output: PathBuf,
    /// A built-in preset or a TOML file
    #[arg(long, value_name = "NAME|FILE", default_value = "mink")]
    preset: String,
    /// Change a value of the preset; repeatable
    #[arg(long = "set", value_name = "table.key=value")]
    settings: Vec<String>,
    /// What a unit of the file means
    #[arg(long, value_enum, default_value = "auto")]
    units: UnitName,
    #[command(flatten)]
    axes: AxesArgs,
    #[command(flatten)]
    stage: StageArgs,
    /// Runs of each setting; the quickest counts
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=100))]
    repeats: u32,
    /// A picture to measure against, of the same view: what `render --quality reference` drew; without, the finest setting
    #[arg(long, value_name = "FILE")]
    reference: Option<PathBuf>,
    /// Decides all that is random
    #[arg(long, default_value_t = 0)]
    seed: u64,
}

impl Render {
    /// Sweeps and writes.
    ///
    /// # Errors
    /// Where the input or an option cannot be used, or a file not written.
    pub fn run(self, console: &Console) -> Result<()> {
        let [csv, svg, png] = checked_outputs(&self.output, &self.input)?;
        let stage = self.stage.options()?;
        let size = stage.size.map(|n| n as usize);
        let load_named = |path: &PathBuf| -> Result<_> { Ok((path.display().to_string(), load(path)?)) };
        let reference = self.reference.as_ref().map(load_named).transpose()?;
        let grown = Grown::new(&PictureRequest {
            input: self.input.clone(),
            reading: self.axes.reading()?,
            preset: Preset::load(&self.preset)?.with_settings(&self.settings)?,
            materials: Vec::new(),
            units: self.units.units(),
            seed: self.seed,
            only: Only::Hybrid,
            pose: None,
        })?;
        grown.notes.iter().for_each(|note| console.note(note));
        let camera = stage.camera(&grown.subject)?;
        let options = render::Options {
            input: self.input.clone(),
            size,
            lighting: Lighting::new(&stage.lit(&grown.subject, &camera)?),
            camera,
            repeats: self.repeats,
            reference,
        };
        let sweep = render::sweep(&grown, &options, &mut |what| tracing::info!("{what}"))
            .map_err(|e| self.reference.iter().fold(e, |e, path| e.with_file(path)))?;
        let title = format!("{}, {}, {} × {}, {}", self.input, self.preset, size[0], size[1], sweep.device);
        let error = format!("FLIP against {}", sweep.yardstick.name);
        let plot = plot::svg(&title, &error, &sweep.points);
        let json = output::json_bytes(&self.output, &sweep)?;
        let files = [
            (csv, table::csv(&sweep.points).into_bytes()),
            (svg, plot.into_bytes()),
            (png, Format::Png.encode(&sweep.picture, &stage.development)?),
            (self.output.clone(), json),
        ];
        let files: Vec<(PathBuf, &[u8])> = files.iter().map(|(path, bytes)| (path.clone(), bytes.as_slice())).collect();
        write::all(&files, &[PathBuf::from(&self.input)])?;
        console.result(&sweep, |out| {
            writeln!(out, "{:>9} {:>8} {:>8} {:>8}  setting", "ms", "FLIP", "relMSE", "bias")?;
            for p in &sweep.points {
                let mark = if p.pareto { "*" } else { " " };
                let of = if p.defaults.is_some() { String::new() } else { format!(" = {}", p.value) };
                let (ms, flip, rel_mse, bias) = (p.ms, p.flip, p.rel_mse, p.bias * 100.0);
                writeln!(out, "{ms:9.1} {flip:8.4} {rel_mse:8.5} {bias:+7.2}% {mark} {}{of}", p.sweep)?;
            }
            writeln!(out, "* nothing is both quicker and closer; {}", self.output.display())
        })
    }
}
