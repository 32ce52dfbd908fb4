//! Which pictures a coat reads at its roots: the asset's own, and those of a preset's maps, which the file then brings along.

use super::skin::{OF_PRESET, decode};
use crate::asset::document::Document;
use crate::asset::image::png;
use crate::data::coat::CoatPrimitive;
use crate::data::image::{Image8, unorm8};
use crate::data::maps::{Maps, sample};
use crate::data::paint::Paint;
use crate::data::texture::Texture;
use crate::error::Result;
use crate::math::{Vec2, Vec3};
use crate::preset::Preset;
use serde_json::json;

/// Most texels along a side of what is painted.
pub const MOST_PAINTED: u32 = 1024;
/// A length that is painted nowhere around a vertex still divides.
const LEAST_LONGEST: f32 = 1e-3;

/// The pictures that a preset's maps add to a file.
#[derive(Clone, Debug, Default)]
pub struct Textures {
    /// Colour of hair.
    colour: Option<Texture>,
    /// Density in red, length in green.
    painted: Option<Texture>,
}

impl Textures {
    /// Adds the pictures of `preset` to the document, where some skin has coordinates for them.
    ///
    /// # Errors
    /// When a map cannot be read.
    pub fn new(document: &mut Document, preset: &Preset, has_uv: bool) -> Result<Self> {
        if !has_uv {
            return Ok(Self::default());
        }
        let Maps { density, length, comb, colour, .. } = decode(&preset.maps)?;
        let painted = painted(density.as_ref(), length.as_ref(), comb.as_ref());
        let mut add = |image: Option<Image8>, name: &str| -> Result<Option<Texture>> {
            image.map(|image| add(document, &image, &format!("{} {name}", preset.name))).transpose()
        };
        Ok(Self { colour: add(colour, "colour")?, painted: add(painted, "density and length")? })
    }

    /// What a coat primitive on `part` reads of `paint`. `vertices` are the skin's, one per coat vertex.
    pub fn painted(&self, carried: CoatPrimitive, paint: &Paint, part: usize, vertices: &[u32]) -> CoatPrimitive {
        let of = &paint.parts[part];
        let colour = match &of.colour {
            Some((texture, _)) if texture.index == OF_PRESET => self.colour.clone(),
            own => own.as_ref().map(|(texture, _)| texture.clone()),
        };
        let painted = self.painted.clone().filter(|_| of.has_lengths() || of.has_densities());
        let mut carried = carried;
        for (tint, &v) in carried.tint.iter_mut().zip(vertices) {
            if colour.is_some() {
                *tint = paint.factor[v as usize].clamp(Vec3::ZERO, Vec3::ONE).extend(tint.w);
            }
            if painted.is_some() {
                tint.w = paint.density[v as usize];
            }
        }
        if painted.is_some() {
            carried.longest = vertices.iter().map(|&v| paint.longest[v as usize].max(LEAST_LONGEST)).collect();
        }
        CoatPrimitive { colour, painted, ..carried }
    }
}

/// Density in red and length in green, in a picture as fine as the finest of the maps but no finer than a coat needs.
fn painted(density: Option<&Image8>, length: Option<&Image8>, comb: Option<&Image8>) -> Option<Image8> {
    let maps = || [density, length, comb].into_iter().flatten();
    let size = |of: fn(&Image8) -> u32| maps().map(of).max().map(|size| size.min(MOST_PAINTED));
    let (width, height) = (size(|image| image.width)?, size(|image| image.height)?);
    // Each texel is the mean of what it covers.
    let mean = |map: Option<&Image8>, channel: usize, x: u32, y: u32| {
        let Some(map) = map else { return 1.0 };
        let (across, down) = (map.width.div_ceil(width), map.height.div_ceil(height));
        let sum: f32 = (0..across * down)
            .map(|i| {
                let at = Vec2::new((i % across) as f32 + 0.5, (i / across) as f32 + 0.5)
                    / Vec2::new(across as f32, down as f32);
                let uv = (Vec2::new(x as f32, y as f32) + at) / Vec2::new(width as f32, height as f32);
                sample(map, uv)[channel]
            })
            .sum();
        sum / (across * down) as f32
    };
    let mut image = Image8::new(width, height, 4);
    for y in 0..height {
        for x in 0..width {
            let at = ((y * width + x) * 4) as usize;
            let values = [mean(density, 0, x, y), mean(length, 0, x, y) * mean(comb, 3, x, y)];
            image.pixels[at..at + 4].copy_from_slice(&[unorm8(values[0]), unorm8(values[1]), 0, 255]);
        }
    }
    Some(image)
}

/// Adds a picture that repeats to a document.
fn add(document: &mut Document, image: &Image8, name: &str) -> Result<Texture> {
    let view = document.push_view(&png(image)?, None);
    let image = document.push("images", json!({"name": name, "mimeType": "image/png", "bufferView": view}));
    let sampler =
        document.push("samplers", json!({"magFilter": 9729, "minFilter": 9987, "wrapS": 10497, "wrapT": 10497}));
    let index = document.push("textures", json!({"name": name, "sampler": sampler, "source": image}));
    Ok(Texture::plain(index, image, 0))
}
