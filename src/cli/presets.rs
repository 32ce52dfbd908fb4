//! `furrier presets`.

use super::console::Console;
use crate::error::Result;
use crate::preset::Preset;
use clap::{Args, Subcommand};
use serde_json::json;

/// List the built-in presets, or show one
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  furrier presets list
  furrier presets show fox > my-fox.toml     a start for a preset of your own
  furrier presets show my-fox.toml           what it says, checked")]
pub struct Presets {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, Subcommand)]
enum Action {
    /// List the built-in presets
    List,
    /// Print a preset: its file, or with --json every value it has, defaults included
    Show {
        /// A built-in preset or a TOML file
        #[arg(value_name = "NAME|FILE")]
        preset: String,
    },
}

impl Presets {
    /// Prints what was asked for.
    ///
    /// # Errors
    /// Where the preset to show is not there or not valid.
    pub fn run(self, console: &Console) -> Result<()> {
        match self.action {
            Action::List => list(console),
            Action::Show { preset } => show(&preset, console),
        }
    }
}

fn list(console: &Console) -> Result<()> {
    let presets = Preset::names().map(Preset::load).collect::<Result<Vec<_>>>()?;
    let rows: Vec<_> =
        presets.iter().map(|p| json!({ "name": p.name, "description": p.description, "size_m": p.size_m })).collect();
    let width = presets.iter().map(|p| p.name.len()).max().unwrap_or(0);
    console.result(&rows, |out| presets.iter().try_for_each(|p| writeln!(out, "{:width$}  {}", p.name, p.description)))
}

fn show(name: &str, console: &Console) -> Result<()> {
    let (preset, source) = (Preset::load(name)?, Preset::source_of(name)?);
    console.result(&preset, |out| out.write_all(source.as_bytes()))
}
