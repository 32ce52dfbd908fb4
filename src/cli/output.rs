//! Files that the command line writes beside furry assets: pictures and reports, whole or not at all.

use crate::asset::write;
use crate::error::{Error, Kind, Result};
use crate::metrics::timing::Report;
use serde::Serialize;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Fails, before any work is done, where `path` cannot be written or is one of `others`.
///
/// # Errors
/// Names the path and what is wrong with it.
pub fn check(path: &Path, others: &[&Path]) -> Result<()> {
    if others.contains(&path) {
        return Err(Error::usage("two files of this command are the same")
            .with_file(path)
            .with_hint("write to another file; inputs are never overwritten"));
    }
    let others: Vec<PathBuf> = others.iter().map(|other| other.to_path_buf()).collect();
    write::check_target(path, &others)
}

/// Writes `value` as JSON.
///
/// # Errors
/// Where the file cannot be written.
pub fn json<T: Serialize>(path: &Path, value: &T) -> Result<()> {
    write::whole(path, &json_bytes(path, value)?, &[])
}

/// `value` as the JSON that goes to `path`.
///
/// # Errors
/// Where it cannot be encoded.
pub fn json_bytes<T: Serialize>(path: &Path, value: &T) -> Result<Vec<u8>> {
    let mut text = serde_json::to_vec_pretty(value).map_err(|e| unwritable(path, &e))?;
    text.push(b'\n');
    Ok(text)
}

/// What `--report` writes: what all reports hold, and `more` members of one command's.
pub fn report(report: &Report, more: Value) -> Value {
    let mut all = json!(report);
    if let (Some(all), Value::Object(more)) = (all.as_object_mut(), more) {
        all.extend(more);
    }
    all
}

/// Writes encoded bytes.
///
/// # Errors
/// Where the file cannot be written.
pub fn bytes(path: &Path, bytes: &[u8]) -> Result<()> {
    write::whole(path, bytes, &[])
}

fn unwritable(path: &Path, error: &dyn std::fmt::Display) -> Error {
    Error::new(Kind::Output, "the output cannot be encoded").with_file(path).with_found(error)
}
