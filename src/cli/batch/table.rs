//! The table at a run's end.

use crate::batch::outcome::{Outcome, Status, Totals};
use std::io::{Result, Write};

/// How many of the slowest are named.
const SLOWEST: usize = 5;
/// How many warnings are shown.
const WARNINGS: usize = 20;

/// Prints what came of a run; `seconds` are those of one process, where it was one.
pub fn print(outcomes: &[Outcome], totals: Totals, seconds: Option<f64>, out: &mut dyn Write) -> Result<()> {
    let Totals { baked, up_to_date, failed, not_run, warnings } = totals;
    let seconds = seconds.map(|seconds| format!("   in {seconds:.1} s")).unwrap_or_default();
    writeln!(out, "{:<12} {baked:>6}{seconds}", "baked")?;
    writeln!(out, "{:<12} {up_to_date:>6}", "up to date")?;
    writeln!(out, "{:<12} {failed:>6}", "failed")?;
    if not_run > 0 {
        writeln!(out, "{:<12} {not_run:>6}", "not run")?;
    }
    for outcome in outcomes {
        if let Some(fault) = &outcome.fault {
            writeln!(out, "  {}: {}", outcome.input.display(), fault.reason)?;
        }
    }
    let mut slowest: Vec<&Outcome> = outcomes.iter().filter(|outcome| outcome.status == Status::Baked).collect();
    slowest.sort_by(|a, b| b.seconds.total_cmp(&a.seconds));
    if slowest.len() > 1 {
        writeln!(out, "slowest")?;
        for outcome in slowest.iter().take(SLOWEST) {
            let (seconds, size) = (outcome.seconds, outcome.bytes as f64 / 1e6);
            writeln!(out, "  {seconds:>7.1} s {size:>8.2} MB  {}", outcome.input.display())?;
        }
    }
    writeln!(out, "{:<12} {warnings:>6}", "warnings")?;
    let all = outcomes.iter().flat_map(|outcome| outcome.warnings.iter().map(|text| (&outcome.input, text)));
    for (input, text) in all.take(WARNINGS) {
        writeln!(out, "  {}: {text}", input.display())?;
    }
    if warnings > WARNINGS {
        writeln!(out, "  and {} more", warnings - WARNINGS)?;
    }
    Ok(())
}

/// Prints what would be done, which would take so many seconds of one thread.
pub fn foretell(outcomes: &[Outcome], seconds: f64, out: &mut dyn Write) -> Result<()> {
    let mut due = 0;
    for outcome in outcomes {
        let input = outcome.input.display();
        match &outcome.fault {
            Some(fault) => writeln!(out, "fail        {input}: {}", fault.reason)?,
            None if outcome.why.is_empty() => writeln!(out, "up to date  {input}")?,
            None => {
                due += 1;
                writeln!(out, "bake        {input}: {}", outcome.why.join("; "))?;
            }
        }
    }
    writeln!(out, "{due} of {} would be baked, about {seconds:.0} s of one thread", outcomes.len())
}
