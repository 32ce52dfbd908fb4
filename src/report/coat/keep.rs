//! Pictures that are kept from one run to the next, so that none is drawn twice.

use super::key::Key;
use crate::asset::write;
use crate::data::film::Film;
use crate::error::{Error, Kind, Result};
use crate::metrics::compare::{LinearImage, load};
use crate::stage::exr;
use serde::{Deserialize, Serialize};
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// A picture and what it cost.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    /// Linear light, premultiplied.
    pub picture: LinearImage,
    /// What it cost when it was drawn.
    pub cost: Cost,
}

/// What drawing cost.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cost {
    /// Time, ms.
    pub ms: f64,
    /// Triangles drawn, where triangles are.
    pub triangles: Option<u64>,
}

/// What kind of file is kept. Its name is its prefix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Of {
    /// Fur drawn hair by hair.
    Render,
    /// A coat, of one build of the program.
    Coat,
}

impl Of {
    fn prefix(self) -> &'static str {
        match self {
            Self::Render => "render-",
            Self::Coat => "coat-",
        }
    }
}

/// A folder of pictures, each an .exr and a .json with its cost. A picture counts from when the .json is there, which is last.
#[derive(Debug)]
pub struct Keep {
    folder: PathBuf,
    used: HashSet<String>,
}

impl Keep {
    /// Makes the folder where there is none, and clears away what a run that was stopped had not finished.
    ///
    /// # Errors
    /// Where it cannot be made.
    pub fn open(folder: &Path) -> Result<Self> {
        std::fs::create_dir_all(folder).map_err(|error| {
            Error::new(Kind::Output, "the folder for finished pictures cannot be made")
                .with_file(folder)
                .with_found(error)
        })?;
        let keep = Self { folder: folder.to_owned(), used: HashSet::new() };
        keep.remove(|name| name.ends_with(".part"));
        Ok(keep)
    }

    /// Where a coat's own file lies.
    pub fn coat_file(&mut self, key: Key) -> PathBuf {
        let name = format!("{}{key}.glb", Of::Coat.prefix());
        let path = self.folder.join(&name);
        self.used.insert(name);
        path
    }

    /// The picture of this key, where it is here whole and of this size.
    pub fn get(&mut self, of: Of, key: Key, size: [u32; 2]) -> Option<Drawing> {
        let [picture, cost] = self.files(of, key);
        let cost = serde_json::from_slice(&std::fs::read(cost).ok()?).ok()?;
        let picture = load(&picture).ok()?;
        ([picture.width, picture.height] == size.map(|n| n as usize)).then_some(Drawing { picture, cost })
    }

    /// Keeps a picture.
    ///
    /// # Errors
    /// Where it cannot be written.
    pub fn put(&mut self, of: Of, key: Key, drawing: &Drawing) -> Result<()> {
        let [picture, cost] = self.files(of, key);
        let LinearImage { width, height, colour, alpha } = &drawing.picture;
        let film =
            Film { width: *width, height: *height, radiance: colour.clone(), alpha: alpha.clone(), ..Film::default() };
        let text = serde_json::to_vec(&drawing.cost)
            .map_err(|error| Error::new(Kind::Output, "a cost cannot be encoded").with_found(error))?;
        write::all(&[(picture, &exr::encode(&film)?), (cost, &text)], &[])
    }

    /// Removes coats and their pictures that this run had no use for: those of other builds. Renders stay.
    pub fn tidy(&self) {
        self.remove(|name| name.starts_with(Of::Coat.prefix()) && !self.used.contains(name));
    }

    fn files(&mut self, of: Of, key: Key) -> [PathBuf; 2] {
        ["exr", "json"].map(|kind| {
            let name = format!("{}{key}.{kind}", of.prefix());
            let path = self.folder.join(&name);
            self.used.insert(name);
            path
        })
    }

    /// Removes files by name. One that stays is in nobody's way.
    fn remove(&self, which: impl Fn(&str) -> bool) {
        for entry in std::fs::read_dir(&self.folder).into_iter().flatten().flatten() {
            if entry.file_name().to_str().is_some_and(&which) {
                let _ = std::fs::remove_file(entry.path());
            }
        }
    }
}
