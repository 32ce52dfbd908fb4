//! Assets in their order, each with an output of its own.

use crate::batch::plan::Entry;
use crate::batch::record::files_of;
use crate::error::{Error, Result};
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

/// An asset to bake.
pub struct Wanted {
    /// Relative to the root, or absolute.
    pub input: PathBuf,
    /// The same.
    pub output: PathBuf,
    /// Which recipe.
    pub recipe: usize,
}

/// Numbers what is wanted. What is an output of another is no input: a library may keep both in one folder.
///
/// # Errors
/// Where two have the same output, or one would overwrite an input.
pub fn number(root: &Path, wanted: Vec<Wanted>) -> Result<Vec<Entry>> {
    let made: HashSet<PathBuf> = wanted.iter().flat_map(|w| files_of(&root.join(&w.output))).collect();
    let own = |w: &Wanted| files_of(&root.join(&w.output)).contains(&root.join(&w.input));
    let mut taken: HashMap<PathBuf, PathBuf> = HashMap::new();
    let mut entries = Vec::new();
    for w in wanted {
        if own(&w) {
            return Err(Error::usage("the output would overwrite the input")
                .with_file(&w.input)
                .with_found(w.output.display())
                .with_expected("another file")
                .with_hint("let outputs go to a folder of their own, as in output = \"furry/{path}.glb\""));
        }
        if made.contains(&root.join(&w.input)) {
            continue;
        }
        if let Some(other) = taken.insert(root.join(&w.output), w.input.clone()) {
            return Err(Error::usage("two assets have the same output")
                .with_file(&w.output)
                .with_found(format!("{} and {}", other.display(), w.input.display()))
                .with_expected("an output of its own for each")
                .with_hint("name outputs by {path} and {ext} in a furrier.toml: `furrier batch init` writes one"));
        }
        entries.push(Entry { item: entries.len(), input: w.input, output: w.output, recipe: w.recipe, cost: None });
    }
    Ok(entries)
}
