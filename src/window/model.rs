//! What is looked at: an asset with its coat, made once and shared by all threads.

use crate::asset::Asset;
use crate::data::coat::Coat;
use crate::data::subject::Subject;
use crate::error::Result;
use crate::viewer::stage::{self, Textures};
use crate::viewer::subject::subject;
use std::sync::Arc;

/// An asset, what it wears, and what pictures of it need.
pub struct Model {
    /// Skin, skeleton, animations.
    pub asset: Arc<Asset>,
    /// What it wears; without primitives while it has none yet.
    pub coat: Coat,
    /// As camera and lights know it.
    pub subject: Subject,
    /// Decoded.
    pub textures: Textures,
    /// Its animations.
    pub animations: Vec<Animation>,
}

/// An animation of the asset.
#[derive(Clone, Debug, PartialEq)]
pub struct Animation {
    /// As the asset calls it.
    pub name: String,
    /// Time of its last key, s.
    pub seconds: f64,
}

impl Model {
    /// Makes ready what does not change from picture to picture.
    ///
    /// # Errors
    /// For textures that cannot be decoded, animations whose keys cannot be read, and as [`subject`].
    pub fn new(asset: Asset, coat: Coat) -> Result<Self> {
        let textures = stage::textures(&asset, &coat)?;
        let names = asset.animation_names().into_iter().enumerate();
        let animation = |(index, name)| Ok(Animation { name, seconds: asset.animation_seconds(index)? });
        let animations = names.map(animation).collect::<Result<_>>()?;
        Ok(Self { subject: subject(&asset, &coat)?, asset: Arc::new(asset), coat, textures, animations })
    }

    /// Whether it wears anything.
    pub fn furred(&self) -> bool {
        !self.coat.primitives.is_empty()
    }
}
