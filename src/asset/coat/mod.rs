//! The extension `FURRIER_mesh_fur` (`docs/extension/`): a coat into a document, and back.

mod fallback;
mod flatten;
mod parts;
mod pool;
mod read;
mod textures;
mod write;

pub use fallback::Fallback;
pub use flatten::shells as flatten_shells;
pub use read::{coat_of, read_coat};
pub use textures::Packed;
pub use write::{refuse_second, with_coat, write_coat, write_packed};

pub use super::extension::NAME;

/// Newest version of the extension, which is written; all up to it are read.
pub const VERSION: u64 = 3;
