//! `furrier strip`.

use super::console::Console;
use super::output;
use crate::asset;
use crate::asset::coat::{strip, write_stripped};
use crate::error::Result;
use clap::Args;
use serde_json::{Map, json};
use std::path::PathBuf;

/// Take the coat off a file: the one that it was baked from comes back
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  furrier strip furry.glb -o bare.glb
      bare.glb is the file that furry.glb was baked from, byte for byte
  furrier strip edited.glb -o bare.glb
      what another program changed or added stays; extension, shells, their textures and names go

A baked file keeps the JSON of its input, compressed, beside the data that both share. Where it
was changed since, where the input was an OBJ or a built-in mesh, or where the output is of another
kind (.gltf for a .glb), the coat alone is taken off, and that is said. What a .gltf names, its .bin
and its pictures, does not come back: it lies where it lay.")]
pub struct Strip {
    /// A file that furrier baked, or what another program left of one
    file: PathBuf,
    /// The .glb or .gltf to write; never the input itself
    #[arg(short, long, value_name = "OUT.glb")]
    output: PathBuf,
}

impl Strip {
    /// Takes the coat off, writes what is left, and says what that is.
    ///
    /// # Errors
    /// As [`strip`] and [`write_stripped`].
    pub fn run(self, console: &Console) -> Result<()> {
        output::check(&self.output, &[&self.file])?;
        let (document, warnings) = asset::read_document(&self.file)?;
        warnings.iter().for_each(|warning| console.warning(warning));
        let stripped = strip(&document)?;
        let removed: Map<_, _> = stripped.removed.iter().map(|(list, n)| ((*list).to_owned(), json!(n))).collect();
        let (identical, notes) = write_stripped(stripped, &self.output)?;
        notes.iter().for_each(|note| console.note(note));
        let outcome = json!({"output": self.output, "identical": identical, "removed": removed, "notes": notes, "warnings": warnings});
        console.result(&outcome, |out| {
            let (output, file) = (self.output.display(), self.file.display());
            match identical {
                true => writeln!(out, "{output}: the file that {file} was baked from, byte for byte"),
                false => writeln!(out, "{output}: {file} without its coat, not the bytes of its input"),
            }
        })
    }
}
