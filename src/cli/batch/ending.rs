//! What a run leaves behind beside its outputs: a table, a page, a JUnit file, a verdict.

use super::{look, summary, table};
use crate::asset::write;
use crate::batch::junit::junit;
use crate::batch::outcome::{Outcome, Totals};
use crate::batch::page::page;
use crate::batch::plan::Plan;
use crate::batch::record::create;
use crate::batch::results::{Results, Row, has_output};
use crate::cli::compare::check_limit;
use crate::cli::console::Console;
use crate::error::{Error, Kind, Result};
use clap::Args;
use std::path::{Path, PathBuf};

/// What is written and judged at a run's end.
#[derive(Clone, Debug, Args)]
pub struct EndingArgs {
    /// Write what came of each asset as JUnit's XML, which build servers read
    #[arg(long, value_name = "FILE.xml")]
    junit: Option<PathBuf>,
    /// Write a page into this folder, index.html: a picture, size, time, error and warnings of each asset, old against new where the
    /// folder has an earlier one. results.json beside it holds the same for --regress
    #[arg(long, value_name = "FOLDER")]
    report: Option<PathBuf>,
    /// Measure how far each coat is off its fur, as `report coat` does, from two sides; some seconds each. What was measured of
    /// the same output is not measured again
    #[arg(long)]
    measure: bool,
    /// Measure, and exit with 1 where an asset's FLIP over the floor is more than this
    #[arg(long, value_name = "FLIP")]
    max_flip: Option<f64>,
    /// Measure, and exit with 1 where an asset's error grew since these results of an earlier run, by more than 0.002
    #[arg(long, value_name = "RESULTS.json")]
    regress: Option<PathBuf>,
}

/// The page's pictures lie here.
const PICTURES: &str = "pictures";

impl EndingArgs {
    /// Fails before the work where something cannot be.
    ///
    /// # Errors
    /// Names the option.
    pub fn check(&self) -> Result<()> {
        check_limit(self.max_flip)?;
        if let Some(path) = &self.junit {
            write::check_target(path, &[])?;
        }
        self.regress.as_deref().map(Results::read).transpose()?;
        Ok(())
    }

    /// Writes what was asked for, prints the table of a run that took `seconds`, and gives the verdict. Nothing is printed where
    /// `told` already.
    ///
    /// # Errors
    /// [`Kind::Some`] where assets failed; [`Kind::Difference`] where an error is too large; where something cannot be written.
    pub fn end(
        &self,
        plan: &Plan,
        outcomes: Vec<Outcome>,
        seconds: Option<f64>,
        told: bool,
        console: &Console,
    ) -> Result<()> {
        if let Some(path) = &self.junit {
            write::whole(path, junit(&outcomes)?.as_bytes(), &[])?;
        }
        let before = self.regress.as_deref().map(Results::read).transpose()?;
        let results = self.results(plan, outcomes, console)?;
        if let Some(folder) = &self.report {
            publish(folder, &results, before.as_ref())?;
        }
        let outcomes: Vec<Outcome> = results.rows.iter().map(|row| row.outcome.clone()).collect();
        if !told {
            console.result(&summary(&outcomes), |out| table::print(&outcomes, Totals::of(&outcomes), seconds, out))?;
        }
        failures(&outcomes)?;
        worse(&results, self.max_flip, before.as_ref())
    }

    /// Draws and measures what was asked for.
    fn results(&self, plan: &Plan, outcomes: Vec<Outcome>, console: &Console) -> Result<Results> {
        let measured = self.measure || self.max_flip.is_some() || self.regress.is_some();
        let progress = (measured || self.report.is_some()).then(|| console.progress());
        if let Some(folder) = &self.report {
            create(&folder.join(PICTURES))?;
        }
        let mut rows = Vec::with_capacity(outcomes.len());
        let mut unseen: Option<Error> = None;
        let count = outcomes.len();
        for outcome in outcomes {
            let (mut flip, mut shown) = (None, None);
            if let Some(progress) = progress.as_ref().filter(|_| has_output(&outcome)) {
                progress.step(&format!("look at {} ({} of {count})", outcome.input.display(), rows.len() + 1));
                if let Some(folder) = &self.report {
                    match picture(folder, plan, &outcome) {
                        Ok(name) => shown = Some(name),
                        // Without an adapter there are no pictures; all else is told.
                        Err(error) if error.kind != Kind::Output => unseen = Some(error),
                        Err(error) => return Err(error),
                    }
                }
                if measured {
                    match look::flip(plan, &outcome) {
                        Ok(found) => flip = Some(found),
                        Err(error) => {
                            console.warning(&format!("{}: not measured: {}", outcome.input.display(), error.what))
                        }
                    }
                }
            }
            rows.push(Row { outcome, flip, picture: shown });
        }
        if let Some(error) = unseen {
            console.warning(&format!("there are no pictures of some assets: {}", error.what));
        }
        Ok(Results::new(rows))
    }
}

/// The picture of an outcome, drawn where it is not there yet: its name in the report's folder.
fn picture(folder: &Path, plan: &Plan, outcome: &Outcome) -> Result<String> {
    let name = format!("{PICTURES}/{}.png", outcome.digest.get(..32).unwrap_or(&outcome.digest));
    let path = folder.join(&name);
    if !path.is_file() {
        write::whole(&path, &look::picture(&plan.output(&plan.entries[outcome.item]))?, &[])?;
    }
    Ok(name)
}

/// Writes the page beside what it shows; pictures that neither it nor the earlier one shows are removed.
fn publish(folder: &Path, results: &Results, before: Option<&Results>) -> Result<()> {
    let file = folder.join("results.json");
    let own = if before.is_none() && file.is_file() { Results::read(&file).ok() } else { None };
    let before = before.or(own.as_ref());
    write::whole(&folder.join("index.html"), page(results, before).as_bytes(), &[])?;
    results.write(&file)?;
    let shown: Vec<&str> = [Some(results), before]
        .into_iter()
        .flatten()
        .flat_map(|r| &r.rows)
        .filter_map(|row| row.picture.as_deref())
        .collect();
    for entry in std::fs::read_dir(folder.join(PICTURES)).into_iter().flatten().flatten() {
        let name = format!("{PICTURES}/{}", entry.file_name().to_string_lossy());
        if name.ends_with(".png") && !shown.contains(&name.as_str()) {
            let _ = std::fs::remove_file(entry.path());
        }
    }
    Ok(())
}

/// Fails where an asset did.
fn failures(outcomes: &[Outcome]) -> Result<()> {
    let totals = Totals::of(outcomes);
    if totals.failed == 0 && totals.not_run == 0 {
        return Ok(());
    }
    let left = if totals.not_run > 0 { format!(", {} not run", totals.not_run) } else { String::new() };
    Err(Error::new(Kind::Some, "some assets failed")
        .with_found(format!("{} of {} failed{left}", totals.failed, outcomes.len()))
        .with_hint("the others are up to date; the table says why each failed, and `furrier bake` on one says more"))
}

/// Fails where an error is over the limit, or grew.
fn worse(results: &Results, limit: Option<f64>, before: Option<&Results>) -> Result<()> {
    let worse = results.worse(limit, before);
    let Some((input, found)) = worse.first() else { return Ok(()) };
    let more = if worse.len() > 1 { format!("; and {} more", worse.len() - 1) } else { String::new() };
    Err(Error::new(Kind::Difference, "coats are off by more than they may be")
        .with_file(input)
        .with_field("flip")
        .with_found(format!("{found}{more}")))
}
