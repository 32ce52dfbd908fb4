//! Who hears of a run while it goes on: people on stderr, or other programs by lines on stdout.

use super::progress::Progress;
use crate::batch::event::Event;
use crate::batch::outcome::Status;
use crate::cli::console::Console;
use crate::error::{Error, Result};
use clap::ValueEnum;
use std::collections::HashMap;

/// Lines for a farm's engine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Engine {
    /// `openjd_progress:` and `openjd_status:`.
    Openjd,
}

/// Passes events on.
pub struct Told<'a> {
    console: &'a Console,
    to: To<'a>,
    /// The first line that could not be printed.
    failed: Option<Error>,
}

enum To<'a> {
    People(Progress<'a>),
    Events,
    Openjd { due: f64, done: f64, costs: HashMap<usize, f64> },
}

impl<'a> Told<'a> {
    /// People.
    pub fn people(console: &'a Console) -> Self {
        Self { console, to: To::People(Progress::new(console)), failed: None }
    }

    /// A program that reads a line of JSON per event.
    ///
    /// # Errors
    /// Where a result in JSON is asked for as well.
    pub fn events(console: &'a Console) -> Result<Self> {
        if console.json() {
            return Err(Error::usage("lines and one result cannot both go to stdout")
                .with_field("--jsonl")
                .with_found("--json beside it")
                .with_hint("the last line of --jsonl holds the totals"));
        }
        Ok(Self { console, to: To::Events, failed: None })
    }

    /// An engine that reads its own lines.
    pub fn engine(console: &'a Console, engine: Engine) -> Self {
        let Engine::Openjd = engine;
        Self { console, to: To::Openjd { due: 0.0, done: 0.0, costs: HashMap::new() }, failed: None }
    }

    /// Passes an event on.
    pub fn hear(&mut self, event: Event<'_>) {
        let line = match &mut self.to {
            To::People(progress) => return progress.hear(event),
            To::Events => event.value().to_string(),
            To::Openjd { due, done, costs } => match event {
                Event::Start { seconds, due: count, items } => {
                    *due = seconds;
                    format!("openjd_status: {count} of {items} assets are to be baked")
                }
                Event::Begin { entry, seconds, .. } => {
                    costs.insert(entry.item, seconds);
                    format!("openjd_status: {}", entry.input.display())
                }
                Event::End(outcome) if outcome.status != Status::NotRun => {
                    *done += costs.remove(&outcome.item).unwrap_or(0.0);
                    if let Some(fault) = &outcome.fault {
                        self.console.note(&format!("{}: failed: {}", outcome.input.display(), fault.reason));
                    }
                    format!("openjd_progress: {:.1}", (100.0 * *done / due.max(1e-9)).min(100.0))
                }
                Event::Note(text) => return self.console.note(text),
                Event::Step { .. } | Event::End(_) => return,
                Event::Finish(_) => "openjd_progress: 100.0".to_owned(),
            },
        };
        if let Err(error) = self.console.line(&line) {
            self.failed.get_or_insert(error);
        }
    }

    /// Whether a result is still to be printed: not where lines told it all.
    ///
    /// # Errors
    /// Where a line could not be printed.
    pub fn finish(self) -> Result<bool> {
        self.failed.map_or(Ok(!matches!(self.to, To::Events)), Err)
    }
}
