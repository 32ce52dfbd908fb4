//! Hears when files change on disk.

use crate::error::{Error, Kind, Result};
use notify::{Event, EventKind, RecommendedWatcher, RecursiveMode, Watcher};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Files that are watched, for as long as this lives.
pub struct Watch {
    files: BTreeSet<PathBuf>,
    _watcher: RecommendedWatcher,
}

impl Watch {
    /// Calls `changed` on a thread of its own whenever one of `files` may have been written. Their folders are watched: programs
    /// write a new file and rename it.
    ///
    /// # Errors
    /// Where the system cannot watch them.
    pub fn new(files: BTreeSet<PathBuf>, changed: impl Fn() + Send + 'static) -> Result<Self> {
        let fail = |error: notify::Error| {
            Error::new(Kind::Machine, "changes on disk are not heard of")
                .with_found(error)
                .with_hint("drop the file again once it has changed")
        };
        let names: BTreeSet<_> = files.iter().filter_map(|file| file.file_name().map(ToOwned::to_owned)).collect();
        let hear = move |event: notify::Result<Event>| {
            let meant = event.is_ok_and(|event| {
                let known = |path: &PathBuf| path.file_name().is_some_and(|name| names.contains(name));
                !matches!(event.kind, EventKind::Access(_)) && event.paths.iter().any(known)
            });
            if meant {
                changed();
            }
        };
        let mut watcher = notify::recommended_watcher(hear).map_err(fail)?;
        let folders: BTreeSet<PathBuf> = files.iter().filter_map(|file| folder(file)).collect();
        for folder in folders.iter().filter(|folder| folder.is_dir()) {
            watcher.watch(folder, RecursiveMode::NonRecursive).map_err(fail)?;
        }
        Ok(Self { files, _watcher: watcher })
    }

    /// Whether these are the files it watches.
    pub fn is_of(&self, files: &BTreeSet<PathBuf>) -> bool {
        self.files == *files
    }
}

/// The folder that a file is in.
fn folder(file: &Path) -> Option<PathBuf> {
    let folder = file.parent()?;
    Some(if folder.as_os_str().is_empty() { PathBuf::from(".") } else { folder.to_owned() })
}
