//! `furrier bake`.

use super::cache_flags::CacheFlags;
use super::console::Console;
use super::output;
use super::recipe::RecipeArgs;
use crate::asset::Reading;
use crate::bake::{Baked, Laid, Request, bake};
use crate::coat::summary::{Summary, summarise};
use crate::error::{Error, Result};
use crate::metrics::timing::Report;
use crate::preset::Preset;
use clap::Args;
use serde::Serialize;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Grow a coat on a mesh and write the furry asset
#[derive(Debug, Args)]
#[command(after_long_help = after_help())]
pub struct Bake {
    /// A .glb, .gltf, .vrm or .obj file, or sample:NAME
    input: String,
    /// Inputs after the first one are answered with how to bake several.
    #[arg(hide = true)]
    others: Vec<String>,
    /// The .glb, .gltf or .vrm to write; never the input itself
    #[arg(short, long, value_name = "OUT.glb")]
    output: PathBuf,
    #[command(flatten)]
    recipe: RecipeArgs,
    /// Take off the coat that the input wears already, as `furrier strip` does, and bake a new one
    #[arg(long)]
    rebake: bool,
    /// Threads to compute with, 1 to 1024; the result does not depend on it. Default: all
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Measure the coat against its strands, and write times, sizes and errors to this JSON file
    #[arg(long, value_name = "FILE.json")]
    report: Option<PathBuf>,
    #[command(flatten)]
    cache: CacheFlags,
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
        self.refuse_several()?;
        let recipe = self.recipe.choices().recipe()?;
        let reading = Reading { rebake: self.rebake, ..recipe.reading() };
        let cache = self.cache.store();
        let request = Request { reading, cache, ..recipe.request(&self.input, &self.output, self.report.is_some()) };
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

    /// One input makes one output; where there are more, `furrier batch` is meant.
    fn refuse_several(&self) -> Result<()> {
        let (what, found) = if let Some(second) = self.others.first() {
            ("one bake has one input", format!("{} and {second}", self.input))
        } else if Path::new(&self.input).is_dir() {
            ("one bake has one input", format!("the folder {}", self.input))
        } else {
            return Ok(());
        };
        Err(Error::usage(what)
            .with_found(found)
            .with_expected("one .glb, .gltf or .obj file, or sample:NAME")
            .with_hint("`furrier batch` bakes folders and several files; give `output` a folder there"))
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
        "cache": baked.cached,
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
