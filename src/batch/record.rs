//! What is known of an output: what it was made from, and what came of it. One small file per output, so that many machines that
//! share a folder need no locks.

use super::EPOCH;
use super::content::Digest;
use super::key::Key;
use crate::asset::coat::VERSION;
use crate::asset::glimpse::glimpse;
use crate::asset::write;
use crate::error::{Error, Kind, Result};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Which program wrote an output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Program {
    /// Version of the coat extension.
    pub format: u64,
    /// [`EPOCH`].
    pub epoch: u32,
}

impl Program {
    /// The one that runs.
    pub const CURRENT: Self = Self { format: VERSION, epoch: EPOCH };
}

/// What an output is made from beside its recipe.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Sources {
    /// Of the input file.
    pub input: Digest,
    /// Files that it names, relative to its folder where they lie there; none for one that is not there.
    pub references: Vec<(PathBuf, Option<Digest>)>,
}

impl Sources {
    /// Of an input and all that it names.
    ///
    /// # Errors
    /// Where the input itself cannot be read.
    pub fn read(input: &Path) -> Result<Self> {
        let digest = digest(input)?;
        let folder = input.parent().unwrap_or(Path::new(""));
        let name = |path: PathBuf| path.strip_prefix(folder).map(Path::to_owned).unwrap_or(path);
        let references = glimpse(input).references.into_iter().map(|path| (name(path), None)).collect();
        Ok(Self { input: digest, references }.with_references(folder))
    }

    /// The same files as they are now: what a file names is decided by its bytes.
    ///
    /// # Errors
    /// Where the input itself cannot be read.
    pub fn again(&self, input: &Path) -> Result<Self> {
        let now = digest(input)?;
        if now != self.input {
            return Ok(Self { input: now, references: self.references.clone() });
        }
        Ok(self.clone().with_references(input.parent().unwrap_or(Path::new(""))))
    }

    fn with_references(mut self, folder: &Path) -> Self {
        for (name, digest) in &mut self.references {
            *digest = Digest::of_file(&folder.join(name)).ok();
        }
        self
    }
}

fn digest(input: &Path) -> Result<Digest> {
    Digest::of_file(input).map_err(|error| Error::input(format!("cannot read the file: {error}")).with_file(input))
}

/// What is known of an output.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// The input, as the plan names it.
    pub input: PathBuf,
    /// What it was made from.
    pub sources: Sources,
    /// How: the hash of a [`Key`] that is kept beside.
    pub recipe: Digest,
    /// By which program.
    pub program: Program,
    /// The files that were written.
    pub output: Digest,
    /// Their size.
    pub bytes: u64,
    /// Time of the bake, s.
    pub seconds: f64,
    /// Threads it had.
    pub threads: usize,
    /// What may not be as the user expects, one sentence each.
    pub warnings: Vec<String>,
    /// What was decided for the user, one sentence each.
    pub notes: Vec<String>,
}

/// A folder with the records of a library's outputs.
#[derive(Clone, Debug)]
pub struct Records {
    folder: PathBuf,
}

impl Records {
    /// In the folder that a plan keeps what it knows in.
    pub fn new(state: &Path) -> Self {
        Self { folder: state.to_owned() }
    }

    /// Makes the folders.
    ///
    /// # Errors
    /// Where they cannot be made.
    pub fn create(&self) -> Result<()> {
        ["records", "recipes"].iter().try_for_each(|name| create(&self.folder.join(name)))
    }

    fn file(&self, output: &Path) -> PathBuf {
        // Relative to the library where it can be: records stay true where a library is moved or mounted elsewhere.
        let library = self.folder.parent().unwrap_or(Path::new(""));
        let name = output.strip_prefix(library).unwrap_or(output).to_string_lossy().replace('\\', "/");
        self.folder.join("records").join(format!("{}.json", Digest::of(name.as_bytes()).short()))
    }

    /// Whether a file is an output that was recorded.
    pub fn knows(&self, output: &Path) -> bool {
        self.file(output).is_file()
    }

    /// The record of an output: none where there is none, or an error in words where it cannot be read.
    pub fn get(&self, output: &Path) -> Option<std::result::Result<Record, String>> {
        let bytes = std::fs::read(self.file(output)).ok()?;
        Some(serde_json::from_slice(&bytes).map_err(|error| error.to_string()))
    }

    /// Keeps a record, and the recipe that it names.
    ///
    /// # Errors
    /// Where they cannot be written.
    pub fn put(&self, output: &Path, record: &Record, key: &Key) -> Result<()> {
        let recipe = self.recipe_file(&key.digest);
        if !recipe.is_file() {
            write::whole(&recipe, key.value.to_string().as_bytes(), &[])?;
        }
        let text = serde_json::to_vec(record)
            .map_err(|error| Error::new(Kind::Output, "a record cannot be encoded").with_found(error))?;
        write::whole(&self.file(output), &text, &[])
    }

    /// Forgets an output.
    pub fn remove(&self, output: &Path) {
        let _ = std::fs::remove_file(self.file(output));
    }

    /// A recipe that was kept.
    pub fn recipe(&self, digest: &Digest) -> Option<Value> {
        serde_json::from_slice(&std::fs::read(self.recipe_file(digest)).ok()?).ok()
    }

    fn recipe_file(&self, digest: &Digest) -> PathBuf {
        self.folder.join("recipes").join(format!("{}.json", digest.short()))
    }
}

/// Makes a folder and those above it.
///
/// # Errors
/// Where it cannot be made.
pub fn create(folder: &Path) -> Result<()> {
    std::fs::create_dir_all(folder).map_err(|error| {
        Error::new(Kind::Output, format!("a folder cannot be made: {error}"))
            .with_file(folder)
            .with_hint("check free space and permissions")
    })
}

/// The files of an output: a .gltf has its .bin beside it.
pub fn files_of(output: &Path) -> Vec<PathBuf> {
    let text = output.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("gltf"));
    let beside = text.then(|| output.with_extension("bin"));
    std::iter::once(output.to_owned()).chain(beside).collect()
}

/// Hash and size of an output's files.
///
/// # Errors
/// Where one is not there.
pub fn digest_of(output: &Path) -> std::io::Result<(Digest, u64)> {
    let files = files_of(output);
    let files: Vec<&Path> = files.iter().map(PathBuf::as_path).collect();
    let mut bytes = 0;
    for file in &files {
        bytes += std::fs::metadata(file)?.len();
    }
    Ok((Digest::of_files(&files)?, bytes))
}
