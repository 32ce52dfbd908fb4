//! Floor 2: files in and out. Every input becomes a glTF [`Document`] that is written back with a coat added and all
//! else unchanged; its triangle primitives are the [`Part`]s that fur grows on.

mod accessor;
pub mod coat;
pub mod document;
mod encode;
mod extension;
mod glb;
pub mod glimpse;
pub mod image;
mod json;
pub mod ktx2;
pub mod material;
mod meshopt;
mod obj;
mod parse;
pub mod part;
pub mod pose;
mod primitive;
mod repair;
pub mod sample;
pub mod scene_graph;
mod select;
pub mod stored;
pub mod strands;
mod subject;
mod uri;
mod validate;
pub mod write;

pub use coat::{Fallback, read_coat, write_coat};
pub use document::Document;
pub use part::Part;
pub use pose::{Pose, Posed};
pub use select::{is_bare, select};

use crate::error::Result;
use scene_graph::SceneGraph;
use std::path::Path;

/// An input, read and checked.
#[derive(Clone, Debug)]
pub struct Asset {
    /// The file.
    pub document: Document,
    /// Nodes and skins.
    pub scene: SceneGraph,
    /// What fur can grow on.
    pub parts: Vec<Part>,
    /// Diagonal of the default scene's bounding box in the rest pose, file units.
    pub diagonal_units: f64,
    /// What was repaired or passed over, one sentence each.
    pub warnings: Vec<String>,
}

/// Reads a `.glb`, `.gltf` or `.obj` file, or `sample:NAME`, a mesh made in code.
///
/// # Errors
/// Names file, field, value found and what would have been accepted. Nothing outside the input's folder is opened.
pub fn load(input: &str) -> Result<Asset> {
    let mut warnings = Vec::new();
    let document = if let Some(name) = input.strip_prefix("sample:") {
        sample::document(name)?
    } else {
        let path = Path::new(input);
        let mut read = || {
            let bytes = uri::read_file(path)?;
            if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("obj")) {
                return obj::read(&bytes, path, &mut warnings);
            }
            Document::parse(&bytes, path, &mut warnings)
        };
        read().map_err(|error| error.with_file(path))?
    };
    let name = document.name.clone();
    Asset::new(document, warnings).map_err(|error| error.with_file(name))
}

impl Asset {
    /// The parts of a document; `warnings` are those of reading it.
    ///
    /// # Errors
    /// Names what cannot be used.
    pub fn new(mut document: Document, warnings: Vec<String>) -> Result<Self> {
        let scene = SceneGraph::of(&document)?;
        let mut notes = repair::Notes { warnings, mended: Vec::new() };
        let (parts, diagonal_units) = part::collect(&document, &scene, &mut notes)?;
        repair::apply(&mut document, &mut notes)?;
        Ok(Self { document, scene, parts, diagonal_units, warnings: notes.warnings })
    }
}
