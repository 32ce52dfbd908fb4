//! What a part's material says of it: the base colour, which hair takes where a preset does not say otherwise, and how it is shown.

use super::document::Document;
use super::image::Found;
use super::json::At;
use super::repair::Notes;
use super::vrm;
use crate::data::texture::{Texture, Wrap};
use crate::error::{Error, Result};
use crate::math::{Vec2, Vec3, Vec4};
use serde_json::json;

/// The older way to state a colour, which still stands in many files.
const GLOSSINESS: &str = "KHR_materials_pbrSpecularGlossiness";

/// What is read of a material.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Its name; `material_3` for nameless ones, `default` where there is none.
    pub name: String,
    /// What hair takes its colour from by default.
    pub base_colour: BaseColour,
    /// Whether it shows both sides.
    pub double_sided: bool,
    /// Whether it lets through what is behind it.
    pub alpha: Alpha,
    /// Whether light does not change it (KHR_materials_unlit).
    pub unlit: bool,
}

/// How a material uses the alpha of its colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Alpha {
    /// Not at all.
    Opaque,
    /// To cut out.
    Mask,
    /// To let shine through.
    Blend,
}

/// Base colour of a material.
#[derive(Clone, Debug, PartialEq)]
pub struct BaseColour {
    /// Factor, linear RGBA.
    pub factor: Vec4,
    /// Texture, where it has one that can be decoded.
    pub texture: Option<Texture>,
    /// Why its texture is broken, which is no matter but where fur is to have its colour.
    pub fault: Option<Box<Error>>,
}

impl Default for BaseColour {
    /// White, as the format has it.
    fn default() -> Self {
        Self { factor: Vec4::ONE, texture: None, fault: None }
    }
}

impl Material {
    /// Material `index` of the document, or what stands for none.
    ///
    /// # Errors
    /// As [`BaseColour::of`].
    pub fn of(document: &Document, index: Option<usize>, notes: &mut Notes) -> Result<Self> {
        let mut material = Self {
            name: "default".into(),
            base_colour: BaseColour::default(),
            double_sided: false,
            alpha: Alpha::Opaque,
            unlit: false,
        };
        let Some(index) = index else { return Ok(material) };
        let at = document.root().entry("materials", index)?;
        let name = at.get("name").and_then(|name| name.value.as_str()).filter(|name| !name.is_empty());
        material.name = name.map_or_else(|| format!("material_{index}"), str::to_owned);
        material.double_sided = at.get("doubleSided").is_some_and(|sided| sided.value.as_bool() == Some(true));
        material.alpha = match at.get("alphaMode").and_then(|mode| mode.value.as_str()) {
            Some("MASK") => Alpha::Mask,
            Some("BLEND") => Alpha::Blend,
            _ => Alpha::Opaque,
        };
        material.unlit = extension(&at, "KHR_materials_unlit").is_some();
        material.base_colour = BaseColour::of(document, (index, &at), &material.name, notes)?;
        Ok(material)
    }
}

fn extension<'a>(owner: &At<'a>, name: &str) -> Option<At<'a>> {
    owner.get("extensions").and_then(|extensions| extensions.get(name))
}

impl BaseColour {
    /// The base colour of a material; what of it is missing or cannot be decoded is left out and said.
    ///
    /// # Errors
    /// Names what is no number or points at nothing.
    fn of(document: &Document, (index, material): (usize, &At<'_>), name: &str, notes: &mut Notes) -> Result<Self> {
        let glossiness = extension(material, GLOSSINESS);
        let metallic = material.get("pbrMetallicRoughness");
        let (owner, keys) = match &glossiness {
            Some(glossiness) => (Some(glossiness), ["diffuseFactor", "diffuseTexture"]),
            None => (metallic.as_ref(), ["baseColorFactor", "baseColorTexture"]),
        };
        let [factor, mut slot] = keys.map(|key| owner.and_then(|owner| owner.get(key)));
        let factor = factor.map_or(Ok([1.0; 4]), |at| at.numbers::<4>())?;
        let mut factor = Vec4::from_array(factor.map(|f| f as f32));
        // In an avatar's own list of materials.
        let avatar = vrm::colour(document, index);
        factor = avatar.factor.unwrap_or(factor);
        let texture = avatar.texture.map(|index| json!({"index": index}));
        slot = texture.as_ref().map(At::root).or(slot);
        if owner.is_none() {
            unread(material, name, notes);
        }
        // Where all colour glows, as flat pictures of older programs do, hair has that.
        let glow = material.get("emissiveFactor").map_or(Ok([0.0; 3]), |at| at.numbers::<3>())?;
        let glow = Vec3::from(glow.map(|f| f as f32));
        let lamp = material.get("emissiveTexture").filter(|_| glow != Vec3::ZERO);
        if glow != Vec3::ZERO && factor.truncate() == Vec3::ZERO {
            notes.warn(format!(
                "material {name:?}: its base colour is black and it glows; hair takes its emissive colour"
            ));
            (factor, slot) = (glow.extend(factor.w), lamp);
        } else if slot.is_none() && lamp.is_some() {
            notes.warn(format!(
                "material {name:?}: its emissive texture is not read, its base colour factor is used alone"
            ));
        }
        let plain = Self { factor, texture: None, fault: None };
        let Some(slot) = slot else { return Ok(plain) };
        let Some(texture) = texture_of(document, &slot)? else {
            let fault = unknown_source(document, &slot)?;
            notes.warn(format!("material {name:?}: its texture {fault}; the base colour factor is used alone"));
            return Ok(plain);
        };
        let image = texture.image;
        let uri = document.root().entry("images", image)?.get("uri").and_then(|u| u.value.as_str());
        let file = uri.filter(|u| !u.starts_with("data:")).map_or(String::new(), |u| format!(" ({u})"));
        let fault = match document.find_image(image) {
            Ok(Found::Usable { .. }) => return Ok(Self { texture: Some(texture), ..plain }),
            Ok(Found::Missing) => "is not there".to_owned(),
            Ok(Found::Unusable(fault)) => fault,
            // What gets no fur is no reason to stop.
            Err(error) => return Ok(Self { fault: Some(Box::new(error)), ..plain }),
        };
        notes.warn(format!("images[{image}]{file} {fault}; the base colour factor of material {name:?} is used alone"));
        Ok(plain)
    }
}

/// Says where the colour of a material without any that is known may stand.
fn unread(material: &At<'_>, name: &str, notes: &mut Notes) {
    let members = material.get("extensions").and_then(|extensions| extensions.members().ok()).unwrap_or_default();
    // These change how a base colour looks, and state none of their own.
    let states_none = |name: &str| name.starts_with("KHR_materials_") && name != "KHR_materials_common";
    let names: Vec<&str> = members.iter().map(|(name, _)| *name).filter(|name| !states_none(name)).collect();
    if !names.is_empty() {
        let names = names.join(", ");
        notes.warn(format!("material {name:?}: what {names} says of its colour is not read; it is taken as white"));
    }
}

/// What is wrong with a texture that shows no image that could be read.
fn unknown_source(document: &Document, slot: &At<'_>) -> Result<String> {
    let texture = document.root().entry("textures", slot.need("index")?.size()?)?;
    let members = texture.get("extensions").and_then(|extensions| extensions.members().ok()).unwrap_or_default();
    let names: Vec<&str> = members.iter().map(|(name, _)| *name).collect();
    Ok(match names.is_empty() {
        true => format!("({}) names no image", texture.path),
        false => format!("({}) has an image for {} alone, which is not read", texture.path, names.join(", ")),
    })
}

/// The texture that a slot names; none where it shows no image.
///
/// # Errors
/// Names what it points to that is not there.
pub fn texture_of(document: &Document, slot: &At<'_>) -> Result<Option<Texture>> {
    let root = document.root();
    let texture = root.entry("textures", slot.need("index")?.size()?)?;
    let other = |name: &str| extension(&texture, name).and_then(|other| other.get("source"));
    let source = other("EXT_texture_webp").or_else(|| texture.get("source")).or_else(|| other("KHR_texture_basisu"));
    let Some(source) = source else { return Ok(None) };
    let image = source.index_into("images", document.count("images"))?;
    let index = slot.need("index")?.size()?;
    let mut found = Texture::plain(index, image, slot.size_or("texCoord", 0)?);
    if let Some(transform) = extension(slot, "KHR_texture_transform") {
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
