//! What came of each asset, and of all together.

use super::standing::Why;
use crate::error::{Error, Kind};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// How it ended for one asset.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// A new output.
    Baked,
    /// There was nothing to do.
    UpToDate,
    /// No new output.
    Failed,
    /// It was not begun.
    NotRun,
}

/// Why an asset failed.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Fault {
    /// Whether the machine is at fault rather than the asset: a disk that is full, a device that is gone.
    pub machine: bool,
    /// In one line.
    pub reason: String,
}

impl From<&Error> for Fault {
    fn from(error: &Error) -> Self {
        let place = error.field.as_deref().or(error.parameter);
        let parts = [("at", place), ("found", error.found.as_deref()), ("expected", error.expected.as_deref())];
        let mut reason = error.what.clone();
        for (i, (label, text)) in parts.into_iter().filter_map(|(label, text)| Some((label, text?))).enumerate() {
            reason.push_str(if i == 0 { ": " } else { ", " });
            reason.push_str(&format!("{label} {}", text.split_whitespace().collect::<Vec<_>>().join(" ")));
        }
        Self { machine: matches!(error.kind, Kind::Output | Kind::Device), reason }
    }
}

/// What came of one asset.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// Its place in the plan.
    pub item: usize,
    /// As the plan has it.
    pub input: PathBuf,
    /// As the plan has it.
    pub output: PathBuf,
    /// How it ended.
    pub status: Status,
    /// Why it was baked, or tried.
    pub why: Vec<String>,
    /// Why it failed.
    pub fault: Option<Fault>,
    /// Time of its last bake, s.
    pub seconds: f64,
    /// Threads that bake had.
    pub threads: usize,
    /// Size of the output, bytes.
    pub bytes: u64,
    /// Hash of the output; empty where there is none.
    pub digest: String,
    /// What may not be as the user expects, one sentence each.
    pub warnings: Vec<String>,
}

impl Outcome {
    /// Why it was baked, in words.
    pub fn reasons(why: &[Why]) -> Vec<String> {
        why.iter().map(Why::to_string).collect()
    }
}

/// All assets in numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Totals {
    /// New outputs.
    pub baked: usize,
    /// Nothing to do.
    pub up_to_date: usize,
    /// No new output.
    pub failed: usize,
    /// Not begun.
    pub not_run: usize,
    /// Sentences, of all assets.
    pub warnings: usize,
}

impl Totals {
    /// Counts.
    pub fn of(outcomes: &[Outcome]) -> Self {
        let count = |status| outcomes.iter().filter(|outcome| outcome.status == status).count();
        Self {
            baked: count(Status::Baked),
            up_to_date: count(Status::UpToDate),
            failed: count(Status::Failed),
            not_run: count(Status::NotRun),
            warnings: outcomes.iter().map(|outcome| outcome.warnings.len()).sum(),
        }
    }
}
