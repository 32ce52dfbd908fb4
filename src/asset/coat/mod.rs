//! The extension `FURRIER_mesh_fur` (`docs/extension/`): a coat into a document, and back.

mod expressions;
mod fallback;
mod flatten;
mod input;
mod parts;
mod place;
mod pool;
mod ranges;
mod read;
mod references;
mod shells;
mod strip;
mod textures;
mod vrm;
mod worn;
mod write;

pub use fallback::Fallback;
pub use flatten::shells as flatten_shells;
pub use input::Input;
pub use read::{coat_of, read_coat, read_coat_as};
pub use strip::{Stripped, bared, strip};
pub use textures::Packed;
pub use worn::{Worn, refuse_second};
pub use write::{check_output, with_coat, write_coat, write_packed, write_stripped};

pub use super::extension::NAME;

/// Newest version of the extension, which is written; all up to it are read.
pub const VERSION: u64 = 3;
