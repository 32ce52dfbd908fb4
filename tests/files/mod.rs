//! Files as people have them: small relatives of what was reported of programs like this one, each with the value that is right of it.

mod avatars;
mod bare;
mod broken;
mod compressed;
mod levels;
mod materials;
mod obj;
mod reading;
mod returned;
mod scenes;
mod wild;

use crate::one_skin::{grown, thin};
use furrier::asset::{self, Asset, Document, Fallback, Reading};
use furrier::bake::units::Units;
use furrier::bake::{Baked, Method, Request};
use furrier::error::Error;
use furrier::math::Vec3;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Writes a file of the folder.
pub fn put(folder: &Path, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.join(name);
    std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
    std::fs::write(&path, bytes).expect("written");
    path
}

/// An image of one colour, as PNG.
pub fn png(colour: [u8; 3]) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let image = image::RgbImage::from_pixel(4, 4, image::Rgb(colour));
    image.write_to(&mut bytes, image::ImageFormat::Png).expect("a PNG");
    bytes.into_inner()
}

pub fn load(path: &Path) -> Asset {
    asset::load(&path.to_string_lossy()).unwrap_or_else(|error| panic!("{error}"))
}

/// Whether something of this is said.
pub fn says(lines: &[String], words: &[&str]) -> bool {
    lines.iter().any(|line| words.iter().all(|word| line.contains(word)))
}

/// Mean colour of the guard hair that grows on a file, linear, where presets leave it to the file.
pub fn hair_colour(path: &Path) -> Vec3 {
    let white = ["colour.variation=0", "colour.guard=[[1,1,1],[1,1,1],[1,1,1]]", "undercoat.density_per_cm2=0"];
    let grown = grown(path, &thin(&white));
    let tints = &grown.scene().guard.expect("hair").0.tint;
    assert!(!tints.is_empty(), "no hair");
    tints.iter().sum::<Vec3>() / tints.len() as f32
}

pub fn close(a: Vec3, b: [f32; 3]) -> bool {
    (a - Vec3::from(b)).abs().max_element() < 5e-3
}

/// The plane of 20 cm, whose only material is replaced, and images, each in a buffer view.
pub fn plane(material: Value, images: &[&[u8]]) -> Document {
    let mut document = asset::load("sample:plane").expect("a sample").document;
    document.json["materials"][0] = material;
    for bytes in images {
        let view = document.push_view(bytes, None);
        let media = if bytes.starts_with(b"\xABKTX") { "image/ktx2" } else { "image/png" };
        document.push("images", json!({"bufferView": view, "mimeType": media}));
    }
    document
}

/// Appends indices and gives their accessor.
pub fn push_indices(document: &mut Document, indices: &[u32]) -> usize {
    let bytes: Vec<u8> = indices.iter().flat_map(|i| i.to_le_bytes()).collect();
    let view = document.push_view(&bytes, Some(34963));
    document
        .push("accessors", json!({"bufferView": view, "componentType": 5125, "count": indices.len(), "type": "SCALAR"}))
}

/// Writes a document as a GLB of the folder.
pub fn glb(document: &Document, folder: &Path, name: &str) -> PathBuf {
    put(folder, name, document.to_glb().expect("a GLB"))
}

/// A bake with little hair.
pub fn request(input: &Path, out: &Path) -> Request {
    Request {
        input: input.to_string_lossy().into_owned(),
        out: out.to_owned(),
        preset: thin(&[]),
        presets: vec![],
        materials: vec![],
        units: Units::Auto,
        method: Method::Lapped,
        seed: 1,
        fallback: Fallback::Shells(2),
        judge: false,
        cache: None,
        draft: false,
        reading: Reading::default(),
    }
}

/// What baking says, with little hair.
pub fn bake(input: &Path, out: &Path) -> Result<Baked, Error> {
    furrier::bake::bake(&request(input, out), &mut |_| ())
}
