//! Whether an output is up to date, and if not, why.

use super::key::{Key, differences};
use super::record::{Program, Record, Records, digest_of};
use crate::error::Result;
use serde::{Serialize, Serializer};
use serde_json::Value;
use std::fmt;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// How an output stands to what it is made from.
#[derive(Clone, Debug, PartialEq)]
pub enum Standing {
    /// Nothing to do.
    UpToDate(Box<Record>),
    /// It is to be baked, for these reasons.
    Due(Vec<Why>),
}

/// Why an output is to be baked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Why {
    /// There is neither output nor record.
    New,
    /// There is an output, but nothing is known of it.
    NoRecord,
    /// What is known of it cannot be read: the reason.
    BrokenRecord(String),
    /// The output is not there.
    OutputMissing,
    /// The output is not what was written.
    OutputAltered,
    /// Other bytes in the input.
    Input,
    /// Other bytes in a file that the input names.
    Reference(PathBuf),
    /// A file that the input names was there then or is there now, not both.
    ReferenceCameOrWent(PathBuf),
    /// Other bytes in a map of a preset, by its key.
    Map(String),
    /// Another value in the recipe: its key, old and new.
    Value(String, String, String),
    /// Another recipe, of which the old one is not known.
    Recipe,
    /// Another program wrote it: then and now.
    Version(Program),
}

impl fmt::Display for Why {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::New => write!(f, "never baked"),
            Self::NoRecord => write!(f, "nothing is known of the output that is there"),
            Self::BrokenRecord(reason) => write!(f, "what is known of the output cannot be read: {reason}"),
            Self::OutputMissing => write!(f, "output missing"),
            Self::OutputAltered => write!(f, "output altered"),
            Self::Input => write!(f, "input changed"),
            Self::Reference(name) => write!(f, "{} changed", name.display()),
            Self::ReferenceCameOrWent(name) => write!(f, "{} came or went", name.display()),
            Self::Map(key) => write!(f, "map changed: {key}"),
            Self::Value(key, old, new) => match key.split_once('.') {
                Some(("preset", key)) => write!(f, "preset's {key}: {old} → {new}"),
                Some(("presets", key)) => write!(f, "a material's preset, {key}: {old} → {new}"),
                _ => write!(f, "{key}: {old} → {new}"),
            },
            Self::Recipe => write!(f, "recipe changed"),
            Self::Version(then) => {
                let Program { format, epoch } = Program::CURRENT;
                let (old_format, old_epoch) = (then.format, then.epoch);
                write!(f, "version: format {old_format}, epoch {old_epoch} → format {format}, epoch {epoch}")
            }
        }
    }
}

impl Serialize for Why {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// Compares an output and all that it is made from with what is known of it.
///
/// # Errors
/// Where the input cannot be read.
pub fn standing(records: &Records, input: &Path, output: &Path, key: &Key) -> Result<Standing> {
    let record = match records.get(output) {
        Some(Ok(record)) => record,
        Some(Err(reason)) => return Ok(Standing::Due(vec![Why::BrokenRecord(reason)])),
        None => return Ok(Standing::Due(vec![if output.exists() { Why::NoRecord } else { Why::New }])),
    };
    let mut reasons = Vec::new();
    let now = record.sources.again(input)?;
    if now.input != record.sources.input {
        reasons.push(Why::Input);
    }
    for ((name, then), (_, now)) in record.sources.references.iter().zip(&now.references) {
        match (then, now) {
            (Some(then), Some(now)) if then != now => reasons.push(Why::Reference(name.clone())),
            (Some(_), None) | (None, Some(_)) => reasons.push(Why::ReferenceCameOrWent(name.clone())),
            _ => {}
        }
    }
    if record.recipe != key.digest {
        reasons.extend(of_recipe(records.recipe(&record.recipe).as_ref(), &key.value));
    }
    if record.program != Program::CURRENT {
        reasons.push(Why::Version(record.program));
    }
    match digest_of(output) {
        Ok((digest, _)) if digest == record.output => {}
        Err(error) if error.kind() == ErrorKind::NotFound => reasons.push(Why::OutputMissing),
        _ => reasons.push(Why::OutputAltered),
    }
    Ok(if reasons.is_empty() { Standing::UpToDate(Box::new(record)) } else { Standing::Due(reasons) })
}

/// Keys whose values are hashes of maps.
fn is_map(key: &str) -> bool {
    let parts: Vec<&str> = key.split('.').collect();
    matches!(parts[..], [.., "maps", _]) || matches!(parts[..], [.., "regions", _, "map"])
}

fn of_recipe(old: Option<&Value>, new: &Value) -> Vec<Why> {
    let differences = old.map(|old| differences(old, new)).unwrap_or_default();
    if differences.is_empty() {
        return vec![Why::Recipe];
    }
    let of = |(key, old, new): (String, Option<&Value>, Option<&Value>)| {
        if is_map(&key) { Why::Map(key) } else { Why::Value(key, shown(old), shown(new)) }
    };
    differences.into_iter().map(of).collect()
}

/// A value in a few characters; numbers as the 32-bit floats they are.
fn shown(value: Option<&Value>) -> String {
    let text = match value {
        None => "none".to_owned(),
        Some(Value::Number(n)) if n.is_f64() => n.as_f64().map_or_else(String::new, |n| (n as f32).to_string()),
        Some(value) => value.to_string(),
    };
    if text.chars().count() <= 40 { text } else { text.chars().take(37).chain("...".chars()).collect() }
}
