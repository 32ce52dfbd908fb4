//! What an input says of itself before it is read: which files it names, and how much it is. Nothing is checked here; what is wrong
//! with a file is said by [`super::load`].

use super::{glb, uri};
use serde_json::Value;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// What a file says of itself.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Glimpse {
    /// Files that it names, below its folder: buffers, images, material libraries. They may not be there.
    pub references: Vec<PathBuf>,
    /// Triangles of all its primitives, as far as it tells.
    pub triangles: u64,
}

/// Most bytes of JSON that are looked at.
const MOST_JSON: u64 = 256 << 20;

/// Looks at a file without reading its buffers.
pub fn glimpse(path: &Path) -> Glimpse {
    let mut found = if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("obj")) {
        of_obj(path)
    } else {
        json_of(path).map(|json| of_json(&json, path)).unwrap_or_default()
    };
    found.references.sort();
    found.references.dedup();
    found
}

/// The JSON of a .glb or .gltf file.
fn json_of(path: &Path) -> Option<Value> {
    let mut file = File::open(path).ok()?;
    let mut start = Vec::new();
    file.by_ref().take(glb::BEFORE_JSON).read_to_end(&mut start).ok()?;
    let mut text = Vec::new();
    match glb::json_length(&start) {
        Some(length) => file.take(length.min(MOST_JSON)).read_to_end(&mut text).ok()?,
        None => {
            text = start;
            file.take(MOST_JSON).read_to_end(&mut text).ok()?
        }
    };
    serde_json::from_slice(text.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(&text)).ok()
}

fn of_json(json: &Value, path: &Path) -> Glimpse {
    let list = |value: &Value, key: &str| value[key].as_array().cloned().unwrap_or_default();
    let named = ["buffers", "images"].into_iter().flat_map(|key| list(json, key));
    let references = named.filter_map(|entry| below(entry["uri"].as_str()?, path)).collect();
    let accessors = list(json, "accessors");
    let count = |accessor: &Value| accessors.get(accessor.as_u64()? as usize)?["count"].as_u64();
    let primitives = list(json, "meshes").into_iter().flat_map(|mesh| list(&mesh, "primitives"));
    let triangles = primitives
        .filter_map(|primitive| {
            let corners = count(&primitive["indices"]).or_else(|| count(&primitive["attributes"]["POSITION"]))?;
            Some(match primitive["mode"].as_u64() {
                None | Some(4) => corners / 3,
                Some(5 | 6) => corners.saturating_sub(2),
                _ => 0,
            })
        })
        .fold(0, u64::saturating_add);
    Glimpse { references, triangles }
}

fn of_obj(path: &Path) -> Glimpse {
    let Ok(bytes) = uri::read_file(path) else { return Glimpse::default() };
    let text = String::from_utf8_lossy(&bytes);
    let mut found = Glimpse::default();
    for line in text.lines().map(str::trim_start) {
        if let Some(corners) = line.strip_prefix("f ") {
            found.triangles += corners.split_whitespace().count().saturating_sub(2) as u64;
        } else if let Some(library) = line.strip_prefix("mtllib ").and_then(|name| below(name.trim(), path)) {
            let materials = uri::read_file(&library).unwrap_or_default();
            let materials = String::from_utf8_lossy(&materials);
            let pictures = materials.lines().filter_map(|line| line.trim().strip_prefix("map_Kd "));
            // As the reader has it: options come before the name.
            found.references.extend(pictures.filter_map(|name| {
                let name = name.trim();
                let name = if name.starts_with('-') { name.rsplit(' ').next()? } else { name };
                below(name, path)
            }));
            found.references.push(library);
        }
    }
    found
}

/// The file that a URI names, where it is one below the input's folder.
fn below(uri: &str, input: &Path) -> Option<PathBuf> {
    let folder = input.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    match uri::resolve(uri, Some(folder), "uri") {
        Ok(uri::Target::File(path)) => Some(path),
        _ => None,
    }
}
