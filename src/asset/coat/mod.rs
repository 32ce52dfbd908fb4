//! The extension `FURRIER_mesh_fur` (`docs/extension/`): a coat into a document, and back.

mod fallback;
mod flatten;
mod parts;
mod place;
mod pool;
mod read;
mod textures;
mod vrm;
mod write;

pub use fallback::Fallback;
pub use flatten::shells as flatten_shells;
pub use read::{coat_of, read_coat};
pub use write::{check_output, refuse_second, with_coat, write_coat};

pub use super::extension::NAME;

/// Newest version of the extension, which is written; all up to it are read.
pub const VERSION: u64 = 3;
