//! The assets below a folder.

use crate::error::{Error, Result};
use std::path::{Path, PathBuf};
use walkdir::WalkDir;

/// Endings of what is baked.
const ENDINGS: [&str; 3] = ["glb", "gltf", "obj"];

/// Every asset below `root` by its path relative to it, sorted; hidden files and folders are passed over, and `aside`.
///
/// # Errors
/// Where a folder cannot be read.
pub fn assets(root: &Path, aside: &[PathBuf]) -> Result<Vec<PathBuf>> {
    let hidden = |name: &std::ffi::OsStr| name.to_string_lossy().starts_with('.');
    let wanted = |entry: &walkdir::DirEntry| {
        entry.depth() == 0 || !(hidden(entry.file_name()) || aside.iter().any(|folder| folder == entry.path()))
    };
    let mut found = Vec::new();
    for entry in WalkDir::new(root).sort_by_file_name().into_iter().filter_entry(wanted) {
        let entry = entry.map_err(|error| {
            Error::input("a folder of the library cannot be read")
                .with_file(error.path().unwrap_or(root))
                .with_found(&error)
        })?;
        let is_asset = entry.path().extension().and_then(|e| e.to_str()).map(str::to_lowercase);
        // A link to a file counts as the file; links to folders are not followed.
        if is_asset.is_some_and(|e| ENDINGS.contains(&e.as_str())) && entry.path().is_file() {
            found.push(entry.path().strip_prefix(root).unwrap_or(entry.path()).to_owned());
        }
    }
    Ok(found)
}
