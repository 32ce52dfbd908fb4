//! What a value was made from, as a hash.

use crate::error::{Error, Kind, Result};
use serde::Serialize;

/// Version of the layout of files, and of how values are written as bytes.
pub const FORMAT: u32 = 1;

/// A hash of the code that bakes (`build.rs`).
pub const EPOCH: &str = env!("FURRIER_EPOCH");

/// The name of a value: the stage that made it, and a hash of all that it was made from, the program's own code included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Key {
    stage: &'static str,
    hash: [u8; 32],
}

impl Key {
    /// Of a value that `stage` makes from `made_from` and nothing else. The stage's name is a folder's: small letters.
    ///
    /// # Errors
    /// Where `made_from` has no form in bytes.
    pub fn new(stage: &'static str, made_from: &impl Serialize) -> Result<Self> {
        let bytes = postcard::to_stdvec(&(FORMAT, EPOCH, stage, made_from)).map_err(|error| {
            Error::new(Kind::Output, "what a stage is made from has no form in bytes")
                .with_field(stage)
                .with_found(error)
        })?;
        Ok(Self { stage, hash: *blake3::hash(&bytes).as_bytes() })
    }

    /// The stage.
    pub fn stage(&self) -> &'static str {
        self.stage
    }

    /// The hash.
    pub fn hash(&self) -> &[u8; 32] {
        &self.hash
    }

    /// The hash in hexadecimal.
    pub fn name(&self) -> String {
        blake3::Hash::from_bytes(self.hash).to_hex().to_string()
    }
}

/// Keys stand for what they were made from in keys of later stages.
impl Serialize for Key {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        (self.stage, self.hash).serialize(serializer)
    }
}
