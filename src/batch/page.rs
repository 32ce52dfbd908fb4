//! A library as a page: a picture, size, time, error and warnings of each asset, old against new, sortable by a click.

use super::outcome::{Status, Totals};
use super::results::{Results, Row};

/// What stands around the rows.
const PAGE: &str = include_str!("page.html");

/// The page; `before` is an earlier run's.
pub fn page(results: &Results, before: Option<&Results>) -> String {
    let outcomes: Vec<_> = results.rows.iter().map(|row| row.outcome.clone()).collect();
    let Totals { baked, up_to_date, failed, not_run, warnings } = Totals::of(&outcomes);
    let totals = format!(
        "{} assets: {baked} baked, {up_to_date} up to date, {failed} failed, {not_run} not run, {warnings} warnings",
        outcomes.len()
    );
    let rows: String =
        results.rows.iter().map(|row| line(row, before.and_then(|before| before.row(&row.outcome.output)))).collect();
    PAGE.replace("{{totals}}", &escaped(&totals)).replace("{{rows}}", &rows)
}

fn line(row: &Row, old: Option<&Row>) -> String {
    let outcome = &row.outcome;
    // What did not change has nothing to be compared with.
    let old = old.filter(|old| old.outcome.digest != outcome.digest && !old.outcome.digest.is_empty());
    let status = match outcome.status {
        Status::Baked => "baked",
        Status::UpToDate => "up to date",
        Status::Failed => "failed",
        Status::NotRun => "not run",
    };
    let said = outcome.fault.iter().map(|fault| format!("<p class=fault>{}</p>", escaped(&fault.reason)));
    let said = said.chain(outcome.warnings.iter().map(|text| format!("<p>{}</p>", escaped(text))));
    let megabytes = |row: &Row| Some(row.outcome.bytes as f64 / 1e6).filter(|_| row.outcome.bytes > 0);
    let seconds = |row: &Row| Some(row.outcome.seconds).filter(|s| *s > 0.0);
    format!(
        "<tr class=\"{class}\"><td>{picture}</td><td>{old_picture}</td><td data-key=\"{input}\">{input}</td><td data-key=\"{status}\">{status}</td>{size}{time}{flip}<td data-key=\"{count}\">{said}</td></tr>\n",
        class = status.replace(' ', "-"),
        picture = picture(row),
        old_picture = old.map(picture).unwrap_or_default(),
        input = escaped(&outcome.input.to_string_lossy()),
        size = number(megabytes(row), old.and_then(megabytes), 2),
        time = number(seconds(row), old.and_then(seconds), 1),
        flip = number(row.flip, old.and_then(|old| old.flip), 4),
        count = outcome.warnings.len() + usize::from(outcome.fault.is_some()) * 1000,
        said = said.collect::<String>(),
    )
}

fn picture(row: &Row) -> String {
    let alt = escaped(&row.outcome.input.to_string_lossy());
    row.picture.as_deref().map(|file| format!("<img src=\"{}\" alt=\"{alt}\">", escaped(file))).unwrap_or_default()
}

/// A cell with a number, and the old one below it.
fn number(new: Option<f64>, old: Option<f64>, places: usize) -> String {
    let Some(new) = new else { return "<td data-key=\"-1\"></td>".to_owned() };
    let old = old.map(|old| format!("<br><span class=old>{old:.places$}</span>")).unwrap_or_default();
    format!("<td class=number data-key=\"{new}\">{new:.places$}{old}</td>")
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
