//! What is baked how and where to: a folder, several files, or a `furrier.toml`. In: paths and choices. Out: a plan.

mod entries;
pub mod manifest;
mod pattern;
pub mod scan;
pub mod starter;

use super::plan::Plan;
use crate::bake::recipe::Choices;
use crate::error::{Error, Result};
use entries::{Wanted, number};
use manifest::Manifest;
use pattern::Pattern;
use std::path::{Path, PathBuf};

/// Name of a library's own file.
pub const MANIFEST: &str = "furrier.toml";
/// Where records are kept below a library or its outputs.
const STATE: &str = ".furrier";
/// Where outputs go below a folder without a manifest.
const OUTPUTS: &str = "furry";

/// The plan of a library: `paths` is a folder, several files, or a `furrier.toml`. `choices` and `output`, a folder, are for folders and
/// files; a manifest has its own, and `chosen` says whether any were made.
///
/// # Errors
/// Where a path or a rule cannot be used, or two outputs are the same.
pub fn open(paths: &[PathBuf], choices: &Choices, output: Option<&Path>, chosen: bool) -> Result<Plan> {
    let folder = match paths {
        [path] if path.is_dir() => Some(path.as_path()),
        _ => None,
    };
    let manifest = match (paths, folder) {
        (_, Some(folder)) => Some(folder.join(MANIFEST)).filter(|path| path.is_file()),
        ([path], None) => Some(path.clone()).filter(|path| path.extension().is_some_and(|e| e == "toml")),
        _ => None,
    };
    match (manifest, folder) {
        (Some(manifest), _) => {
            if chosen || output.is_some() {
                return Err(Error::usage("a library's own file says how it is baked and where to")
                    .with_file(&manifest)
                    .with_expected(
                        "no choice of preset, settings, materials, layout, seed, fallback, axes, levels or output beside it",
                    )
                    .with_hint(format!("change {MANIFEST}, or name a folder or files without one")));
            }
            of_manifest(&manifest)
        }
        (None, Some(folder)) => of_folder(folder, choices, output),
        (None, None) => of_files(paths, choices, output),
    }
}

fn of_folder(folder: &Path, choices: &Choices, output: Option<&Path>) -> Result<Plan> {
    let root = absolute(folder)?;
    let outputs = match output {
        Some(output) => below(&root, &absolute(output)?),
        None => PathBuf::from(OUTPUTS),
    };
    let found = scan::assets(&root, &[root.join(&outputs)])?;
    if found.is_empty() {
        return Err(nothing(folder));
    }
    let pattern = Pattern::like_inputs(&outputs);
    plan(root, outputs.join(STATE), found, &pattern, choices)
}

fn of_files(files: &[PathBuf], choices: &Choices, output: Option<&Path>) -> Result<Plan> {
    let root = absolute(Path::new("."))?;
    for file in files {
        if file.is_dir() {
            return Err(Error::usage("a library is one folder, or files")
                .with_file(file)
                .with_found(format!("a folder among {} paths", files.len()))
                .with_hint("bake each folder by itself, or write a furrier.toml: `furrier batch init`"));
        }
        if !file.is_file() {
            return Err(Error::input("there is no such file")
                .with_file(file)
                .with_expected("a folder, .glb, .gltf and .obj files, or a furrier.toml"));
        }
    }
    let outputs = below(&root, &absolute(output.unwrap_or(Path::new(OUTPUTS)))?);
    plan(root, outputs.join(STATE), files.to_vec(), &Pattern::by_name(&outputs), choices)
}

fn plan(root: PathBuf, state: PathBuf, inputs: Vec<PathBuf>, pattern: &Pattern, choices: &Choices) -> Result<Plan> {
    let recipes = vec![choices.recipe()?];
    let wanted = inputs.into_iter().map(|input| Wanted { output: pattern.output(&input), input, recipe: 0 });
    Ok(Plan { entries: number(&root, wanted.collect())?, root, state, recipes })
}

fn of_manifest(path: &Path) -> Result<Plan> {
    let manifest = Manifest::read(path)?;
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let root = absolute(folder)?;
    let mut recipes = Vec::new();
    let wanted = manifest.wanted(&root, &mut recipes)?;
    if wanted.is_empty() {
        return Err(nothing(path));
    }
    Ok(Plan { entries: number(&root, wanted)?, root, state: PathBuf::from(STATE), recipes })
}

fn nothing(library: &Path) -> Error {
    Error::input("there is nothing to bake in the library")
        .with_file(library)
        .with_expected("at least one .glb, .gltf or .obj file")
}

/// `path` relative to `root` where it lies there.
fn below(root: &Path, path: &Path) -> PathBuf {
    path.strip_prefix(root).map_or_else(|_| path.to_owned(), Path::to_owned)
}

fn absolute(path: &Path) -> Result<PathBuf> {
    std::path::absolute(path)
        .map(|path| path.components().collect())
        .map_err(|error| Error::input(format!("the path cannot be used: {error}")).with_file(path))
}
