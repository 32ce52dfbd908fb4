//! `furrier batch emit`: a plan as a job of a farm's own engine.

mod openjd;
mod slurm;

use crate::asset::write;
use crate::batch::plan::Plan;
use crate::cli::console::Console;
use crate::cli::output;
use crate::error::{Error, Result};
use clap::{Args, ValueEnum};
use openjd::openjd;
use serde_json::json;
use slurm::slurm;
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
        let path = absolute(&self.plan)?;
        match self.engine {
            EngineName::Openjd => {
                let job = absolute(&self.output)?;
                let beside = job.parent().and_then(|folder| path.strip_prefix(folder).ok());
                if beside.is_none() {
                    console
                        .note("the plan lies elsewhere than the template, so the job must be given it: parameter Plan");
                }
                output::json(&self.output, &openjd(&path, beside, cut))?;
            }
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

fn absolute(path: &Path) -> Result<PathBuf> {
    std::path::absolute(path).map_err(|error| Error::input("a path cannot be used").with_file(path).with_found(error))
}

/// How a plan is cut.
#[derive(Clone, Copy, Debug)]
pub struct Cut {
    /// Items of the plan.
    pub items: usize,
    /// Items that one machine takes at once.
    pub chunk: usize,
    /// What a chunk costs on one thread, s.
    pub chunk_seconds: f64,
}

impl Cut {
    /// Of a plan whose items cost so much together; about two minutes each where nothing is said.
    pub fn new(items: usize, seconds: f64, chunk: Option<usize>) -> Self {
        let each = seconds / items.max(1) as f64;
        let chunk = chunk.unwrap_or(((CHUNK_S / each.max(1e-3)) as usize).clamp(1, 1000));
        Self { items, chunk, chunk_seconds: each * chunk as f64 }
    }
}

/// What a chunk costs where nothing is said, s: far more than a process needs to start, far less than one likes to lose.
const CHUNK_S: f64 = 120.0;
