//! Progress of a batch on stderr: on a terminal a bar with the time left and a line per asset under way, elsewhere a plain line as
//! each asset ends.

use crate::batch::event::Event;
use crate::batch::outcome::{Outcome, Status};
use crate::cli::console::Console;
use indicatif::{MultiProgress, ProgressBar, ProgressStyle};
use std::collections::HashMap;
use std::io::{self, IsTerminal};
use std::time::{Duration, Instant};

/// Says what happens.
pub struct Progress<'a> {
    console: &'a Console,
    bars: Option<Bars>,
    due: usize,
    ended: usize,
    started: Instant,
    /// Cost of what is due and of what of it is done, s of one thread.
    cost: [f64; 2],
    costs: HashMap<usize, f64>,
}

/// What moves on a terminal.
struct Bars {
    all: MultiProgress,
    overall: ProgressBar,
    running: HashMap<usize, ProgressBar>,
}

impl<'a> Progress<'a> {
    /// As stderr allows.
    pub fn new(console: &'a Console) -> Self {
        let bars = (!console.quiet() && io::stderr().is_terminal()).then(|| {
            let all = MultiProgress::new();
            let overall = all.add(ProgressBar::new(0));
            if let Ok(style) = ProgressStyle::with_template("{bar:32} {pos}/{len} {elapsed} {msg}") {
                overall.set_style(style);
            }
            Bars { all, overall, running: HashMap::new() }
        });
        Self { console, bars, due: 0, ended: 0, started: Instant::now(), cost: [0.0; 2], costs: HashMap::new() }
    }

    /// Takes note of what happened.
    pub fn hear(&mut self, event: Event<'_>) {
        match event {
            Event::Start { due, seconds, .. } => {
                (self.due, self.cost[0], self.started) = (due, seconds, Instant::now());
                if let Some(bars) = &self.bars {
                    bars.overall.set_length(due as u64);
                    bars.overall.enable_steady_tick(Duration::from_millis(250));
                }
            }
            Event::Note(text) => self.say(|console| console.note(text)),
            Event::Begin { entry, seconds, .. } => {
                self.costs.insert(entry.item, seconds);
                if let Some(bars) = &mut self.bars {
                    let bar = bars.all.add(ProgressBar::new_spinner());
                    if let Ok(style) = ProgressStyle::with_template("  {spinner} {prefix} {msg} {elapsed}") {
                        bar.set_style(style);
                    }
                    bar.set_prefix(entry.input.display().to_string());
                    bar.enable_steady_tick(Duration::from_millis(250));
                    bars.running.insert(entry.item, bar);
                }
            }
            Event::Step { item, step } => {
                if let Some(bar) = self.bars.as_ref().and_then(|bars| bars.running.get(&item)) {
                    bar.set_message(step);
                }
            }
            Event::End(outcome) => self.end(outcome),
            Event::Finish(_) => {}
        }
    }

    fn end(&mut self, outcome: &Outcome) {
        // What was up to date or never begun is in the table.
        let Some(cost) = self.costs.remove(&outcome.item) else { return };
        self.ended += 1;
        self.cost[1] += cost;
        let left = match self.cost {
            [all, done] if done > 0.0 => self.started.elapsed().as_secs_f64() * (all - done).max(0.0) / done,
            _ => 0.0,
        };
        let left = format!("about {} left", duration(left));
        if let Some(bars) = &mut self.bars {
            if let Some(bar) = bars.running.remove(&outcome.item) {
                bar.finish_and_clear();
            }
            bars.overall.set_position(self.ended as u64);
            bars.overall.set_message(left.clone());
        }
        let input = outcome.input.display();
        let line = match (&outcome.fault, outcome.status) {
            (Some(fault), _) => format!("{input}: failed: {}", fault.reason),
            (None, Status::Baked) => format!("{input}: baked in {:.1} s", outcome.seconds),
            (None, _) => return,
        };
        match &self.bars {
            Some(_) if outcome.fault.is_none() => {}
            Some(_) => self.say(|console| console.note(&line)),
            None => self.console.note(&format!("{}/{} {line}; {left}", self.ended, self.due)),
        }
    }

    /// Prints above what moves.
    fn say(&self, print: impl FnOnce(&Console)) {
        match &self.bars {
            Some(bars) => bars.all.suspend(|| print(self.console)),
            None => print(self.console),
        }
    }
}

impl Drop for Progress<'_> {
    fn drop(&mut self) {
        if let Some(bars) = &self.bars {
            bars.overall.finish_and_clear();
        }
    }
}

fn duration(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    match whole {
        0..60 => format!("{whole} s"),
        60..3600 => format!("{} min {} s", whole / 60, whole % 60),
        _ => format!("{} h {} min", whole / 3600, whole % 3600 / 60),
    }
}
