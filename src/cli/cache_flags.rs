//! The flags of commands that keep finished stages in a cache.

use crate::cache::{Store, default_folder};
use clap::Args;
use std::path::PathBuf;

/// Where finished stages are kept.
#[derive(Clone, Debug, Default, Args)]
pub(super) struct CacheFlags {
    /// Folder that keeps finished stages for later runs; other runs and machines may use it meanwhile. Default: what the
    /// environment variable FURRIER_CACHE names (empty for none), else furrier in the system's folder for caches
    #[arg(long, value_name = "DIR")]
    cache: Option<PathBuf>,
    /// Do all of the work, and keep nothing of it
    #[arg(long, conflicts_with = "cache")]
    no_cache: bool,
}

impl CacheFlags {
    /// The store that the flags, the environment or the system name; none where one of them says so.
    pub(super) fn store(&self) -> Option<Store> {
        match (&self.cache, self.no_cache) {
            (_, true) => None,
            (Some(folder), _) => Some(Store::new(folder)),
            (None, false) => default_folder().map(Store::new),
        }
    }
}
