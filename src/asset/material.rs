//! The base colour of a part: what hair takes its colour from where a preset does not say otherwise.

use super::document::Document;
use super::image::Found;
use super::json::At;
use super::repair::Notes;
use crate::data::image::{Image8, linear_from_srgb};
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

/// How a texture is laid on.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// glTF image.
    pub image: usize,
    /// Which of the mesh's `uv_sets`.
    pub uv_set: usize,
    /// KHR_texture_transform: offset, rotation (rad) and scale.
    pub offset: Vec2,
    /// Counter-clockwise rotation, rad.
    pub rotation_rad: f32,
    /// Scale.
    pub scale: Vec2,
    /// What lies outside [0, 1] along u and v.
    pub wrap: [Wrap; 2],
}

/// What a texture shows outside [0, 1].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    /// The same again.
    Repeat,
    /// The same, mirrored at each whole number.
    Mirror,
    /// The border texel.
    Clamp,
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
        let mut texture = pbr.get("baseColorTexture").map(|slot| Texture::of(document, &slot)).transpose()?.flatten();
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

impl Texture {
    fn of(document: &Document, slot: &At<'_>) -> Result<Option<Self>> {
        let root = document.root();
        let texture = root.entry("textures", slot.need("index")?.size()?)?;
        let webp = texture.get("extensions").and_then(|e| e.get("EXT_texture_webp")?.get("source"));
        let Some(source) = webp.or_else(|| texture.get("source")) else { return Ok(None) };
        let image = source.index_into("images", document.count("images"))?;
        let mut found = Self {
            image,
            uv_set: slot.size_or("texCoord", 0)?,
            offset: Vec2::ZERO,
            rotation_rad: 0.0,
            scale: Vec2::ONE,
            wrap: [Wrap::Repeat; 2],
        };
        if let Some(transform) = slot.get("extensions").and_then(|e| e.get("KHR_texture_transform")) {
            let pair = |key: &str, default: Vec2| {
                transform
                    .get(key)
                    .map_or(Ok(default), |at| at.numbers::<2>().map(|n| Vec2::new(n[0] as f32, n[1] as f32)))
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

    /// Where the texture is read for the mesh's texture coordinate `uv` (KHR_texture_transform: T·R·S).
    pub fn transformed(&self, uv: Vec2) -> Vec2 {
        let (sin, cos) = (libm::sinf(self.rotation_rad), libm::cosf(self.rotation_rad));
        let scaled = uv * self.scale;
        Vec2::new(cos * scaled.x + sin * scaled.y, cos * scaled.y - sin * scaled.x) + self.offset
    }

    /// The texture at the mesh's texture coordinate `uv`, bilinear, linear RGBA; `image` is its decoded image.
    pub fn sample(&self, image: &Image8, uv: Vec2) -> Vec4 {
        let at = self.transformed(uv);
        let axis = |coordinate: f32, size: u32, wrap: Wrap| {
            let texel = f64::from(coordinate) * f64::from(size) - 0.5;
            let low = texel.floor();
            let index = |i: f64| match wrap {
                Wrap::Repeat => i.rem_euclid(f64::from(size)),
                Wrap::Mirror => {
                    let folded = i.rem_euclid(2.0 * f64::from(size));
                    folded.min(2.0 * f64::from(size) - 1.0 - folded)
                }
                Wrap::Clamp => i.clamp(0.0, f64::from(size) - 1.0),
            };
            (index(low) as u32, index(low + 1.0) as u32, (texel - low) as f32)
        };
        let (x0, x1, fx) = axis(at.x, image.width, self.wrap[0]);
        let (y0, y1, fy) = axis(at.y, image.height, self.wrap[1]);
        let texel = |x: u32, y: u32| {
            let p = image.pixel(x.min(image.width - 1), y.min(image.height - 1));
            let c = |i: usize| linear_from_srgb(f32::from(p[i]) / 255.0);
            Vec4::new(c(0), c(1), c(2), f32::from(p[3]) / 255.0)
        };
        texel(x0, y0).lerp(texel(x1, y0), fx).lerp(texel(x0, y1).lerp(texel(x1, y1), fx), fy)
    }
}
