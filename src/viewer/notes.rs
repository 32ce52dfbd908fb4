//! What a user should know of a picture.

use crate::data::coat::Coat;
use crate::runtime::gpu::KeyShadow;

/// Says where there is no such level.
pub fn coarsest(coat: &Coat, level: Option<usize>) -> Option<String> {
    let coarsest = coat.tiles.iter().map(|tile| tile.levels.len()).min()?;
    let level = level.filter(|&level| level > coarsest)?;
    Some(format!("a tile of this coat has no level {level}: its coarsest, {coarsest}, is drawn"))
}

/// What a user should know of the shadow.
pub fn shadow(shadow: KeyShadow) -> Option<String> {
    let text = match shadow {
        KeyShadow::Off | KeyShadow::Cast { guests_reach: true } => return None,
        KeyShadow::Cast { guests_reach: false } => {
            "the occluder casts no shadow on the asset: seen from the key light it lies beside it, behind it or out of reach"
        }
        KeyShadow::TooNear => {
            "the key light stands within the asset or close beside it: no limb casts its shadow on another"
        }
    };
    Some(text.to_owned())
}
