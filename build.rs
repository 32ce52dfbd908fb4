//! Names the code that a bake's bytes come from, for the cache: `FURRIER_EPOCH`, a hash of it.

use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash, Hasher};
use std::path::{Path, PathBuf};

/// Folders and files below `src` that stand on higher floors than `bake/`, which therefore cannot reach them
/// (`tests/architecture.rs`): they change no byte of a bake.
const ABOVE: [&str; 5] = ["batch", "cli", "main.rs", "report", "viewer"];

fn main() -> std::io::Result<()> {
    let mut files: Vec<PathBuf> = vec!["Cargo.lock".into()];
    for folder in ["src", "presets"] {
        collect(Path::new(folder), &mut files)?;
    }
    files.retain(|file| !ABOVE.iter().any(|above| file.starts_with(Path::new("src").join(above))));
    files.sort();
    // Another compiler may hash otherwise: that is another epoch, which only costs a bake.
    let mut hasher = DefaultHasher::new();
    for file in files {
        println!("cargo::rerun-if-changed={}", file.display());
        // A packaged crate may lack the lock file.
        (file.to_string_lossy().replace('\\', "/"), std::fs::read(&file).ok()).hash(&mut hasher);
    }
    for folder in ["build.rs", "src", "presets"] {
        println!("cargo::rerun-if-changed={folder}");
    }
    println!("cargo::rustc-env=FURRIER_EPOCH={:016x}", hasher.finish());
    Ok(())
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> std::io::Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        if entry.file_type()?.is_dir() {
            collect(&entry.path(), files)?;
        } else {
            files.push(entry.path());
        }
    }
    Ok(())
}
