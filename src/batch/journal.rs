//! What is under way: a file of lines that a run keeps while it goes on and removes at its end. One that is found tells of a run that
//! was killed, or of another that goes on.

use crate::error::{Error, Kind, Result};
use serde::{Deserialize, Serialize};
use std::fs::{File, OpenOptions, TryLockError};
use std::io::Write;
use std::path::{Path, PathBuf};

/// A line.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Line {
    Begin(PathBuf),
    End(PathBuf),
}

/// The journal of a run that goes on.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    /// Locked for as long as the run goes on; the system unlocks it when the process ends, however it ends.
    file: File,
}

/// What was found of other runs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Found {
    /// Outputs that were under way in runs that were killed.
    pub unfinished: Vec<PathBuf>,
    /// Outputs that are under way in runs that go on.
    pub elsewhere: Vec<PathBuf>,
    /// Runs that go on.
    pub others: usize,
}

impl Journal {
    /// Begins a journal in the folder `state`, and tells what is found there of other runs. What killed runs left half written is
    /// cleared away.
    ///
    /// # Errors
    /// Where the journal cannot be written.
    pub fn open(state: &Path) -> Result<(Self, Found)> {
        super::record::create(state)?;
        let found = look(state);
        let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap_or_default();
        let name = format!("{}-{}.jsonl", std::process::id(), now.as_nanos());
        let (new, path) = (state.join(format!("new-{name}")), state.join(format!("journal-{name}")));
        let fail = |error: std::io::Error| {
            Error::new(Kind::Output, format!("the journal cannot be written: {error}")).with_file(&path)
        };
        let file = OpenOptions::new().create_new(true).append(true).open(&new).map_err(fail)?;
        // Where a file system has no locks, a run that goes on is taken for one that was killed: its outputs are baked twice.
        let _ = file.try_lock();
        // Nobody sees it before it is locked.
        std::fs::rename(&new, &path).map_err(fail)?;
        Ok((Self { path, file }, found))
    }

    /// An output is begun.
    ///
    /// # Errors
    /// Where the journal cannot be written.
    pub fn begin(&mut self, output: &Path) -> Result<()> {
        self.line(&Line::Begin(output.to_owned()))
    }

    /// An output is whole, or given up.
    ///
    /// # Errors
    /// Where the journal cannot be written.
    pub fn end(&mut self, output: &Path) -> Result<()> {
        self.line(&Line::End(output.to_owned()))
    }

    fn line(&mut self, line: &Line) -> Result<()> {
        let fail =
            |error: &dyn std::fmt::Display| Error::new(Kind::Output, format!("the journal cannot be written: {error}"));
        let mut text = serde_json::to_vec(line).map_err(|error| fail(&error).with_file(&self.path))?;
        text.push(b'\n');
        self.file.write_all(&text).map_err(|error| fail(&error).with_file(&self.path))
    }
}

impl Drop for Journal {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.path);
    }
}

/// Reads all journals in a folder. Where no other run goes on, those of killed runs are removed with what these had half written.
fn look(state: &Path) -> Found {
    let (mut found, mut dead) = (Found::default(), Vec::new());
    for path in files(state, "journal-", ".jsonl") {
        let Ok(file) = File::open(&path) else { continue };
        let open = unfinished(&std::fs::read_to_string(&path).unwrap_or_default());
        if let Err(TryLockError::WouldBlock) = file.try_lock() {
            found.others += 1;
            found.elsewhere.extend(open);
        } else {
            found.unfinished.extend(open);
            dead.push(path);
        }
    }
    if found.others == 0 {
        let outputs = found.unfinished.iter().map(|output| output.parent().unwrap_or(Path::new("")).to_owned());
        let records = ["records", "recipes"].map(|name| state.join(name));
        // What outputs are written to before they take their names.
        let halves = outputs.chain(records).flat_map(|folder| files(&folder, ".furrier-", ".part"));
        for path in halves.chain(files(state, "new-", ".jsonl")).chain(dead) {
            let _ = std::fs::remove_file(path);
        }
    }
    found
}

/// The files of a folder whose names begin and end so.
fn files(folder: &Path, begin: &str, end: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let named = |name: &str| name.starts_with(begin) && name.ends_with(end);
    entries.filter(|entry| entry.file_name().to_str().is_some_and(named)).map(|entry| entry.path()).collect()
}

/// Outputs begun and not ended. A line that was cut when the run was killed says nothing.
fn unfinished(text: &str) -> Vec<PathBuf> {
    let mut open = Vec::new();
    for line in text.lines().filter_map(|line| serde_json::from_str(line).ok()) {
        match line {
            Line::Begin(output) => open.push(output),
            Line::End(output) => open.retain(|other| *other != output),
        }
    }
    open
}
