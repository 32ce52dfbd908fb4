//! `furrier report`: error against cost.

mod coat;
mod levels;
pub(super) mod measure;
mod render;
mod subject;

use super::console::Console;
use super::output;
use crate::error::{Error, Result};
use clap::{Args, Subcommand};
use std::path::{Path, PathBuf};

/// Error against cost: of the renderer's settings, of a coat beside its fur, or of its levels of detail; as JSON, CSV and a plot
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  furrier report render sample:hat -o hat.json --preset mink --size 256x256
  furrier report render bunny.glb -o bunny.json --size 512x512 --repeats 3
  furrier report coat sample:hat -o hat.json --preset mink --views 4 --distances 1,4
  furrier report levels sample:creature -o levels.json --preset fox")]
pub struct Report {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    Render(render::Render),
    Coat(coat::Coat),
    Levels(levels::Levels),
}

impl Report {
    /// Draws, measures and writes.
    ///
    /// # Errors
    /// Where the input or an option cannot be used, a file not written, or a limit is exceeded.
    pub fn run(self, console: &Console) -> Result<()> {
        match self.what {
            What::Render(render) => render.run(console),
            What::Coat(coat) => coat.run(console),
            What::Levels(levels) => levels.run(console),
        }
    }
}

/// The .csv, .svg and .png beside a report, all of which can be written.
fn checked_outputs(output: &Path, input: &str) -> Result<[PathBuf; 3]> {
    if output.extension().is_none_or(|e| !e.eq_ignore_ascii_case("json")) {
        return Err(Error::usage("the report's kind is unknown")
            .with_field("--output")
            .with_found(output.display())
            .with_expected("a name that ends in .json"));
    }
    let beside = ["csv", "svg", "png"].map(|kind| output.with_extension(kind));
    for file in beside.iter().map(PathBuf::as_path).chain([output]) {
        output::check(file, &[Path::new(input)])?;
    }
    Ok(beside)
}
