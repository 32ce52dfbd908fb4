//! `furrier presets`.

use super::console::Console;
use crate::error::{Error, Result};
use crate::preset::Preset;
use crate::preset::keys::{Key, tables};
use clap::{Args, Subcommand};
use serde_json::{Value, json};

/// List the built-in presets, show one, or explain its keys
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  furrier presets list
  furrier presets show fox > my-fox.toml     a start for a preset of your own
  furrier presets show my-fox.toml           what it says, checked
  furrier presets keys clump                 the keys that have to do with clumps: for --set and for files")]
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
    /// Print every key of a preset: default, range, unit, and what it does
    Keys {
        /// Only keys with this word in their name or explanation
        word: Option<String>,
    },
}

impl Presets {
    /// Prints what was asked for.
    ///
    /// # Errors
    /// Where the preset to show is not there or not valid, or no key has to do with the word.
    pub fn run(self, console: &Console) -> Result<()> {
        match self.action {
            Action::List => list(console),
            Action::Show { preset } => show(&preset, console),
            Action::Keys { word } => keys(word.as_deref().unwrap_or(""), console),
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

fn keys(word: &str, console: &Console) -> Result<()> {
    let has = |text: &str| text.to_lowercase().contains(&word.to_lowercase());
    let keys: Vec<Key> =
        tables().into_iter().flat_map(|table| table.keys).filter(|k| has(&k.key) || has(&k.what)).collect();
    if keys.is_empty() {
        return Err(Error::usage("no key has to do with this word")
            .with_field("WORD")
            .with_found(word)
            .with_hint("`furrier presets keys` prints all there are"));
    }
    console.result(&keys, |out| {
        keys.iter().try_for_each(|key| {
            let default = key.default.as_ref().map(|value| format!(" = {}", short(value))).unwrap_or_default();
            writeln!(out, "{}{default}\n    {}\n    {}", key.key, key.expected(), key.what)
        })
    })
}

/// JSON text, its numbers as the 32-bit floats they are.
fn short(value: &Value) -> String {
    match value {
        Value::Array(items) => format!("[{}]", items.iter().map(short).collect::<Vec<_>>().join(", ")),
        Value::Number(n) if n.is_f64() => n.as_f64().map(|n| (n as f32).to_string()).unwrap_or_default(),
        other => other.to_string(),
    }
}
