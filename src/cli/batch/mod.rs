//! `furrier batch`.

mod emit;
mod ending;
mod init;
mod limits;
mod look;
mod merge;
mod plan;
mod progress;
mod table;
mod told;
mod watch;
mod work;

use super::console::Console;
use super::recipe::RecipeArgs;
use crate::batch::outcome::{Outcome, Totals};
use crate::batch::plan::Plan;
use crate::batch::{library, run};
use crate::error::Result;
use clap::{Args, Subcommand};
use ending::EndingArgs;
use limits::LimitArgs;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::time::Instant;
use told::Told;

/// Bake a library of assets: what is out of date, several at once
#[derive(Debug, Args)]
#[command(
    args_conflicts_with_subcommands = true,
    subcommand_negates_reqs = true,
    after_long_help = "\
Examples:
  furrier batch models/ --preset short-cat
      every .glb, .gltf and .obj below models/ into models/furry/, those alone that are out of date
  furrier batch models/ --dry-run
      says for each what would be done, and why
  furrier batch cat.glb fox.glb -o furry/ --threads 8 --memory 8GB
  furrier batch init models/
      writes models/furrier.toml, which says which files are baked how; `furrier batch models/` follows it

A library that is too large for one machine: furrier batch plan, run, merge and emit; docs/batch.md goes through it."
)]
pub struct Batch {
    #[command(subcommand)]
    what: Option<What>,
    #[command(flatten)]
    assets: LibraryArgs,
    #[command(flatten)]
    limits: LimitArgs,
    /// Stop at the first failure; what is under way is finished
    #[arg(long)]
    fail_fast: bool,
    /// Say what would be done, and why, and do nothing
    #[arg(long, conflicts_with_all = ["watch", "jsonl"])]
    dry_run: bool,
    /// Bake again whatever changes on disk, until Ctrl-C
    #[arg(long)]
    watch: bool,
    /// Print a line of JSON per event on stdout instead of a table
    #[arg(long)]
    jsonl: bool,
    #[command(flatten)]
    ending: EndingArgs,
}

/// What is baked, how and where to.
#[derive(Debug, Args)]
pub struct LibraryArgs {
    /// A folder, several files, or a furrier.toml. A folder with a furrier.toml in it is baked by that
    #[arg(required = true, value_name = "LIBRARY")]
    inputs: Vec<PathBuf>,
    /// The folder to write to. Default: furry in the library's folder, or here for several files
    #[arg(short, long, value_name = "FOLDER")]
    output: Option<PathBuf>,
    #[command(flatten)]
    recipe: RecipeArgs,
}

#[derive(Debug, Subcommand)]
enum What {
    Init(init::Init),
    Plan(plan::PlanCommand),
    Run(work::RunCommand),
    Merge(merge::Merge),
    Emit(emit::Emit),
}

impl Batch {
    /// Bakes what is out of date and says what came of it.
    ///
    /// # Errors
    /// Where the library cannot be used; as [`EndingArgs::end`].
    pub fn run(self, console: &Console) -> Result<()> {
        match self.what {
            Some(What::Init(init)) => return init.run(console),
            Some(What::Plan(plan)) => return plan.run(console),
            Some(What::Run(run)) => return run.run(console),
            Some(What::Merge(merge)) => return merge.run(console),
            Some(What::Emit(emit)) => return emit.run(console),
            None => {}
        }
        self.ending.check()?;
        let limits = self.limits.limits(self.fail_fast);
        if self.dry_run {
            return dry_run(&self.assets.plan()?, limits.threads, console);
        }
        let bake = |plan: &Plan| {
            let started = Instant::now();
            let mut told = if self.jsonl { Told::events(console)? } else { Told::people(console) };
            let outcomes = run::run(plan, &plan.entries, &limits, &mut |event| told.hear(event))?;
            let told = !told.finish()?;
            self.ending.end(plan, outcomes, Some(started.elapsed().as_secs_f64()), told, console)
        };
        if self.watch {
            return watch::watch(&self.assets, console, &bake);
        }
        bake(&self.assets.plan()?)
    }
}

impl LibraryArgs {
    /// The library's plan.
    ///
    /// # Errors
    /// Where the library or a choice cannot be used.
    pub fn plan(&self) -> Result<Plan> {
        let choices = self.recipe.choices();
        let chosen = choices != crate::bake::recipe::Choices::default();
        library::open(&self.inputs, &choices, self.output.as_deref(), chosen)
    }

    /// Folders with what is baked, and with the files of presets.
    fn folders(&self) -> Vec<PathBuf> {
        let folder = |path: &PathBuf| if path.is_dir() { path.clone() } else { beside(path) };
        self.inputs.iter().map(folder).chain(self.recipe.preset_files().iter().map(|file| beside(file))).collect()
    }
}

/// What is printed as JSON.
fn summary(outcomes: &[Outcome]) -> serde_json::Value {
    let totals = Totals::of(outcomes);
    let failed: Vec<_> = outcomes
        .iter()
        .filter_map(|outcome| Some(json!({ "input": outcome.input, "error": outcome.fault.as_ref()?.reason })))
        .collect();
    let warned = outcomes.iter().flat_map(|outcome| outcome.warnings.iter().map(|text| (&outcome.input, text)));
    let warnings: Vec<_> = warned.map(|(input, text)| json!({ "input": input, "warning": text })).collect();
    json!({
        "baked": totals.baked,
        "up_to_date": totals.up_to_date,
        "failed": failed,
        "not_run": totals.not_run,
        "warnings": warnings,
    })
}

/// The folder that a file lies in.
fn beside(path: &Path) -> PathBuf {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new(".")).to_owned()
}

/// Says what would be done.
fn dry_run(plan: &Plan, threads: usize, console: &Console) -> Result<()> {
    let looked = run::look(plan, &plan.entries, threads)?;
    let outcomes: Vec<Outcome> =
        plan.entries.iter().zip(&looked.standings).map(|(entry, standing)| run::foretold(entry, standing)).collect();
    let due = |outcome: &&Outcome| !outcome.why.is_empty();
    let seconds: f64 = outcomes.iter().filter(due).map(|o| plan.cost(&plan.entries[o.item]).seconds).sum();
    let value = json!({
        "would_bake": outcomes.iter().filter(due).map(|o| json!({ "input": o.input, "output": o.output, "why": o.why })).collect::<Vec<_>>(),
        "up_to_date": Totals::of(&outcomes).up_to_date,
        "would_fail": outcomes.iter().filter_map(|o| Some(json!({ "input": o.input, "error": o.fault.as_ref()?.reason }))).collect::<Vec<_>>(),
        "estimated_seconds_on_one_thread": seconds,
    });
    console.result(&value, |out| table::foretell(&outcomes, seconds, out))
}
