//! `furrier cache`, and what `furrier bake` does with a cache.

use crate::common::furrier_path;
use assert_cmd::Command;
use predicates::prelude::*;
use serde_json::Value;
use std::path::Path;

fn furrier(arguments: &[&str]) -> Command {
    let mut command = Command::new(furrier_path());
    command.args(arguments);
    command
}

/// Bakes a plane with a cache, and gives its report.
fn bake(folder: &Path, cache: &Path) -> Value {
    let report = folder.join("out.json");
    let mut command = furrier(&["bake", "sample:plane", "-q", "-o"]);
    command.arg(folder.join("out.glb")).arg("--report").arg(&report).args(crate::bake::SMALL).arg("--cache").arg(cache);
    command.assert().success();
    serde_json::from_slice(&std::fs::read(report).unwrap()).unwrap()
}

fn json(arguments: &[&str], cache: &Path) -> Value {
    let output = furrier(arguments).arg("--json").arg("--cache").arg(cache).assert().success().get_output().clone();
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn a_report_says_what_came_from_the_cache() {
    let folder = tempfile::tempdir().unwrap();
    let cache = folder.path().join("cache");
    let [cold, warm] = [bake(folder.path(), &cache), bake(folder.path(), &cache)];
    let steps = |report: &Value| {
        let steps = report["steps"].as_array().unwrap().iter();
        steps.map(|step| step["name"].as_str().unwrap().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(cold["cache"]["stages"]["tile"]["made"], 1);
    assert_eq!(
        (&warm["cache"]["stages"]["tile"]["found"], &warm["cache"]["stages"]["tile"]["made"]),
        (&1.into(), &0.into())
    );
    assert_eq!(warm["cache"]["folder"], cache.to_str().unwrap());
    assert!(steps(&cold).contains(&"tile".into()) && !steps(&warm).contains(&"tile".into()), "{:?}", steps(&warm));
    assert_eq!(cold["error"], warm["error"]);
}

#[test]
fn the_folder_comes_from_the_flag_the_environment_or_the_system() {
    let folder = tempfile::tempdir().unwrap();
    let [named, system] = ["named", "system"].map(|name| folder.path().join(name));
    let stat = || {
        let mut command = furrier(&["cache", "stat"]);
        command.env("XDG_CACHE_HOME", &system);
        command
    };
    stat().assert().code(2).stderr(predicate::str::contains("--cache"));
    let says = |path: &Path| predicate::str::starts_with(format!("{}: 0 values", path.display()));
    stat().env("FURRIER_CACHE", &named).assert().success().stdout(says(&named));
    stat().env("FURRIER_CACHE", &system).arg("--cache").arg(&named).assert().success().stdout(says(&named));
    if cfg!(target_os = "linux") {
        stat().env_remove("FURRIER_CACHE").assert().success().stdout(says(&system.join("furrier")));
    }
    assert!(!named.exists() && !system.exists(), "looking makes no folder");
    let mut without = furrier(&["bake", "sample:plane", "-q", "--no-cache", "-o"]);
    without.arg(folder.path().join("out.glb")).args(crate::bake::SMALL).env("FURRIER_CACHE", &named);
    without.assert().success();
    assert!(!named.exists(), "it was to keep nothing");
}

#[test]
fn a_cache_is_counted_verified_and_tidied() {
    let folder = tempfile::tempdir().unwrap();
    let cache = folder.path().join("cache");
    bake(folder.path(), &cache);
    let stat = json(&["cache", "stat"], &cache);
    let (values, bytes) = (stat["values"].as_u64().unwrap(), stat["bytes"].as_u64().unwrap());
    assert!(values > 2 && bytes > 100, "{stat}");
    assert_eq!((&stat["stages"]["tile"]["values"], &stat["of_other_builds"]), (&1.into(), &0.into()));
    furrier(&["cache", "stat"]).arg("--cache").arg(&cache).assert().success().stdout(predicate::str::contains("tile"));
    assert_eq!(json(&["cache", "verify"], &cache)["sound"], values);
    // A stage's only value, damaged.
    let tile = walk(&cache.join("tile")).pop().unwrap();
    let mut damaged = std::fs::read(&tile).unwrap();
    damaged[120] ^= 1;
    std::fs::write(&tile, damaged).unwrap();
    let verify = || {
        let mut command = furrier(&["cache", "verify"]);
        command.arg("--cache").arg(&cache);
        command
    };
    let named = predicate::str::contains(tile.to_str().unwrap().to_owned());
    verify().assert().code(3).stdout(named);
    verify().arg("--remove").assert().success();
    assert_eq!(json(&["cache", "verify"], &cache)["sound"], values - 1);
    let unlimited = furrier(&["cache", "gc"]).arg("--cache").arg(&cache).assert().code(2).get_output().clone();
    assert!(String::from_utf8_lossy(&unlimited.stderr).contains("--max-size"));
    assert_eq!(json(&["cache", "gc", "--max-size", "1GB", "--max-age", "30days"], &cache)["files"], 0);
    let gone = json(&["cache", "gc", "--max-size", "10B"], &cache);
    assert_eq!((&gone["files"], &gone["left_bytes"]), (&(values - 1).into(), &0.into()));
    bake(folder.path(), &cache);
    assert_eq!(json(&["cache", "clear"], &cache)["files"], values);
    assert_eq!(json(&["cache", "stat"], &cache)["values"], 0);
}

/// The files below a folder.
fn walk(folder: &Path) -> Vec<std::path::PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    entries.flat_map(|path| if path.is_dir() { walk(&path) } else { vec![path] }).collect()
}
