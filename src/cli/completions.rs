//! `furrier completions`.

use super::console::Console;
use crate::error::{Error, Result};
use clap::Args;
use clap_complete::Shell;

/// Print a shell's completion script
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  furrier completions bash > ~/.local/share/bash-completion/completions/furrier
  furrier completions zsh > ~/.zfunc/_furrier
  furrier completions fish > ~/.config/fish/completions/furrier.fish")]
pub struct Completions {
    /// The shell
    shell: Shell,
}

impl Completions {
    /// Prints the script.
    ///
    /// # Errors
    /// With `--json`: a script has no such form.
    pub fn run(self, console: &Console) -> Result<()> {
        if console.json() {
            return Err(Error::usage("a completion script has no JSON form")
                .with_field("--json")
                .with_hint("leave it out"));
        }
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut super::definition(), "furrier", &mut script);
        console.result(&(), |out| out.write_all(&script))
    }
}
