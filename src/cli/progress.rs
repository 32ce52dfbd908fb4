//! Progress on stderr: a moving line on a terminal, one plain line per step elsewhere, nothing where quiet was asked for.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{self, IsTerminal, Write};
use std::time::Duration;

/// The progress of one command.
pub enum Progress {
    /// Says nothing.
    Quiet,
    /// One line per step.
    Lines,
    /// A spinner with the step's name and the time so far.
    Bar(ProgressBar),
}

impl Progress {
    /// As stderr allows, unless `quiet`.
    pub fn new(quiet: bool) -> Self {
        if quiet {
            return Self::Quiet;
        }
        if !io::stderr().is_terminal() {
            return Self::Lines;
        }
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
        if let Ok(style) = ProgressStyle::with_template("{spinner} {msg} {elapsed}") {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(100));
        Self::Bar(bar)
    }

    /// Begins the step `name`.
    pub fn step(&self, name: &str) {
        match self {
            Self::Quiet => {}
            // A stderr that cannot be written has nobody left to tell.
            Self::Lines => drop(writeln!(io::stderr(), "{name} …")),
            Self::Bar(bar) => bar.set_message(name.to_owned()),
        }
    }

    /// Leaves the terminal as it was.
    pub fn finish(&self) {
        if let Self::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.finish();
    }
}
