//! The floors: a file imports only from a lower floor or from its own folder, never from a sibling on its own floor. And the
//! sizes: no file is long, and most are short.

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
    ("stage", 2),
    ("cache", 3),
    ("fur", 3),
    ("volume", 4),
    ("cast", 5),
    ("hybrid", 5),
    ("reference", 5),
    ("runtime", 5),
    ("coat", 6),
    ("preset", 7),
    ("bake", 8),
    ("batch", 9),
    ("report", 9),
    ("viewer", 9),
    ("window", 10),
    ("cli", 11),
    ("main", 12),
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

/// What `text` imports from the crate: line number and the first segment of each path. Names that start with a capital are
/// the crate's own public face.
fn imports(path: &str, text: &str) -> Vec<(usize, String)> {
    let mut found: Vec<(usize, String)> =
        absolute(path, text).into_iter().map(|(line, mut segments)| (line, segments.swap_remove(0))).collect();
    found.retain(|(_, head)| head.starts_with(|c: char| c.is_lowercase()));
    found.sort();
    found.dedup();
    found
}

/// The paths that `text` imports from the crate, from its root on, by segments.
pub fn paths(path: &str, text: &str) -> Vec<Vec<String>> {
    absolute(path, text).into_iter().map(|(_, segments)| segments).collect()
}

/// Line number and segments from the crate's root on of each path into the crate. Comments and strings are no imports;
/// `use crate::{a, b::c}` counts each branch; `super` leads up from the file's own module.
fn absolute(path: &str, text: &str) -> Vec<(usize, Vec<String>)> {
    let code = without_comments_and_strings(text);
    let own: Vec<&str> = path.split('/').take(module_depth(path)).map(|s| s.trim_end_matches(".rs")).collect();
    let mut found = Vec::new();
    for root in ["crate::", "furrier::", "super::"] {
        for (at, _) in code.match_indices(root) {
            if code[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == ':') {
                continue;
            }
            let line = 1 + code[..at].matches('\n').count();
            let mut rest = &code[at + root.len()..];
            let mut up = usize::from(root == "super::");
            while let Some(further) = rest.strip_prefix("super::") {
                (rest, up) = (further, up + 1);
            }
            let above = if root == "super::" { own.len().saturating_sub(up) } else { 0 };
            for branch in branches(rest) {
                let segments: Vec<String> = own[..above].iter().map(|s| (*s).to_owned()).chain(branch).collect();
                if !segments.is_empty() {
                    found.push((line, segments));
                }
            }
        }
    }
    found
}

/// How many `super::` lead from a module to the crate's root.
fn module_depth(path: &str) -> usize {
    let segments = path.split('/').count();
    if path.ends_with("/mod.rs") || matches!(path, "lib.rs" | "main.rs") { segments - 1 } else { segments }
}

/// The paths of a use tree: one for `a::b`, several for `{a, b::{c, d}}`.
fn branches(tree: &str) -> Vec<Vec<String>> {
    let tree = tree.trim_start();
    if let Some(inner) = tree.strip_prefix('{') {
        let (mut level, mut begin, mut found) = (0, 0, Vec::new());
        for (at, c) in inner.char_indices() {
            match c {
                '{' => level += 1,
                ',' | '}' if level == 0 => {
                    found.extend(branches(&inner[begin..at]).into_iter().filter(|branch| !branch.is_empty()));
                    begin = at + 1;
                    if c == '}' {
                        break;
                    }
                }
                '}' => level -= 1,
                _ => {}
            }
        }
        return found;
    }
    let name: String = tree.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
    let rest = &tree[name.len()..];
    let further = match rest.strip_prefix("::") {
        Some(rest) if !name.is_empty() => branches(rest),
        _ => vec![Vec::new()],
    };
    let own = Some(name).filter(|name| !name.is_empty() && name != "self");
    further.into_iter().map(|branch| own.iter().cloned().chain(branch).collect()).collect()
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

/// Lines that a file may have.
const MOST_LINES: usize = 400;

/// Lines that the median file of `src` may have.
const MEDIAN_LINES: usize = 120;

/// The files that have more than [`MOST_LINES`] lines, one line each, sorted.
pub fn too_long(files: &[(String, String)]) -> Vec<String> {
    let mut found: Vec<String> = files
        .iter()
        .map(|(path, text)| (path, text.lines().count()))
        .filter(|&(_, lines)| lines > MOST_LINES)
        .map(|(path, lines)| format!("{path}: {lines} lines, {MOST_LINES} at most"))
        .collect();
    found.sort();
    found
}

/// Lines of the median file, the longer one of the middle two.
pub fn median_lines(files: &[(String, String)]) -> usize {
    let mut lines: Vec<usize> = files.iter().map(|(_, text)| text.lines().count()).collect();
    lines.sort_unstable();
    lines[lines.len() / 2]
}

/// Every Rust file below `folder`, with its path relative to it.
pub fn sources(folder: &Path) -> Vec<(String, String)> {
    written(folder, &["rs"])
}

/// Every file below `folder` whose name has one of these `endings`, with its path relative to it. What npm installs is
/// left out.
fn written(folder: &Path, endings: &[&str]) -> Vec<(String, String)> {
    let mut found = Vec::new();
    let mut open = vec![folder.to_owned()];
    while let Some(dir) = open.pop() {
        for entry in std::fs::read_dir(&dir).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.extend(Some(path).filter(|path| !path.ends_with("node_modules")));
            } else if path.extension().is_some_and(|e| endings.iter().any(|ending| e == *ending)) {
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
fn no_file_is_long_and_the_median_of_the_source_is_short() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let files: Vec<(String, String)> = ["src", "shaders", "tests", "benches"]
        .iter()
        .flat_map(|folder| {
            let files = written(&root.join(folder), &["rs", "wgsl", "mjs"]);
            assert!(!files.is_empty(), "no file found in {folder}/");
            files.into_iter().map(move |(path, text)| (format!("{folder}/{path}"), text))
        })
        .collect();
    let long = too_long(&files);
    assert!(long.is_empty(), "{}", long.join("\n"));
    let median = median_lines(&sources(&root.join("src")));
    assert!(median <= MEDIAN_LINES, "the median file of src/ has {median} lines, {MEDIAN_LINES} at most");
}

#[test]
fn raw_text_is_no_import() {
    let text = "// use crate::cli;\nconst S: &str = \"crate::cli::run \\\" crate::bake\"; /* crate::bake */ use crate::math::Vec3;";
    assert_eq!(imports("data/mesh.rs", text), [(2, "math".to_owned())]);
}

/// Lines of `text`, code or comment, that name a flag of the command line.
fn flags_named(text: &str) -> Vec<&str> {
    let names = |line: &&str| {
        let after = |(at, _): (usize, &str)| line[at + 2..].starts_with(|c: char| c.is_ascii_lowercase());
        let before = |(at, _): (usize, &str)| !line[..at].ends_with(|c: char| c.is_alphanumeric() || c == '-');
        line.match_indices("--").any(|found| after(found) && before(found))
    };
    text.lines().filter(names).collect()
}

#[test]
fn flags_are_named_by_the_command_line_alone() {
    let files = sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"));
    for (path, text) in files.iter().filter(|(path, _)| unit_of(path) != "cli") {
        assert_eq!(flags_named(text), Vec::<&str>::new(), "{path}");
    }
    let text = "a -- b\nx --y\nsize--;\n.with_field(\"--size\")\n// `--size` says";
    assert_eq!(flags_named(text), ["x --y", ".with_field(\"--size\")", "// `--size` says"]);
}

/// A value that one function leaves for another belongs in what they pass each other.
#[test]
fn nothing_is_passed_through_a_thread() {
    for (path, text) in sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src")) {
        assert!(!text.contains("thread_local!"), "{path}");
    }
}
