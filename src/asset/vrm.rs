//! What an avatar (VRM 0) says of its materials beside glTF.

use super::document::Document;
use crate::data::image::linear_from_srgb;
use crate::math::Vec4;
use serde_json::Value;

/// The colour of a material in the avatar's own list; programs that know avatars show this one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Colour {
    /// Linear RGBA.
    pub factor: Option<Vec4>,
    /// Its texture, by number.
    pub texture: Option<u64>,
}

/// What `materialProperties` says of the colour of material `index`; nothing where it leaves that to glTF.
pub fn colour(document: &Document, index: usize) -> Colour {
    let own = document.json.pointer(&format!("/extensions/VRM/materialProperties/{index}"));
    let Some(own) = own.filter(|own| own["shader"] != "VRM_USE_GLTFSHADER") else { return Colour::default() };
    let texture = own["textureProperties"]["_MainTex"].as_u64();
    Colour {
        factor: numbers(&own["vectorProperties"]["_Color"]).map(linear),
        texture: texture.filter(|&texture| texture < document.count("textures") as u64),
    }
}

/// Four numbers.
pub fn numbers(value: &Value) -> Option<Vec4> {
    let list: Option<Vec<f32>> = value.as_array()?.iter().map(|n| n.as_f64().map(|n| n as f32)).collect();
    let numbers = Vec4::from_array(<[f32; 4]>::try_from(list?).ok()?);
    numbers.is_finite().then_some(numbers)
}

/// VRM 0 has colours as they are shown, glTF as light adds up.
pub fn linear(colour: Vec4) -> Vec4 {
    let [r, g, b, a] = colour.to_array();
    Vec4::new(linear_from_srgb(r), linear_from_srgb(g), linear_from_srgb(b), a)
}
