//! Floor 2: files in and out. Every input becomes a glTF [`Document`] that is written back with a coat added and all
//! else unchanged; its triangle primitives are the [`Part`]s that fur grows on.

mod accessor;
pub mod axes;
mod basis;
pub mod coat;
pub mod document;
mod draco;
mod encode;
mod extension;
mod glb;
pub mod glimpse;
pub mod image;
mod json;
pub mod ktx2;
mod lod;
pub mod material;
mod mend;
mod meshopt;
mod obj;
mod origin;
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
mod text;
mod uri;
mod validate;
mod variants;
mod vrm;
mod words;
pub mod write;

pub use coat::{Fallback, read_coat, write_coat};
pub use document::Document;
pub use part::Part;
pub use pose::{Pose, Posed};
pub use select::{Selection, select};
pub use variants::Variant;
pub use words::is_bare;

use crate::error::Result;
use crate::math::DMat3;
use scene_graph::SceneGraph;
use std::path::Path;

/// An input, read and checked.
#[derive(Clone, Debug)]
pub struct Asset {
    /// The file.
    pub document: Document,
    /// Nodes and skins, and which way up they are.
    pub scene: SceneGraph,
    /// What fur can grow on.
    pub parts: Vec<Part>,
    /// Diagonal of the default scene's bounding box in the rest pose, file units.
    pub diagonal_units: f64,
    /// What was repaired or passed over, one sentence each.
    pub warnings: Vec<String>,
    /// What was decided for the user, one sentence each.
    pub notes: Vec<String>,
}

/// How an input is to be read.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reading {
    /// Turns the file's axes so that its up is +y and its front looks to +z ([`axes::Upright`]). The asset is combed, lit and
    /// seen that way; what is written keeps the file's own. None where these are glTF's.
    pub upright: Option<DMat3>,
    /// Whether a coat that the input wears already is taken off first.
    pub rebake: bool,
    /// Whether all levels of detail are parts, or the finest alone.
    pub lods: bool,
}

/// Reads a `.glb`, `.gltf` or `.obj` file, or `sample:NAME`, a mesh made in code.
///
/// # Errors
/// Names file, field, value found and what would have been accepted. Nothing outside the input's folder is opened.
pub fn load(input: &str) -> Result<Asset> {
    load_as(input, &Reading::default())
}

/// As [`load`], in a way of one's own.
///
/// # Errors
/// As [`load`].
pub fn load_as(input: &str, reading: &Reading) -> Result<Asset> {
    let (mut document, mut warnings) = match input.strip_prefix("sample:") {
        Some(name) => (sample::document(name)?, Vec::new()),
        None => read_document(Path::new(input))?,
    };
    if reading.rebake {
        document = coat::bared(document, &mut warnings)?;
    }
    let name = document.name.clone();
    Asset::standing(document, warnings, reading).map_err(|error| error.with_file(name))
}

/// The document of a file, and what was odd about it.
///
/// # Errors
/// As [`load`].
pub fn read_document(path: &Path) -> Result<(Document, Vec<String>)> {
    let mut warnings = Vec::new();
    let mut read = || {
        let bytes = uri::read_file(path)?;
        if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("obj")) {
            return obj::read(&bytes, path, &mut warnings);
        }
        Document::parse(&bytes, path, &mut warnings)
    };
    let document = read().map_err(|error| error.with_file(path))?;
    Ok((document, warnings))
}

impl Asset {
    /// The parts of a document; `warnings` are those of reading it.
    ///
    /// # Errors
    /// Names what cannot be used.
    pub fn new(document: Document, warnings: Vec<String>) -> Result<Self> {
        Self::standing(document, warnings, &Reading::default())
    }

    /// As [`Self::new`], read in a way of one's own.
    fn standing(mut document: Document, warnings: Vec<String>, reading: &Reading) -> Result<Self> {
        let scene = SceneGraph { upright: reading.upright, ..SceneGraph::of(&document)? };
        let mut notes = repair::Notes { warnings, ..repair::Notes::default() };
        let (parts, diagonal_units) = part::collect(&document, &scene, reading.lods, &mut notes)?;
        repair::apply(&mut document, &mut notes)?;
        Ok(Self { document, scene, parts, diagonal_units, warnings: notes.warnings, notes: notes.told })
    }
}
