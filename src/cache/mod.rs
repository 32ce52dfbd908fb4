//! Floor 3: values that are kept from one run to the next, and shared between machines, each under the hash of all that made
//! it (`docs/steps/cache.md`).
//!
//! A value goes in under a [`Key`] and comes out as the same bytes, or not at all: it is written aside and renamed, and its
//! hash is checked when it is read. So many programs may use one folder without locks: where two write the same value, the
//! last rename wins, and both wrote the same.

mod entry;
mod key;
mod place;
mod survey;

pub use key::Key;
pub use place::{VARIABLE, default_folder};
pub use survey::{Limits, OfStage, Removed, Survey, Verified};

use crate::asset::write;
use std::fs::File;
use std::io::{ErrorKind, Read, Result};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

/// A value's file is marked as used when it was last so longer ago than this: a mark is a write, on a network too.
const MARKED_AFTER: Duration = Duration::from_secs(3600);

/// A folder of values. Nothing is made there before there is something to keep.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Store {
    folder: PathBuf,
}

/// What there is under a key.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Found {
    /// The bytes that were put there.
    Value(Vec<u8>),
    /// Nothing.
    Absent,
    /// Something else than what was put there, and what is wrong with it.
    Damaged(String),
}

impl Store {
    /// The store in `folder`.
    pub fn new(folder: impl Into<PathBuf>) -> Self {
        Self { folder: folder.into() }
    }

    /// Where it is.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// What is kept under `key`.
    pub fn get(&self, key: &Key) -> Found {
        match read(&self.path(key)) {
            Ok((file, bytes)) => match entry::value(&bytes, key.hash()) {
                Ok(value) => {
                    mark_used(&file);
                    Found::Value(value)
                }
                Err(fault) => Found::Damaged(fault),
            },
            Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => Found::Absent,
            Err(error) => Found::Damaged(error.to_string()),
        }
    }

    /// Keeps `value` under `key`.
    ///
    /// # Errors
    /// Where it cannot be written; what was there before is then still there.
    pub fn put(&self, key: &Key, value: &[u8]) -> Result<()> {
        let path = self.path(key);
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder)?;
        }
        // Not forced onto the disk: a value that a power cut tore is told by its hash.
        write::aside(&path, &entry::bytes(value, key.hash())?)?.persist(path)?;
        Ok(())
    }

    /// The file of a key's value.
    pub fn path(&self, key: &Key) -> PathBuf {
        let name = key.name();
        let (first, rest) = name.split_at(2);
        self.folder.join(key.stage()).join(first).join(rest)
    }
}

fn read(path: &Path) -> Result<(File, Vec<u8>)> {
    let mut file = File::open(path)?;
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes)?;
    Ok((file, bytes))
}

/// Its time of change says when a value was last used: times of access are not kept on many systems.
fn mark_used(file: &File) {
    let now = SystemTime::now();
    let used = file.metadata().and_then(|about| about.modified());
    if used.is_ok_and(|used| now.duration_since(used).is_ok_and(|ago| ago > MARKED_AFTER)) {
        // Another's file or a cache that is not to be written: the value then only looks older than it is.
        let _ = file.set_modified(now);
    }
}
