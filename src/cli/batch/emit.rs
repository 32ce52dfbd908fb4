//! `furrier batch emit`.

use crate::asset::write;
use crate::batch::emit::{Cut, openjd, slurm};
use crate::batch::plan::Plan;
use crate::cli::console::Console;
use crate::cli::output;
use crate::error::{Error, Result};
use clap::{Args, ValueEnum};
use serde_json::json;
use std::path::{Path, PathBuf};

/// Write a plan as a job of a farm's engine
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  furrier batch emit openjd plan.jsonl -o plan.openjd.json
      an Open Job Description template; openjd run plan.openjd.json --step Merge --run-dependencies
  furrier batch emit slurm plan.jsonl -o plan.sh --chunk 20 --at-once 50
      a script; sh plan.sh --wait")]
pub struct Emit {
    /// Which engine
    #[arg(value_enum)]
    engine: EngineName,
    /// What `furrier batch plan` wrote
    plan: PathBuf,
    /// The job to write
    #[arg(short, long, value_name = "JOB")]
    output: PathBuf,
    /// Assets that one machine takes at once. Default: about two minutes of one thread
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    chunk: Option<u32>,
    /// Tasks that run side by side at most; for Slurm
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    at_once: Option<u32>,
    /// Threads of a task; for Slurm
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: u16,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum EngineName {
    /// Open Job Description, as AWS Deadline Cloud and openjd-cli run it
    Openjd,
    /// Slurm's array jobs
    Slurm,
}

impl Emit {
    /// Writes the job.
    ///
    /// # Errors
    /// Where the plan cannot be read, or the job not be written.
    pub fn run(self, console: &Console) -> Result<()> {
        output::check(&self.output, &[&self.plan])?;
        let plan = Plan::read(&self.plan)?;
        let seconds = plan.entries.iter().filter_map(|entry| entry.cost).map(|cost| cost.seconds).sum();
        let cut = Cut::new(plan.entries.len(), seconds, self.chunk.map(|n| n as usize));
        let path = std::path::absolute(&self.plan)
            .map_err(|error| Error::input("the plan's path cannot be used").with_file(&self.plan).with_found(error))?;
        match self.engine {
            EngineName::Openjd => output::json(&self.output, &openjd(&path, cut))?,
            EngineName::Slurm => {
                let at_once = self.at_once.map(|n| n as usize);
                let text = slurm(&path, Path::new("furrier"), cut, at_once, usize::from(self.threads));
                write::whole(&self.output, text.as_bytes(), &[])?;
            }
        }
        let value = json!({ "job": self.output, "items": cut.items, "chunk": cut.chunk });
        console.result(&value, |out| {
            writeln!(out, "{}: {} assets, {} at a time", self.output.display(), cut.items, cut.chunk)
        })
    }
}
