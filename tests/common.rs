//! What several test files share.

use std::path::PathBuf;

/// The folder of shared assets beside this checkout; none, with the reason printed, where it is missing.
///
/// # Panics
/// When it is missing and `CI=true`.
pub fn shared() -> Option<PathBuf> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared");
    if folder.is_dir() {
        return Some(folder);
    }
    assert!(std::env::var("CI").as_deref() != Ok("true"), "CI needs {}", folder.display());
    println!("left out: {} is missing", folder.display());
    None
}
