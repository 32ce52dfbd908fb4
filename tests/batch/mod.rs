//! Many assets: what is baked and why, what an interrupted or refused run leaves behind, and that outputs are those of single bakes.

mod browser;
mod decisions;
mod ends;
mod epoch;
mod farm;
mod library;
mod pages;
mod parts;
mod watch;

use crate::common::furrier_path;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A bake's options without its threads, which a batch has of its own.
pub fn small() -> Vec<&'static str> {
    crate::bake::SMALL[2..].to_vec()
}

/// A mesh of one triangle; each `number` is another one.
pub fn triangle(number: u32) -> String {
    let far = 1.0 + f64::from(number) * 0.25;
    format!("v 0 0 0\nv {far} 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n")
}

/// A folder with `count` triangles in it: `t0.obj` and so on, every third in a folder `sub`.
pub fn triangles(count: u32) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("sub")).unwrap();
    for number in 0..count {
        let place = if number % 3 == 2 { folder.path().join("sub") } else { folder.path().to_owned() };
        std::fs::write(place.join(format!("t{number}.obj")), triangle(number)).unwrap();
    }
    folder
}

/// `furrier` with arguments.
pub fn furrier(arguments: &[&str]) -> Command {
    let mut command = Command::new(furrier_path());
    command.args(arguments);
    command
}

/// `furrier batch FOLDER` with what makes bakes small.
pub fn batch(folder: &Path, more: &[&str]) -> Command {
    let mut command = furrier(&["batch"]);
    command.arg(folder).args(small()).args(["--threads", "2"]).args(more);
    command
}

/// What a command prints as JSON, with its exit code.
pub fn json(command: &mut Command) -> (i32, Value) {
    let ended = command.arg("--json").output().unwrap();
    let value = serde_json::from_slice(&ended.stdout).unwrap_or_else(|e| panic!("{e}: {}", said(&ended)));
    (ended.status.code().unwrap(), value)
}

/// What a command said on both streams.
pub fn said(ended: &Output) -> String {
    String::from_utf8_lossy(&[&ended.stdout[..], &ended.stderr[..]].concat()).into_owned()
}

/// Runs a command that must succeed.
pub fn succeeds(command: &mut Command) -> String {
    let ended = command.output().unwrap();
    assert!(ended.status.success(), "{}", said(&ended));
    said(&ended)
}

/// Every file below a folder and its bytes, without what a batch knows of them.
pub fn outputs(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let files = walkdir::WalkDir::new(folder).into_iter().map(|entry| entry.unwrap());
    files
        .filter(|entry| entry.file_type().is_file() && !entry.path().components().any(|c| c.as_os_str() == ".furrier"))
        .map(|entry| (entry.path().strip_prefix(folder).unwrap().to_owned(), std::fs::read(entry.path()).unwrap()))
        .collect()
}

/// What single bakes of `inputs` below `folder` give, by the outputs' names below `furry`.
pub fn single(folder: &Path, inputs: &[&str]) -> BTreeMap<PathBuf, Vec<u8>> {
    let out = tempfile::tempdir().unwrap();
    let bake = |input: &&str| {
        let path = out.path().join("out.glb");
        succeeds(
            furrier(&["bake"]).arg(folder.join(input)).arg("-o").arg(&path).args(small()).args(["--threads", "1"]),
        );
        (Path::new(input).with_extension("glb"), std::fs::read(path).unwrap())
    };
    inputs.iter().map(bake).collect()
}
