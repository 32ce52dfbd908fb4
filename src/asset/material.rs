//! The base colour of a part: what hair takes its colour from where a preset does not say otherwise.

use super::document::Document;
use super::image::Found;
use super::json::At;
use super::repair::Notes;
use crate::data::texture::{Texture, Wrap};
use crate::error::Result;
use crate::math::{Vec2, Vec4};

/// Base colour of a material.
#[derive(Clone, Debug, PartialEq)]
pub struct BaseColour {
    /// Factor, linear RGBA.
    pub factor: Vec4,
    /// Texture, where it has one that can be decoded.
    pub texture: Option<Texture>,
}

impl Default for BaseColour {
    /// White, as the format has it.
    fn default() -> Self {
        Self { factor: Vec4::ONE, texture: None }
    }
}

impl BaseColour {
    /// The base colour of material `index`; what is missing or cannot be decoded is left out and said.
    ///
    /// # Errors
    /// Names images whose header claims too many pixels, or that lie outside the input's folder.
    pub fn of(document: &Document, index: usize, notes: &mut Notes) -> Result<Self> {
        let material = document.root().entry("materials", index)?;
        let Some(pbr) = material.get("pbrMetallicRoughness") else { return Ok(Self::default()) };
        let factor = pbr.get("baseColorFactor").map_or(Ok([1.0; 4]), |at| at.numbers::<4>())?;
        let factor = Vec4::from_array(factor.map(|f| f as f32));
        let mut texture = pbr.get("baseColorTexture").map(|slot| texture_of(document, &slot)).transpose()?.flatten();
        if let Some(image) = texture.as_ref().map(|t| t.image) {
            let uri = document.root().entry("images", image)?.get("uri").and_then(|u| u.value.as_str());
            let name = uri.filter(|u| !u.starts_with("data:")).map_or(String::new(), |u| format!(" ({u})"));
            let fault = match document.find_image(image)? {
                Found::Usable { .. } => None,
                Found::Missing => Some("is not there"),
                Found::Foreign => Some("is neither PNG, JPEG nor WebP"),
            };
            if let Some(fault) = fault {
                notes.warn(format!("images[{image}]{name} {fault}; the base colour factor is used alone"));
                texture = None;
            }
        }
        Ok(Self { factor, texture })
    }
}

/// The texture that a slot names; none where it shows no image.
///
/// # Errors
/// Names what it points to that is not there.
pub fn texture_of(document: &Document, slot: &At<'_>) -> Result<Option<Texture>> {
    let root = document.root();
    let texture = root.entry("textures", slot.need("index")?.size()?)?;
    let webp = texture.get("extensions").and_then(|e| e.get("EXT_texture_webp")?.get("source"));
    let Some(source) = webp.or_else(|| texture.get("source")) else { return Ok(None) };
    let image = source.index_into("images", document.count("images"))?;
    let index = slot.need("index")?.size()?;
    let mut found = Texture::plain(index, image, slot.size_or("texCoord", 0)?);
    if let Some(transform) = slot.get("extensions").and_then(|e| e.get("KHR_texture_transform")) {
        let pair = |key: &str, default: Vec2| {
            transform.get(key).map_or(Ok(default), |at| at.numbers::<2>().map(|n| Vec2::new(n[0] as f32, n[1] as f32)))
        };
        found.offset = pair("offset", Vec2::ZERO)?;
        found.scale = pair("scale", Vec2::ONE)?;
        found.rotation_rad = transform.get("rotation").map_or(Ok(0.0), |at| at.number())? as f32;
        found.uv_set = transform.size_or("texCoord", found.uv_set)?;
    }
    if let Some(sampler) = texture.get("sampler") {
        let sampler = root.entry("samplers", sampler.size()?)?;
        for (wrap, key) in found.wrap.iter_mut().zip(["wrapS", "wrapT"]) {
            *wrap = match sampler.size_or(key, 10497)? {
                33071 => Wrap::Clamp,
                33648 => Wrap::Mirror,
                _ => Wrap::Repeat,
            };
        }
    }
    Ok(Some(found))
}
