//! `furrier bake`.

use super::axes::AxesArgs;
use super::console::Console;
use super::output;
use crate::asset::Reading;
use crate::asset::coat::Fallback;
use crate::bake::units::Units;
use crate::bake::{Baked, Laid, Method, Request, bake};
use crate::coat::summary::{Summary, summarise};
use crate::error::{Error, Result};
use crate::metrics::timing::Report;
use crate::preset::Preset;
use clap::{Args, ValueEnum};
use serde::Serialize;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Grow a coat on a mesh and write the furry asset
#[derive(Debug, Args)]
#[command(after_long_help = after_help())]
pub struct Bake {
    /// A .glb, .gltf or .obj file, or sample:NAME
    input: String,
    /// The .glb or .gltf to write; never the input itself
    #[arg(short, long, value_name = "OUT.glb")]
    output: PathBuf,
    /// A built-in preset or a TOML file, for every furred material or for the one named; repeatable. Default: fox
    #[arg(long = "preset", value_name = "[MATERIAL=]NAME|FILE")]
    presets: Vec<String>,
    /// Change one value of every preset used; repeatable
    #[arg(long = "set", value_name = "TABLE.KEY=VALUE")]
    settings: Vec<String>,
    /// Fur the material of this name; repeatable. Default: all but those named as eyes, nose, teeth, tongue, claws,
    /// hooves, horns, pads, lashes or ground
    #[arg(long = "material", value_name = "NAME")]
    materials: Vec<String>,
    /// What one unit of the file is; auto takes what is furred to be as large as what the preset describes; where that is a small
    /// part of a figure, as a hat is, it takes the unit that makes the figure as large as an animal or a person
    #[arg(long, value_enum, default_value_t = UnitName::Auto)]
    units: UnitName,
    #[command(flatten)]
    axes: AxesArgs,
    /// Take off the coat that the input wears already, as `furrier strip` does, and bake a new one
    #[arg(long)]
    rebake: bool,
    /// How the skin is laid out in the plane: patches grown along the hair, charts with texels of their own, or the
    /// asset's own UVs
    #[arg(long, value_enum, default_value_t = Layout::Lapped)]
    parameterisation: Layout,
    /// The UV set that `--parameterisation uv` takes [default: 0]
    #[arg(long, value_name = "N")]
    uv_set: Option<usize>,
    /// Layers, the opaque skin included: overrides every preset's shells.layers
    #[arg(long, value_name = "N")]
    layers: Option<u32>,
    /// Texels along a tile's edge: overrides every preset's shells.texture_size. With `--parameterisation atlas`, those
    /// along the edge of the whole atlas [default there: four times the preset's]
    #[arg(long, value_name = "N")]
    texture_size: Option<u32>,
    /// Where random numbers start; the same seed gives the same bytes
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,
    /// Threads to compute with, 1 to 1024; the result does not depend on it. Default: all
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// What programs without the extension show: the bare skin, or N shells as plain meshes
    #[arg(long, value_name = "none|shells:N", default_value = "shells:8", value_parser = fallback)]
    fallback: Fallback,
    /// Measure the coat against its strands, and write times, sizes and errors to this JSON file
    #[arg(long, value_name = "FILE.json")]
    report: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum UnitName {
    Auto,
    M,
    Cm,
    Mm,
    In,
}

impl UnitName {
    /// What it stands for.
    pub(super) fn units(self) -> Units {
        match self {
            Self::Auto => Units::Auto,
            Self::M => Units::Metres,
            Self::Cm => Units::Centimetres,
            Self::Mm => Units::Millimetres,
            Self::In => Units::Inches,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Layout {
    Lapped,
    Atlas,
    Uv,
}

const EXAMPLES: &str = "\
Examples:
  furrier bake sample:creature -o creature.glb
      a built-in mesh; the others are cylinder, hat, sphere, torus and plane
  furrier bake cat.glb -o furry-cat.glb --preset short-cat
  furrier bake deer.glb -o furry-deer.glb --material Body --set guard.length.mm=30
      fur on one material only, its guard hair 30 mm long
  furrier bake doll.gltf -o doll.glb --preset plush --preset Hair=sheep --report doll.json
      two materials dressed differently; times, sizes and errors written down
  furrier bake room.obj -o room.glb --units cm --fallback none
      a file in centimetres, for an engine that reads the extension itself
  furrier bake scan.obj -o scan.glb --up z
      a scan that stands along z, combed as an animal that stands
";

const MAPS: &str = "
Painted maps, over the first UV set: --set maps.length=FILE.png, maps.density, maps.colour,
maps.comb, maps.clump. `furrier presets keys maps` explains them, `furrier presets keys` every key
of a preset. Worked examples: docs/recipes.md.";

/// Examples, the presets there are, and where painting is told.
fn after_help() -> String {
    let width = Preset::names().map(str::len).max().unwrap_or(0);
    let presets: String = Preset::descriptions().map(|(name, text)| format!("  {name:width$}  {text}\n")).collect();
    format!("{EXAMPLES}\nPresets:\n{presets}{MAPS}")
}

/// What is printed as JSON.
#[derive(Serialize)]
struct Outcome<'a> {
    output: &'a Path,
    /// Materials that got fur.
    materials: &'a [String],
    /// Bounding diagonal of what is furred, which lengths refer to, m.
    diagonal_m: f64,
    notes: &'a [String],
    warnings: &'a [String],
    coat: Summary,
}

impl Bake {
    /// Bakes, writes and says what came of it.
    ///
    /// # Errors
    /// As [`bake`], and where an option or a preset asks for something impossible.
    pub fn run(self, console: &Console) -> Result<()> {
        let request = self.request()?;
        output::check(&self.output, &[Path::new(&self.input)])?;
        if let Some(report) = &self.report {
            output::check(report, &[Path::new(&self.input), &self.output])?;
        }
        let progress = console.progress();
        let work = || bake(&request, &mut |step| progress.step(step));
        let started = std::time::Instant::now();
        let baked = in_pool(self.threads, work)??;
        let total_ms = started.elapsed().as_secs_f64() * 1e3;
        progress.finish();
        baked.notes.iter().for_each(|note| console.note(note));
        baked.warnings.iter().for_each(|warning| console.warning(warning));
        if let Some(path) = &self.report {
            output::json(path, &report(&baked, total_ms))?;
        }
        let outcome = Outcome {
            output: &self.output,
            materials: &baked.materials,
            diagonal_m: baked.diagonal_m,
            notes: &baked.notes,
            warnings: &baked.warnings,
            coat: summarise(&baked.coat),
        };
        console.result(&outcome, |out| {
            let (fur, coat) = (outcome.materials.join(", "), &outcome.coat);
            writeln!(
                out,
                "{}: fur on {fur}; {} triangles in {} draw calls, {:.2} MB of graphics memory; baked in {:.1} s",
                outcome.output.display(),
                coat.drawn_triangles,
                coat.draw_calls,
                coat.vram_bytes as f64 / 1e6,
                total_ms / 1e3
            )
        })
    }

    fn request(&self) -> Result<Request> {
        let mut preset = None;
        let mut presets: Vec<(String, Preset)> = Vec::new();
        for choice in &self.presets {
            let (material, name) = split_choice(choice);
            let chosen = self.adjusted(Preset::load(name)?)?;
            let doubled = match material {
                Some(material) if presets.iter().any(|(m, _)| m == material) => Some(material),
                Some(material) => {
                    presets.push((material.to_owned(), chosen));
                    None
                }
                None => preset.replace(chosen).map(|_| "all materials"),
            };
            if let Some(material) = doubled {
                return Err(Error::usage("two presets are given for the same material")
                    .with_field("--preset")
                    .with_found(format!("{choice}, after another one for {material}"))
                    .with_expected("one preset for all materials, and one for each material by name"));
            }
        }
        let preset = match preset {
            Some(preset) => preset,
            None => self.adjusted(Preset::load("fox")?)?,
        };
        if self.uv_set.is_some() && self.parameterisation != Layout::Uv {
            return Err(Error::usage("a UV set is chosen, but not used")
                .with_field("--uv-set")
                .with_hint("add `--parameterisation uv`"));
        }
        Ok(Request {
            input: self.input.clone(),
            reading: Reading { rebake: self.rebake, ..self.axes.reading()? },
            out: self.output.clone(),
            preset,
            presets,
            materials: self.materials.clone(),
            units: self.units.units(),
            method: match self.parameterisation {
                Layout::Lapped => Method::Lapped,
                Layout::Atlas => Method::Atlas { texels: self.texture_size },
                Layout::Uv => Method::Uv(self.uv_set.unwrap_or(0)),
            },
            seed: self.seed,
            fallback: self.fallback,
            judge: self.report.is_some(),
        })
    }

    /// `preset` with what the options say instead.
    fn adjusted(&self, preset: Preset) -> Result<Preset> {
        let mut preset = preset.with_settings(&self.settings)?;
        preset.shells.layers = self.layers.unwrap_or(preset.shells.layers);
        preset.shells.texture_size = self.texture_size.unwrap_or(preset.shells.texture_size);
        preset.checked()
    }
}

/// `[MATERIAL=]NAME|FILE`: what is a preset as it stands has no material.
fn split_choice(choice: &str) -> (Option<&str>, &str) {
    match choice.split_once('=') {
        Some((material, name)) if Preset::source_of(choice).is_err() => (Some(material), name),
        _ => (None, choice),
    }
}

fn fallback(text: &str) -> std::result::Result<Fallback, String> {
    match text.split_once(':') {
        None if text == "none" => Ok(Fallback::None),
        Some(("shells", count)) => match count.parse() {
            Ok(count @ 1..=255) => Ok(Fallback::Shells(count)),
            _ => Err(format!("`{count}` is not a number of shells from 1 to 255")),
        },
        _ => Err("expected `none` or `shells:N`".to_owned()),
    }
}

/// Does `work` on `threads` threads, or on all there are.
fn in_pool<T: Send>(threads: Option<u16>, work: impl FnOnce() -> T + Send) -> Result<T> {
    let Some(threads) = threads else { return Ok(work()) };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(usize::from(threads)).build().map_err(|e| {
        Error::usage("the threads cannot be started").with_field("--threads").with_found(format!("{threads}: {e}"))
    })?;
    Ok(pool.install(work))
}

/// What `--report` writes.
fn report(baked: &Baked, total_ms: f64) -> Value {
    let patches: Vec<_> = baked.laid.iter().map(laid_out).collect();
    let summary = summarise(&baked.coat);
    let report = Report::new("cpu", baked.steps.clone(), total_ms);
    let more = json!({
        "counts": {
            "tiles": summary.tiles.len(),
            "texels_used_by_tile": summary.tiles.iter().map(|t| t.texels_used).collect::<Vec<_>>(),
            "primitives": summary.primitives.len(),
            "coat_vertices": summary.primitives.iter().map(|p| p.vertices).sum::<usize>(),
            "fins": summary.primitives.iter().map(|p| p.fins).sum::<usize>(),
            "drawn_triangles": summary.drawn_triangles,
            "draw_calls": summary.draw_calls,
            "vram_bytes": summary.vram_bytes,
        },
        "error": { "coverage_by_tile": baked.accuracy },
        "patches_by_primitive": patches,
    });
    output::report(&report, more)
}

/// One primitive's comb and parameterisation (`docs/steps/field.md`, `docs/steps/patch.md`).
fn laid_out(laid: &Laid) -> Value {
    let singularities: Vec<_> =
        laid.singularities.iter().map(|s| json!({ "index": s.index, "position_m": s.position_m.to_array() })).collect();
    json!({ "material": laid.material, "ms": laid.ms, "measures": laid.measures, "singularities": singularities })
}
