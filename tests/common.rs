//! What tests share.

use std::path::{Path, PathBuf};

/// The folder of meshes too large for this repository, beside the checkout: `None`, with the reason printed, where it
/// is missing, so that a test which needs it can be left out. With `CI=true` missing is a failure.
pub fn shared() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/assets");
    if folder.is_dir() {
        return Some(folder);
    }
    assert!(std::env::var("CI").as_deref() != Ok("true"), "{} is missing", folder.display());
    eprintln!("left out: {} is missing", folder.display());
    None
}

/// The binary under test.
pub fn furrier_path() -> &'static Path {
    assert_cmd::cargo::cargo_bin!("furrier")
}
