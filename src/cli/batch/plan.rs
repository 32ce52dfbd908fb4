//! `furrier batch plan`.

use super::LibraryArgs;
use crate::cli::console::Console;
use crate::cli::output;
use crate::error::Result;
use clap::Args;
use serde_json::json;
use std::path::PathBuf;

/// Freeze a library into a numbered list that any number of machines can work off
#[derive(Debug, Args)]
pub struct PlanCommand {
    #[command(flatten)]
    assets: LibraryArgs,
    /// The plan to write: lines of JSON, the first about the library, one per asset after it
    #[arg(long, value_name = "PLAN.jsonl")]
    write: PathBuf,
}

impl PlanCommand {
    /// Writes the plan.
    ///
    /// # Errors
    /// Where the library cannot be used, or the file not be written.
    pub fn run(self, console: &Console) -> Result<()> {
        output::check(&self.write, &[])?;
        let plan = self.assets.plan()?.with_costs();
        plan.write(&self.write)?;
        let seconds: f64 = plan.entries.iter().filter_map(|entry| entry.cost).map(|cost| cost.seconds).sum();
        let value =
            json!({ "plan": self.write, "items": plan.entries.len(), "estimated_seconds_on_one_thread": seconds });
        console.result(&value, |out| {
            let (items, path) = (plan.entries.len(), self.write.display());
            writeln!(out, "{path}: {items} assets, about {seconds:.0} s of one thread")
        })
    }
}
