//! The extension `FURRIER_mesh_fur` (`docs/extension/`): a coat into a document, and back.

mod fallback;
mod flatten;
mod parts;
mod read;
mod textures;
mod write;

pub use fallback::Fallback;
pub use flatten::shells as flatten_shells;
pub use read::{coat_of, read_coat};
pub use write::{refuse_second, with_coat, write_coat};

pub use super::extension::NAME;
use crate::data::coat::{Coat, CoatPrimitive, Sampled};

/// Newest version of the extension; all up to it are read.
pub const VERSION: u64 = 2;

/// The oldest version of the extension that can hold `coat`: 2 where a tile was sampled on the skin, or a primitive of the
/// asset carries several.
pub fn version_of(coat: &Coat) -> u64 {
    let several = coat.primitives.windows(2).any(|two| owner(&two[0]) == owner(&two[1]));
    let blended = coat.primitives.iter().any(|primitive| primitive.blend.is_some());
    let on_skin = coat.tiles.iter().any(|tile| tile.sampled == Sampled::Skin);
    if several || blended || on_skin { 2 } else { 1 }
}

/// The primitive of the asset that a coat primitive lies on.
fn owner(primitive: &CoatPrimitive) -> (usize, usize) {
    (primitive.mesh, primitive.primitive)
}
