//! What machines found of a plan's items, a small file each beside the plan: any machine can do any item, twice if it must.

use super::outcome::{Outcome, Status};
use super::plan::{Entry, Plan};
use super::record::create;
use super::run::blank;
use crate::asset::write;
use crate::error::{Error, Kind, Result};
use std::path::{Path, PathBuf};

/// The folder with the fragments of a plan.
#[derive(Clone, Debug)]
pub struct Fragments(PathBuf);

impl Fragments {
    /// Of the plan in this file.
    pub fn of(plan: &Path) -> Self {
        let mut name = plan.file_name().unwrap_or_default().to_owned();
        name.push(".parts");
        Self(plan.with_file_name(name))
    }

    fn file(&self, item: usize) -> PathBuf {
        self.0.join(format!("{item:06}.json"))
    }

    /// Keeps outcomes. One that was baked earlier stays that where it is found up to date when it is asked for again.
    ///
    /// # Errors
    /// Where they cannot be written.
    pub fn put(&self, outcomes: &[&Outcome]) -> Result<()> {
        create(&self.0)?;
        for outcome in outcomes {
            let earlier = self.get(outcome.item);
            let same = |earlier: &Outcome| earlier.status == Status::Baked && earlier.digest == outcome.digest;
            if outcome.status == Status::UpToDate && earlier.as_ref().is_some_and(same) {
                continue;
            }
            let text = serde_json::to_vec(outcome)
                .map_err(|error| Error::new(Kind::Output, "an outcome cannot be encoded").with_found(error))?;
            write::whole(&self.file(outcome.item), &text, &[])?;
        }
        Ok(())
    }

    fn get(&self, item: usize) -> Option<Outcome> {
        serde_json::from_slice(&std::fs::read(self.file(item)).ok()?).ok()
    }

    /// What came of every item; one that nothing is known of was not run.
    pub fn all(&self, plan: &Plan) -> Vec<Outcome> {
        let of =
            |entry: &Entry| self.get(entry.item).filter(|o| o.input == entry.input).unwrap_or_else(|| blank(entry));
        plan.entries.iter().map(of).collect()
    }
}
