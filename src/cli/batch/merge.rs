//! `furrier batch merge`.

use super::ending::EndingArgs;
use crate::batch::fragments::Fragments;
use crate::batch::plan::Plan;
use crate::cli::console::Console;
use crate::error::Result;
use clap::Args;
use std::path::PathBuf;

/// Put together what machines found of a plan, and give the verdict of the whole
#[derive(Debug, Args)]
pub struct Merge {
    /// What `furrier batch plan` wrote
    plan: PathBuf,
    /// The library's folder on this machine, where it is another than the plan's
    #[arg(long, value_name = "FOLDER")]
    root: Option<PathBuf>,
    #[command(flatten)]
    ending: EndingArgs,
}

impl Merge {
    /// Merges.
    ///
    /// # Errors
    /// Where the plan cannot be read; [`crate::error::Kind::Some`] where items failed or were not run.
    pub fn run(self, console: &Console) -> Result<()> {
        self.ending.check()?;
        let mut plan = Plan::read(&self.plan)?;
        plan.root = self.root.unwrap_or(plan.root);
        let outcomes = Fragments::of(&self.plan).all(&plan);
        self.ending.end(&plan, outcomes, None, false, console)
    }
}
