//! No circles inside folders: of the files and folders that lie side by side in one, none imports another that imports it,
//! directly or over others. `mod.rs` is the folder's door: it knows what lies behind it, and may be known to it.

use crate::architecture::{paths, sources};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// What imports what, side by side in a folder.
type Graph = BTreeMap<String, BTreeSet<String>>;

/// Circles among `files` (path below `src`, text), one line each, sorted: the folder and the way around.
pub fn circles(files: &[(String, String)]) -> Vec<String> {
    let modules: BTreeSet<Vec<&str>> = files.iter().map(|(path, _)| module(path)).collect();
    let mut folders: BTreeMap<String, Graph> = BTreeMap::new();
    for (path, text) in files {
        let own = module(path);
        for target in paths(path, text) {
            let target: Vec<&str> = target.iter().map(String::as_str).collect();
            // What is imported may be a module or lie in one.
            let Some(known) = (1..=target.len()).rev().find(|&n| modules.contains(&target[..n])) else { continue };
            let target = &target[..known];
            let shared = own.iter().zip(target).take_while(|(a, b)| a == b).count();
            // Whoever is a folder's `mod.rs`, or imports from it, is no neighbour in it.
            if shared == own.len() || shared == target.len() {
                continue;
            }
            let folder = folders.entry(own[..shared].join("/")).or_default();
            folder.entry(own[shared].to_owned()).or_default().insert(target[shared].to_owned());
        }
    }
    let mut found = Vec::new();
    for (folder, graph) in &folders {
        if let Some(way) = circle(graph) {
            found.push(format!("{folder}/: {}", way.join(" -> ")));
        }
    }
    found
}

/// The module of a file, as path segments; `a/mod.rs` is `a`.
fn module(path: &str) -> Vec<&str> {
    let path = path.trim_end_matches(".rs");
    path.strip_suffix("/mod").unwrap_or(path).split('/').collect()
}

/// A way from somewhere back to it: what nothing in the graph leads out of is taken away until only circles are left.
fn circle(graph: &Graph) -> Option<Vec<String>> {
    let mut left = graph.clone();
    loop {
        let names: BTreeSet<String> = left.keys().cloned().collect();
        left.values_mut().for_each(|targets| targets.retain(|target| names.contains(target)));
        let before = left.len();
        left.retain(|_, targets| !targets.is_empty());
        if left.len() == before {
            break;
        }
    }
    let mut way = vec![left.keys().next()?.clone()];
    loop {
        let next = left[way.last()?].first()?.clone();
        if let Some(at) = way.iter().position(|name| *name == next) {
            way.push(next);
            return Some(way.split_off(at));
        }
        way.push(next);
    }
}

#[test]
fn no_files_of_a_folder_import_each_other() {
    let files = sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"));
    let circles = circles(&files);
    assert!(circles.is_empty(), "{}", circles.join("\n"));
}
