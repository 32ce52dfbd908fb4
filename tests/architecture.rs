//! The floors: a file imports only from a lower floor or from its own folder, never from a sibling on its own floor.

use std::collections::BTreeMap;
use std::path::Path;

/// The pipeline's folders and files, and the floor each stands on. A new one is entered here on purpose.
const FLOORS: &[(&str, u32)] = &[
    ("error", 0),
    ("math", 0),
    ("data", 1),
    ("asset", 2),
    ("gpu", 2),
    ("metrics", 2),
    ("shade", 2),
    ("fur", 3),
    ("render", 4),
    ("runtime", 4),
    ("coat", 5),
    ("preset", 6),
    ("bake", 7),
    ("batch", 8),
    ("report", 8),
    ("viewer", 8),
    ("cli", 9),
    ("main", 10),
];

/// `error` serves every floor, the ground floor included.
const EVERYWHERE: &str = "error";

/// Every import in `files` (path below `src`, text) that breaks the floors, one line each, sorted.
///
/// Names of the crate's own public face (`crate::Result`, `furrier::Error`) start with a capital and are passed over;
/// a folder that [`FLOORS`] does not know is a breach.
pub fn breaches(files: &[(String, String)]) -> Vec<String> {
    let floors: BTreeMap<&str, u32> = FLOORS.iter().copied().collect();
    let mut found = Vec::new();
    for (path, text) in files {
        let own = unit_of(path);
        if own == "lib" {
            continue;
        }
        let Some(own_floor) = floors.get(own) else {
            found.push(format!("{path}: `{own}` stands on no floor of tests/architecture.rs"));
            continue;
        };
        for (line, target) in imports(path, text) {
            let reason = match floors.get(target.as_str()) {
                _ if target == own || target == EVERYWHERE => continue,
                Some(floor) if floor < own_floor => continue,
                Some(floor) => format!("floor {own_floor} imports `{target}` of floor {floor}"),
                None => format!("imports `{target}`, which stands on no floor of tests/architecture.rs"),
            };
            found.push(format!("{path}:{line}: {reason}"));
        }
    }
    found.sort();
    found
}

/// The folder or file directly below `src` that `path` belongs to.
fn unit_of(path: &str) -> &str {
    path.split('/').next().unwrap_or(path).trim_end_matches(".rs")
}

/// What `text` imports from the crate: line number and the first segment of each path. Comments and strings are no
/// imports; `use crate::{a, b::c}` counts each branch; `super` beyond the file's own folder counts as `crate`.
fn imports(path: &str, text: &str) -> Vec<(usize, String)> {
    let code = without_comments_and_strings(text);
    let depth = module_depth(path);
    let up = "super::".repeat(depth);
    let mut found = Vec::new();
    for prefix in ["crate::", "furrier::", up.as_str()].into_iter().filter(|p| !p.is_empty()) {
        for (at, _) in code.match_indices(prefix) {
            let before = code[..at].chars().next_back();
            let climbs_on = prefix == up && code[at + prefix.len()..].starts_with("super::");
            if before.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == ':') || climbs_on {
                continue;
            }
            let line = 1 + code[..at].matches('\n').count();
            found.extend(heads(&code[at + prefix.len()..]).into_iter().map(|head| (line, head)));
        }
    }
    found.retain(|(_, head)| head.starts_with(|c: char| c.is_lowercase()) && head != "super" && head != "self");
    found
}

/// How many `super::` lead from a module to the crate's root.
fn module_depth(path: &str) -> usize {
    let segments = path.split('/').count();
    if path.ends_with("/mod.rs") { segments - 1 } else { segments }
}

/// First segments of a use tree: one for `a::b`, several for `{a, b::{c, d}}`.
fn heads(tree: &str) -> Vec<String> {
    let ident = |s: &str| s.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    let Some(inner) = tree.strip_prefix('{') else { return vec![ident(tree)] };
    let (mut level, mut fresh, mut found) = (0, true, Vec::new());
    for (at, c) in inner.char_indices() {
        match c {
            '{' => level += 1,
            '}' if level == 0 => break,
            '}' => level -= 1,
            ',' if level == 0 => fresh = true,
            c if fresh && (c.is_alphabetic() || c == '_') => {
                found.push(ident(&inner[at..]));
                fresh = false;
            }
            _ => {}
        }
    }
    found
}

/// `text` with comments and string literals blanked, line breaks kept.
fn without_comments_and_strings(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let skip = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            rest.find("*/").map_or(rest.len(), |end| end + 2)
        } else if c == '"' {
            string_end(rest)
        } else if rest.starts_with("'\"'") {
            3
        } else {
            out.push(c);
            rest = &rest[c.len_utf8()..];
            continue;
        };
        out.extend(rest[..skip].chars().filter(|&c| c == '\n'));
        out.push(' ');
        rest = &rest[skip..];
    }
    out
}

/// Length of the string literal that `text` begins with, quotes included.
fn string_end(text: &str) -> usize {
    let mut escaped = false;
    for (at, c) in text.char_indices().skip(1) {
        match c {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            '"' => return at + 1,
            _ => {}
        }
    }
    text.len()
}

/// Every Rust file below `folder`, with its path relative to it.
fn sources(folder: &Path) -> Vec<(String, String)> {
    let mut found = Vec::new();
    let mut open = vec![folder.to_owned()];
    while let Some(dir) = open.pop() {
        for entry in std::fs::read_dir(&dir).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                let name = path.strip_prefix(folder).unwrap().to_str().unwrap().replace('\\', "/");
                found.push((name, std::fs::read_to_string(&path).unwrap()));
            }
        }
    }
    found
}

#[test]
fn files_import_only_from_lower_floors() {
    let files = sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"));
    assert!(files.len() > 5, "only {} source files found", files.len());
    let breaches = breaches(&files);
    assert!(breaches.is_empty(), "{}", breaches.join("\n"));
}

#[test]
fn every_folder_of_the_architecture_page_has_its_floor() {
    let page = include_str!("../docs/architecture.md");
    for (name, floor) in FLOORS.iter().filter(|(name, _)| Path::new("src").join(name).exists()) {
        let row = page.lines().find(|l| l.starts_with(&format!("| `{name}/`"))).unwrap_or_else(|| {
            panic!("docs/architecture.md has no row for `{name}/`");
        });
        assert!(row.ends_with(&format!("| {floor} |")), "docs/architecture.md gives another floor than {floor}: {row}");
    }
}

#[test]
fn raw_text_is_no_import() {
    let text = "// use crate::cli;\nconst S: &str = \"crate::cli::run \\\" crate::bake\"; /* crate::bake */ use crate::math::Vec3;";
    assert_eq!(imports("data/mesh.rs", text), [(2, "math".to_owned())]);
}
