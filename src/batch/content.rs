//! Files by what they hold.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::fs::File;
use std::io;
use std::path::Path;

/// A BLAKE3 hash (O'Connor et al. 2020), in hexadecimal.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Digest(String);

impl Digest {
    /// Of bytes.
    pub fn of(bytes: &[u8]) -> Self {
        Self(blake3::hash(bytes).to_hex().to_string())
    }

    /// Of what a file holds.
    ///
    /// # Errors
    /// Where it cannot be read.
    pub fn of_file(path: &Path) -> io::Result<Self> {
        Self::of_files(&[path])
    }

    /// Of what several files hold together, in this order.
    ///
    /// # Errors
    /// Where one cannot be read.
    pub fn of_files(paths: &[&Path]) -> io::Result<Self> {
        let mut hasher = blake3::Hasher::new();
        for path in paths {
            let before = hasher.count();
            hasher.update_reader(File::open(path)?)?;
            if paths.len() > 1 {
                hasher.update(&(hasher.count() - before).to_le_bytes());
            }
        }
        Ok(Self(hasher.finalize().to_hex().to_string()))
    }

    /// Enough of it to name a file.
    pub fn short(&self) -> &str {
        self.0.get(..32).unwrap_or(&self.0)
    }
}

impl fmt::Display for Digest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}
