//! What several test modules share.

use std::path::PathBuf;

/// The folder of shared assets beside the checkout; `None` (with a word on stderr) where it is missing, as in a
/// stranger's clone.
///
/// # Panics
/// With `CI=true`, where it must be there.
pub fn shared() -> Option<PathBuf> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared");
    if path.is_dir() {
        return Some(path);
    }
    assert!(std::env::var("CI").as_deref() != Ok("true"), "{} is missing", path.display());
    eprintln!("left out: {} is missing", path.display());
    None
}
