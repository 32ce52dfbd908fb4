//! Which kind of picture a file name asks for.

use super::tone::{Development, develop};
use super::{exr, png};
use crate::data::film::Film;
use crate::error::{Error, Result};
use std::path::Path;

/// Kinds of picture files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Eight bits, developed.
    Png,
    /// The film as it is: linear, premultiplied, with its layers.
    Exr,
}

impl Format {
    /// By the name's ending; `field` is the flag that gave it.
    ///
    /// # Errors
    /// [`crate::error::Kind::Usage`] for another ending than .png and .exr.
    pub fn of(path: &Path, field: &str) -> Result<Self> {
        match path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase().as_str() {
            "png" => Ok(Self::Png),
            "exr" => Ok(Self::Exr),
            _ => Err(Error::usage("the picture's kind is unknown")
                .with_field(field)
                .with_found(path.display())
                .with_expected("a name that ends in .png or .exr")),
        }
    }

    /// The film as a file of this kind. `development` is for pictures of eight bits.
    ///
    /// # Errors
    /// Where the film is too large for the format.
    pub fn encode(self, film: &Film, development: &Development) -> Result<Vec<u8>> {
        match self {
            Self::Png => png::encode(&develop(film, development)),
            Self::Exr => exr::encode(film),
        }
    }
}
