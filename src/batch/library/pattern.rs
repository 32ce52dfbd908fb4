//! Where outputs go: a folder, and a path below it with places for parts of the input's.

use crate::error::{Error, Result};
use std::path::{Path, PathBuf};

/// A piece of a pattern.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Piece {
    Text(String),
    /// `{path}`: the input below the library, without its ending.
    Path,
    /// `{dir}`: its folder.
    Dir,
    /// `{name}`: its name without ending.
    Name,
    /// `{ext}`: its ending.
    Ext,
}

/// A folder and what follows it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pattern {
    folder: PathBuf,
    pieces: Vec<Piece>,
}

impl Pattern {
    /// Reads a pattern.
    ///
    /// # Errors
    /// Where it names something else, could not tell assets apart, or is no glTF file's name.
    pub fn new(text: &str) -> Result<Self> {
        let fault = |what: &str, expected: &str| {
            Error::usage(what).with_field("output").with_found(text).with_expected(expected)
        };
        let fixed = text.split_once('{').map_or(text, |(fixed, _)| fixed);
        let (folder, mut rest) = text.split_at(fixed.rfind('/').map_or(0, |at| at + 1));
        let mut pieces = Vec::new();
        while let Some((before, after)) = rest.split_once('{') {
            let place = after.split_once('}').and_then(|(place, after)| Some((piece(place)?, after)));
            let Some((place, after)) = place else {
                return Err(fault("an output names something that is not known", "{path}, {dir}, {name} or {ext}"));
            };
            pieces.extend([Piece::Text(before.to_owned()), place]);
            rest = after;
        }
        pieces.push(Piece::Text(rest.to_owned()));
        if !pieces.contains(&Piece::Path) && !pieces.contains(&Piece::Name) {
            return Err(fault("all assets would have the same output", "{path} or {name} in it"));
        }
        if !rest.ends_with(".glb") && !rest.ends_with(".gltf") {
            return Err(fault("outputs are glTF files", "a path that ends in .glb or .gltf"));
        }
        Ok(Self { folder: PathBuf::from(folder), pieces })
    }

    /// Below a folder as inputs are below theirs.
    pub fn like_inputs(folder: &Path) -> Self {
        Self { folder: folder.to_owned(), pieces: vec![Piece::Path, Piece::Text(".glb".into())] }
    }

    /// In a folder, by name alone.
    pub fn by_name(folder: &Path) -> Self {
        Self { folder: folder.to_owned(), pieces: vec![Piece::Name, Piece::Text(".glb".into())] }
    }

    /// The output of an input.
    pub fn output(&self, input: &Path) -> PathBuf {
        let text = |path: &Path| path.to_string_lossy().replace('\\', "/");
        let mut below = String::new();
        for piece in &self.pieces {
            below.push_str(&match piece {
                Piece::Text(text) => text.clone(),
                Piece::Path => text(&input.with_extension("")),
                Piece::Dir => text(input.parent().unwrap_or(Path::new(""))),
                Piece::Name => text(Path::new(input.file_stem().unwrap_or_default())),
                Piece::Ext => text(Path::new(input.extension().unwrap_or_default())).to_lowercase(),
            });
        }
        // An empty {dir} leaves a slash behind that would lead to the root of the disk.
        self.folder.join(below.trim_start_matches('/'))
    }

    /// The folder that all outputs lie below; empty where that is the library itself.
    pub fn folder(&self) -> &Path {
        &self.folder
    }
}

fn piece(place: &str) -> Option<Piece> {
    Some(match place {
        "path" => Piece::Path,
        "dir" => Piece::Dir,
        "name" => Piece::Name,
        "ext" => Piece::Ext,
        _ => return None,
    })
}
