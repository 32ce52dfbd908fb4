//! `furrier batch init`.

use crate::batch::library::starter;
use crate::cli::console::Console;
use crate::error::Result;
use clap::Args;
use serde_json::json;
use std::path::PathBuf;

/// Write a furrier.toml with comments into a folder
#[derive(Debug, Args)]
pub struct Init {
    /// The library's folder
    #[arg(default_value = ".")]
    folder: PathBuf,
}

impl Init {
    /// Writes it.
    ///
    /// # Errors
    /// Where there is one, or it cannot be written.
    pub fn run(self, console: &Console) -> Result<()> {
        let path = starter::write(&self.folder)?;
        console.result(&json!({ "written": path }), |out| {
            writeln!(
                out,
                "{}: change what is baked how in it, then `furrier batch {}`",
                path.display(),
                self.folder.display()
            )
        })
    }
}
