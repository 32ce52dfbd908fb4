//! A `furrier.toml` to begin with.

use super::MANIFEST;
use crate::asset::write;
use crate::error::{Error, Result};
use std::path::{Path, PathBuf};

/// The file's text.
pub const TEXT: &str = r#"# What is baked in this folder, and how. `furrier batch .` does it.

# Holds for all files unless a rule says otherwise. Every key may be left out.
[defaults]
presets = ["fox"]                 # built-in presets or files; "Hair=sheep" is for the material Hair alone
output = "furry/{path}.glb"       # {path}: below this folder, without ending; {dir}, {name}, {ext} are its parts
# set = ["guard.length.mm=30"]    # values of the presets; rules add to them
# materials = ["Body"]            # fur these alone; without it all but eyes, claws and the like
# units = "auto"                  # what a unit of the files is: auto, m, cm, mm, in
# parameterisation = "lapped"     # lapped, atlas, uv
# uv_set = 0                      # which coordinates of its own an asset is laid out by, with "uv"
# target = "desktop"              # desktop, vr, web, phone: layers, texels and fallback that suit it
# layers = 13
# texture_size = 128
# seed = 0
# fallback = "shells:8"           # what programs without the extension show: none, shells:N
# up = "z"                        # which axis of the files is up; glTF's is y. forward = "-y" says where their fronts look
# lods = true                     # fur coarser levels of detail too, each by itself

# Which files, and what is different for them. Later rules go over earlier ones. A file that no rule names is not baked.
[[rules]]
files = ["**/*.{glb,gltf,obj}"]   # * stays within a folder, ** does not

# [[rules]]
# files = ["cats/**"]
# presets = ["short-cat"]
# set = ["guard.length.mm=18"]

# [[rules]]
# files = ["**/*_collision.*"]
# skip = true
"#;

/// Writes it into a folder.
///
/// # Errors
/// Where there is one already, or it cannot be written.
pub fn write(folder: &Path) -> Result<PathBuf> {
    let path = folder.join(MANIFEST);
    if path.exists() {
        return Err(Error::usage("the library has its file already")
            .with_file(&path)
            .with_hint("change that one, or remove it first"));
    }
    write::whole(&path, TEXT.as_bytes(), &[])?;
    Ok(path)
}
