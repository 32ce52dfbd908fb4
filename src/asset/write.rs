//! Outputs whole or not at all, and never over an input.

use crate::error::{Error, Kind, Result};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Writes `bytes` to `path` by way of a temporary file beside it, so that a reader sees the old file or the new one.
///
/// # Errors
/// When `path` is one of `inputs`, or cannot be written; what was there before is then still there.
pub fn whole(path: &Path, bytes: &[u8], inputs: &[PathBuf]) -> Result<()> {
    all(&[(path.to_owned(), bytes)], inputs)
}

/// Writes several files; all are complete on the disk before the first one takes its name. The last one given takes
/// its name last, so put the file that names the others there.
///
/// # Errors
/// As [`whole`].
pub fn all(files: &[(PathBuf, &[u8])], inputs: &[PathBuf]) -> Result<()> {
    let mut staged = Vec::new();
    for (path, bytes) in files {
        check_target(path, inputs)?;
        staged.push((stage(path, bytes).map_err(|error| fail(path, &error))?, path));
    }
    for (file, path) in staged {
        file.persist(path).map_err(|error| fail(path, &error.error))?;
    }
    Ok(())
}

/// Checks, before any work is done, that `path` can be an output: not an input, not a folder, in a folder that exists.
///
/// # Errors
/// Says which of these fails.
pub fn check_target(path: &Path, inputs: &[PathBuf]) -> Result<()> {
    let refuse = |what: &str, hint: &str| Err(Error::new(Kind::Output, what).with_file(path).with_hint(hint));
    if path.is_dir() {
        return refuse("the output is a folder", "give a file name inside it");
    }
    if !folder(path).is_dir() {
        return refuse("the output's folder does not exist", "create it first");
    }
    let real = path.canonicalize();
    let same = |input: &PathBuf| real.as_ref().is_ok_and(|real| input.canonicalize().is_ok_and(|input| input == *real));
    if inputs.iter().any(same) {
        return refuse("the output is one of the inputs", "write to another file; inputs are never overwritten");
    }
    Ok(())
}

fn folder(path: &Path) -> &Path {
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

fn stage(path: &Path, bytes: &[u8]) -> std::io::Result<tempfile::NamedTempFile> {
    let file = aside(path, bytes)?;
    file.as_file().sync_all()?;
    Ok(file)
}

/// How names of files that are being written begin and end.
pub const ASIDE: [&str; 2] = [".furrier-", ".part"];

/// A temporary file beside `path` with these bytes, to be renamed; the system may not have them on the disk yet.
///
/// # Errors
/// Where it cannot be written; nothing is then left behind.
pub fn aside(path: &Path, bytes: &[u8]) -> std::io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(ASIDE[0]).suffix(ASIDE[1]);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // As any new file: the umask takes its share.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut file = builder.tempfile_in(folder(path))?;
    file.write_all(bytes)?;
    Ok(file)
}

fn fail(path: &Path, error: &std::io::Error) -> Error {
    Error::new(Kind::Output, format!("the output cannot be written: {error}"))
        .with_file(path)
        .with_hint("check free space and permissions; what was there before is unchanged")
}
