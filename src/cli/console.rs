//! What the command line prints and where: results on stdout, everything else on stderr.

use super::flags::Flags;
use super::progress::Progress;
use crate::error::{Error, Kind, Result};
use serde::Serialize;
use std::io::{self, IsTerminal, Write};
use tracing_subscriber::EnvFilter;

/// The two streams and what the user asked of them.
pub struct Console {
    json: bool,
    quiet: bool,
    flags: Flags,
}

impl Console {
    /// Sets up printing and, on stderr, the library's log. What the library calls by its own name is printed as one of `flags`.
    pub fn new(quiet: bool, verbose: u8, json: bool, flags: Flags) -> Self {
        let level = match (quiet, verbose) {
            (true, _) => "off",
            (_, 0) => "warn",
            (_, 1) => "info",
            (_, _) => "debug",
        };
        tracing_subscriber::fmt()
            .with_env_filter(EnvFilter::new(format!("off,furrier={level}")))
            .with_writer(io::stderr)
            .with_ansi(io::stderr().is_terminal())
            .with_target(false)
            .without_time()
            .init();
        Self { json, quiet, flags }
    }

    /// Prints a command's result: `value` as JSON where asked for, else what `text` writes.
    ///
    /// # Errors
    /// [`Kind::Output`] where stdout takes no more; a reader who has gone away (`| head`) is none.
    pub fn result<T: Serialize>(&self, value: &T, text: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<()> {
        let mut out = io::BufWriter::new(io::stdout().lock());
        let written = if self.json {
            serde_json::to_writer_pretty(&mut out, value).map_err(io::Error::from).and_then(|()| writeln!(out))
        } else {
            text(&mut out)
        };
        printed(written.and_then(|()| out.flush()))
    }

    /// Prints a line on stdout for a program that reads along.
    ///
    /// # Errors
    /// As [`Self::result`].
    pub fn line(&self, text: &str) -> Result<()> {
        let mut out = io::stdout().lock();
        printed(writeln!(out, "{text}").and_then(|()| out.flush()))
    }

    /// Progress of a command that takes time.
    pub fn progress(&self) -> Progress {
        Progress::new(self.quiet)
    }

    /// Prints what the user should know but need not act on.
    pub fn note(&self, text: &str) {
        self.aside(format_args!("{}", self.flags.in_text(text)));
    }

    /// Prints what may not be as the user expects.
    pub fn warning(&self, text: &str) {
        self.aside(format_args!("warning: {}", self.flags.in_text(text)));
    }

    fn aside(&self, line: std::fmt::Arguments) {
        if !self.quiet {
            // A stderr that cannot be written has nobody left to tell.
            let _ = writeln!(io::stderr(), "{line}");
        }
    }

    /// Prints a failure with its hint.
    pub fn error(&self, error: Error) {
        let style = if io::stderr().is_terminal() {
            miette::GraphicalTheme::unicode()
        } else {
            miette::GraphicalTheme::unicode_nocolor()
        };
        let mut text = String::new();
        let report = miette::GraphicalReportHandler::new_themed(style).with_wrap_lines(false);
        // Writing to a string cannot fail, and a stderr that cannot be written has nobody left to tell.
        let _ = report.render_report(&mut text, &self.flags.in_error(error));
        let _ = write!(io::stderr(), "{text}");
    }

    /// Whether nothing but results and errors is printed.
    pub fn quiet(&self) -> bool {
        self.quiet
    }

    /// Whether results are asked for as JSON.
    pub fn json(&self) -> bool {
        self.json
    }
}

/// A stdout that takes no more is a failure; a reader who has gone away is none.
fn printed(written: io::Result<()>) -> Result<()> {
    match written {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Error::new(Kind::Output, "the result could not be printed").with_found(error))
        }
        _ => Ok(()),
    }
}
