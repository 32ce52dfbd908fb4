//! Where a cache lies when nobody says.

use etcetera::BaseStrategy;
use std::path::PathBuf;

/// The environment variable that names the folder; empty for no cache.
pub const VARIABLE: &str = "FURRIER_CACHE";

/// The folder that [`VARIABLE`] names, or `furrier` in the system's folder for caches: `XDG_CACHE_HOME` or `~/.cache`,
/// `~/Library/Caches` on macOS, `%LOCALAPPDATA%` on Windows. None where the variable is empty or there is no such folder.
pub fn default_folder() -> Option<PathBuf> {
    match std::env::var_os(VARIABLE) {
        Some(folder) => (!folder.is_empty()).then(|| folder.into()),
        None => Some(etcetera::base_strategy::choose_native_strategy().ok()?.cache_dir().join("furrier")),
    }
}
