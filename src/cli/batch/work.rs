//! `furrier batch run`.

use super::limits::LimitArgs;
use super::told::{Engine, Told};
use super::{summary, table};
use crate::batch::fragments::Fragments;
use crate::batch::outcome::{Outcome, Totals};
use crate::batch::plan::{Entry, Plan};
use crate::batch::run::{Limits, run};
use crate::batch::{event, range};
use crate::cli::console::Console;
use crate::error::{Error, Kind, Result};
use clap::Args;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// How long to wait before a machine that failed is tried again, s.
const PAUSES_S: [u64; 2] = [1, 5];

/// Bake some items of a plan, and keep what came of them beside it. An asset that fails is data, and the exit code 0; a machine that
/// fails is 75
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  furrier batch run plan.jsonl --items 0-99
  furrier batch run plan.jsonl --items 12,40-49 --threads 8 --root /mnt/models

What came of each item goes to plan.jsonl.parts/; `furrier batch merge plan.jsonl` gives the verdict.")]
pub struct RunCommand {
    /// What `furrier batch plan` wrote
    plan: PathBuf,
    /// Which items: A-B, A-B:STEP or single numbers, with commas between
    #[arg(long, value_name = "A-B")]
    items: String,
    /// The library's folder on this machine, where it is another than the plan's
    #[arg(long, value_name = "FOLDER")]
    root: Option<PathBuf>,
    #[command(flatten)]
    limits: LimitArgs,
    /// Print a line of JSON per event on stdout
    #[arg(long)]
    jsonl: bool,
    /// Print progress as this engine reads it
    #[arg(long, value_enum, value_name = "ENGINE", conflicts_with = "jsonl")]
    progress: Option<Engine>,
}

impl RunCommand {
    /// Bakes.
    ///
    /// # Errors
    /// [`Kind::Machine`] where the machine failed; where the plan or its items cannot be read.
    pub fn run(self, console: &Console) -> Result<()> {
        let mut plan = Plan::read(&self.plan)?;
        plan.root = self.root.unwrap_or(plan.root);
        let items = range::parse(&self.items, plan.entries.len())?;
        if !plan.root.is_dir() {
            return Err(Error::new(Kind::Machine, "the library's folder is not on this machine")
                .with_file(&plan.root)
                .with_hint("mount it, or say where it lies with `root`"));
        }
        let mut told = match (self.jsonl, self.progress) {
            (true, _) => Told::events(console)?,
            (_, Some(engine)) => Told::engine(console, engine),
            _ => Told::people(console),
        };
        let entries: Vec<Entry> = items.iter().map(|&item| plan.entries[item].clone()).collect();
        let fragments = Fragments::of(&self.plan);
        let started = Instant::now();
        let limits = self.limits.limits(false);
        let outcomes = patiently(&plan, &entries, &limits, &fragments, &mut |event| told.hear(event))?;
        if !told.finish()? {
            return Ok(());
        }
        let seconds = started.elapsed().as_secs_f64();
        console.result(&summary(&outcomes), |out| table::print(&outcomes, Totals::of(&outcomes), Some(seconds), out))
    }
}

/// Bakes, and tries again what the machine was at fault for.
fn patiently(
    plan: &Plan,
    entries: &[Entry],
    limits: &Limits,
    fragments: &Fragments,
    listen: &mut event::Listen<'_>,
) -> Result<Vec<Outcome>> {
    let mut outcomes: Vec<Outcome> = Vec::new();
    let mut left = entries.to_vec();
    for pause in PAUSES_S.map(Some).into_iter().chain([None]) {
        let tried = run(plan, &left, limits, listen).and_then(|tried| {
            let of_machine = |outcome: &Outcome| outcome.fault.as_ref().is_some_and(|fault| fault.machine);
            let (bad, done): (Vec<Outcome>, Vec<Outcome>) = tried.into_iter().partition(of_machine);
            fragments.put(&done.iter().collect::<Vec<_>>())?;
            outcomes.extend(done);
            left.retain(|entry| bad.iter().any(|outcome| outcome.item == entry.item));
            let reason = bad.into_iter().find_map(|outcome| outcome.fault).map(|fault| fault.reason);
            reason.map_or(Ok(()), |reason| Err(Error::new(Kind::Output, reason)))
        });
        match (tried, pause) {
            (Ok(()), _) => break,
            (Err(error), _) if !matches!(error.kind, Kind::Output | Kind::Device) => return Err(error),
            (Err(error), None) => {
                return Err(Error { kind: Kind::Machine, ..error }
                    .with_hint("nothing is kept of what is left; another try, or another machine, goes on from here"));
            }
            (Err(error), Some(seconds)) => {
                listen(event::Event::Note(&format!("the machine failed: {}; once more in {seconds} s", error.what)));
                std::thread::sleep(Duration::from_secs(seconds));
            }
        }
    }
    outcomes.sort_by_key(|outcome| outcome.item);
    Ok(outcomes)
}
