//! Floor 11: the command line. One file per subcommand: parse, call the library, print.

mod axes;
mod bake;
mod batch;
mod cache;
mod cache_flags;
mod compare;
mod completions;
mod console;
mod devices;
mod flags;
mod inspect;
mod output;
mod presets;
mod progress;
mod recipe;
mod render;
mod report;
#[cfg(feature = "window")]
mod spoken;
mod stage;
mod strip;
mod view;

use crate::error::{Kind, Result};
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use console::Console;
use flags::Flags;
use std::ffi::OsString;
use std::process::ExitCode;

/// Bakes fur for games: a mesh and a preset in, the same asset with shells and fins out
#[derive(Debug, Parser)]
#[command(name = "furrier", version, propagate_version = true, after_long_help = AFTER_HELP)]
struct Cli {
    /// Print nothing but results and errors
    #[arg(short, long, global = true, conflicts_with = "verbose")]
    quiet: bool,
    /// Say on stderr what is being done; twice for every detail
    #[arg(short, long, global = true, action = clap::ArgAction::Count)]
    verbose: u8,
    /// Print the result as JSON on stdout, and nothing else there
    #[arg(long, global = true)]
    json: bool,
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Bake(bake::Bake),
    Batch(batch::Batch),
    Render(render::Render),
    Report(report::Report),
    View(view::View),
    Inspect(inspect::Inspect),
    Compare(compare::Compare),
    Strip(strip::Strip),
    Cache(cache::Cache),
    Presets(presets::Presets),
    Devices(devices::Devices),
    Completions(completions::Completions),
}

const AFTER_HELP: &str = "\
Exit codes:
  0  done
  1  a comparison exceeded its limit
  2  the command line or a preset asks for something impossible
  3  an input file is missing, broken or unsupported
  4  an output could not be written
  5  there is no graphics adapter, or it failed
  6  some assets of a batch failed; the others are baked
  75 the machine failed, not an asset, and what was asked for may succeed elsewhere or later (batch run)

Results go to stdout; progress, warnings and errors to stderr.";

/// Runs the command line `arguments` (the program's name first) and returns the exit code: 0, or that of the failure's
/// [`Kind`].
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let mut definition = definition();
    let parsed = definition
        .try_get_matches_from_mut(arguments)
        .and_then(|matches| Ok((Cli::from_arg_matches(&matches)?, Flags::of(&definition, &matches))));
    let (cli, flags) = match parsed {
        Ok(parsed) => parsed,
        Err(error) => {
            // Help and version are no failures; where they cannot be printed there is nobody left to tell.
            let _ = error.print();
            return if error.use_stderr() { ExitCode::from(Kind::Usage.exit_code()) } else { ExitCode::SUCCESS };
        }
    };
    let console = Console::new(cli.quiet, cli.verbose, cli.json, flags);
    match cli.command.run(&console) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            let code = error.kind.exit_code();
            console.error(error);
            ExitCode::from(code)
        }
    }
}

/// The command line's definition, from which help, completions and `docs/cli.md` are made.
pub fn definition() -> clap::Command {
    Cli::command()
}

impl Command {
    fn run(self, console: &Console) -> Result<()> {
        match self {
            Self::Bake(command) => command.run(console),
            Self::Batch(command) => command.run(console),
            Self::Render(command) => command.run(console),
            Self::Report(command) => command.run(console),
            Self::View(command) => command.run(console),
            Self::Compare(command) => command.run(console),
            Self::Inspect(command) => command.run(console),
            Self::Strip(command) => command.run(console),
            Self::Cache(command) => command.run(console),
            Self::Presets(command) => command.run(console),
            Self::Devices(command) => command.run(console),
            Self::Completions(command) => command.run(console),
        }
    }
}
