//! What decides a picture, as a name for its file.

use crate::asset;
use crate::error::{Error, Result};
use crate::preset::Preset;
use std::fmt;
use std::path::Path;

/// Offset and prime of FNV-1a in 128 bits (Fowler, Noll and Vo).
const OFFSET: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
const PRIME: u128 = 0x0000_0000_0100_0000_0000_0000_0000_013b;

/// A hash of what was folded into it, in its order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Key(u128);

impl Default for Key {
    fn default() -> Self {
        Self(OFFSET)
    }
}

impl Key {
    /// With bytes, and how many they are.
    pub fn bytes(self, bytes: &[u8]) -> Self {
        let fold = |hash: u128, byte: &u8| (hash ^ u128::from(*byte)).wrapping_mul(PRIME);
        Self(bytes.iter().chain(&(bytes.len() as u64).to_le_bytes()).fold(self.0, fold))
    }

    /// With what a value says of itself.
    pub fn with(self, value: impl fmt::Debug) -> Self {
        self.bytes(format!("{value:?}").as_bytes())
    }

    /// With all that an asset was read from.
    ///
    /// # Errors
    /// As [`asset::load`].
    pub fn asset(self, input: &str) -> Result<Self> {
        let asset = asset::load(input)?;
        let mut key = if asset.document.files.is_empty() { self.with(input) } else { self };
        for file in &asset.document.files {
            key = key.file(file);
        }
        for image in 0..asset.document.count("images") {
            key = key.with(asset.document.image_bytes(image)?);
        }
        Ok(key)
    }

    /// With a preset, and what the files hold that it names.
    ///
    /// # Errors
    /// Where a region's preset cannot be read.
    pub fn preset(self, preset: &Preset) -> Result<Self> {
        let maps = &preset.maps;
        let maps = [&maps.density, &maps.length, &maps.comb, &maps.colour, &maps.clump];
        let mut key = self.with(preset);
        for map in maps.into_iter().chain(preset.regions.iter().map(|region| &region.map)).flatten() {
            key = key.file(map);
        }
        for region in &preset.regions {
            key = key.with(Preset::load(&region.preset)?);
        }
        Ok(key)
    }

    /// With the running program: what it was built from decides what it draws.
    ///
    /// # Errors
    /// Where its file cannot be found.
    pub fn program(self) -> Result<Self> {
        let unknown = |error| Error::input("the program's own file cannot be read").with_found(error);
        std::env::current_exe().and_then(std::fs::read).map(|bytes| self.bytes(&bytes)).map_err(unknown)
    }

    /// With what a file holds; one that is not there is told apart by whoever needs it.
    fn file(self, path: &Path) -> Self {
        self.bytes(&std::fs::read(path).unwrap_or_default())
    }
}

impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:032x}", self.0)
    }
}
