//! What is told of a run while it goes on.

use super::outcome::{Outcome, Totals};
use super::plan::Entry;
use serde_json::{Value, json};

/// Something that happened.
#[derive(Clone, Copy, Debug)]
pub enum Event<'a> {
    /// It is known what is to be done.
    Start {
        /// Assets looked at.
        items: usize,
        /// Assets to bake.
        due: usize,
        /// Their cost on one thread, s.
        seconds: f64,
    },
    /// Something that the user should know.
    Note(&'a str),
    /// An asset is begun.
    Begin {
        /// Which.
        entry: &'a Entry,
        /// What it will cost on one thread, s.
        seconds: f64,
        /// Threads it has.
        threads: usize,
    },
    /// A step of an asset is begun.
    Step {
        /// Which.
        item: usize,
        /// The step's name.
        step: &'static str,
    },
    /// It is known what came of an asset.
    End(&'a Outcome),
    /// All is done.
    Finish(Totals),
}

impl Event<'_> {
    /// As a line for other programs.
    pub fn value(&self) -> Value {
        match self {
            Self::Start { items, due, seconds } => {
                json!({ "event": "start", "items": items, "due": due, "estimated_seconds": seconds })
            }
            Self::Note(text) => json!({ "event": "note", "text": text }),
            Self::Begin { entry, seconds, threads } => json!({
                "event": "begin", "item": entry.item, "input": entry.input, "output": entry.output,
                "estimated_seconds": seconds, "threads": threads,
            }),
            Self::Step { item, step } => json!({ "event": "step", "item": item, "step": step }),
            Self::End(outcome) => {
                let mut value = json!(outcome);
                if let Some(members) = value.as_object_mut() {
                    members.shift_insert(0, "event".into(), json!("end"));
                }
                value
            }
            Self::Finish(totals) => {
                let mut value = json!(totals);
                if let Some(members) = value.as_object_mut() {
                    members.shift_insert(0, "event".into(), json!("finish"));
                }
                value
            }
        }
    }
}

/// Hears what happens.
pub type Listen<'a> = dyn FnMut(Event<'_>) + 'a;
