//! What came of a library, with pictures and errors: what a report shows, and what a later run is compared with.

use super::content::Digest;
use super::outcome::{Outcome, Status};
use crate::asset::write;
use crate::error::{Error, Kind, Result};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// An asset in a report.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Row {
    /// What came of it.
    pub outcome: Outcome,
    /// FLIP of the coat against its fur, over the floor of another growth; none where it was not measured.
    pub flip: Option<f64>,
    /// File of its picture, relative to the report.
    pub picture: Option<String>,
}

/// Of all assets, in the plan's order.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Results {
    furrier_results: u32,
    /// One per asset.
    pub rows: Vec<Row>,
}

/// Version of the file's layout.
const LAYOUT: u32 = 1;
/// An error that grew by less than this is the same: pictures are drawn with eight bits.
pub const SAME_FLIP: f64 = 0.002;

impl Results {
    /// Of rows.
    pub fn new(rows: Vec<Row>) -> Self {
        Self { furrier_results: LAYOUT, rows }
    }

    /// Reads what an earlier run wrote.
    ///
    /// # Errors
    /// Where it cannot be read.
    pub fn read(path: &Path) -> Result<Self> {
        let fault = |found: String| {
            Error::input("the results of an earlier run cannot be read")
                .with_file(path)
                .with_found(found)
                .with_expected("results.json, as `report` writes it")
        };
        let bytes = std::fs::read(path).map_err(|error| fault(error.to_string()))?;
        let results: Self = serde_json::from_slice(&bytes).map_err(|error| fault(error.to_string()))?;
        if results.furrier_results != LAYOUT {
            return Err(fault(format!("layout {}", results.furrier_results)));
        }
        Ok(results)
    }

    /// Writes them.
    ///
    /// # Errors
    /// Where the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<()> {
        let mut text = serde_json::to_vec_pretty(self)
            .map_err(|error| Error::new(Kind::Output, "the results cannot be encoded").with_found(error))?;
        text.push(b'\n');
        write::whole(path, &text, &[])
    }

    /// The row of the same output.
    pub fn row(&self, output: &Path) -> Option<&Row> {
        self.rows.iter().find(|row| row.outcome.output == output)
    }

    /// Assets whose error is over a limit, or grew since an earlier run: input, and why.
    pub fn worse(&self, limit: Option<f64>, before: Option<&Self>) -> Vec<(&Path, String)> {
        let mut found = Vec::new();
        for row in &self.rows {
            let Some(flip) = row.flip else { continue };
            let input = row.outcome.input.as_path();
            if let Some(limit) = limit.filter(|limit| flip > *limit) {
                found.push((input, format!("FLIP {flip:.4}, at most {limit}")));
            }
            let old = before.and_then(|before| before.row(&row.outcome.output)).and_then(|row| row.flip);
            if let Some(old) = old.filter(|old| flip > *old + SAME_FLIP) {
                found.push((input, format!("FLIP {flip:.4}, before {old:.4}")));
            }
        }
        found
    }
}

/// Errors that were measured, by the output's hash: a coat that stays the same is measured once.
#[derive(Clone, Debug)]
pub struct Errors<'a> {
    /// Where records are kept.
    pub state: &'a Path,
    /// Names how it was measured.
    pub method: &'a str,
}

impl Errors<'_> {
    fn file(&self, outcome: &Outcome) -> std::path::PathBuf {
        let key = Digest::of(format!("{} {}", outcome.digest, self.method).as_bytes());
        self.state.join("errors").join(format!("{}.json", key.short()))
    }

    /// The error of an outcome, where it was measured.
    pub fn get(&self, outcome: &Outcome) -> Option<f64> {
        serde_json::from_slice(&std::fs::read(self.file(outcome)).ok()?).ok()
    }

    /// Keeps an error.
    ///
    /// # Errors
    /// Where it cannot be written.
    pub fn put(&self, outcome: &Outcome, flip: f64) -> Result<()> {
        super::record::create(&self.state.join("errors"))?;
        write::whole(&self.file(outcome), flip.to_string().as_bytes(), &[])
    }
}

/// Whether there is an output to look at.
pub fn has_output(outcome: &Outcome) -> bool {
    matches!(outcome.status, Status::Baked | Status::UpToDate)
}
