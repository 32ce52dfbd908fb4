//! A coat to look at, whether or not the input wears one already.

use super::recipe::Recipe;
use super::{Baked, coat, coat_of};
use crate::asset::{Asset, Reading};
use crate::cache::Store;
use crate::data::coat::Coat;
use crate::error::Result;
use std::path::Path;

/// An asset and the coat that `recipe` gives it. One that it wears already is taken off first; `bare` is the asset where it was read before,
/// and so taken off. `tell` hears the name of each step.
///
/// # Errors
/// As [`coat`].
pub fn seen(
    recipe: &Recipe,
    (input, bare): (&str, Option<&Asset>),
    reading: &Reading,
    cache: Option<Store>,
    tell: &mut dyn FnMut(&'static str),
) -> Result<(Asset, Coat, Baked)> {
    // Nothing is written, so there is nowhere to write to.
    let mut request = recipe.request(input, Path::new(""), false);
    (request.reading, request.cache) = (Reading { rebake: true, ..*reading }, cache);
    let (asset, mut baked) = match bare {
        Some(asset) => coat_of(asset.clone(), &request, tell)?,
        None => coat(&request, tell)?,
    };
    Ok((asset, std::mem::take(&mut baked.coat), baked))
}
