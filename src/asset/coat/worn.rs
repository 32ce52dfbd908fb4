//! What of a coat a file wears, also where a program has dropped the extension and kept the rest.

use super::NAME;
use crate::asset::Asset;
use crate::asset::document::Document;
use crate::asset::extension::is_fallback;
use crate::error::{Error, Result};
use serde_json::Value;
use std::collections::HashMap;

/// Traces of a coat in a document.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Worn {
    /// Whether the extension is there, in the document or one of its primitives.
    pub extension: bool,
    /// Whether the copy in the document's extras is there.
    pub extras: bool,
    /// Meshes of fallback shells, by their mark or their names.
    pub shells: Vec<usize>,
}

impl Worn {
    /// What `document` wears.
    pub fn of(document: &Document) -> Self {
        let json = &document.json;
        let carries = |owner: &Value| owner["extensions"].get(NAME).is_some();
        let list = |owner: &'static str| json[owner].as_array().map(Vec::as_slice).unwrap_or_default();
        let in_primitive = |mesh: &Value| mesh["primitives"].as_array().into_iter().flatten().any(carries);
        // Whether all nodes that show a mesh are called as shells are.
        let mut by_nodes: HashMap<u64, bool> = HashMap::new();
        for node in list("nodes") {
            if let Some(mesh) = node["mesh"].as_u64() {
                *by_nodes.entry(mesh).or_insert(true) &= is_shells(node);
            }
        }
        let root = document.root();
        let mut shells = Vec::new();
        for (index, mesh) in list("meshes").iter().enumerate() {
            let marked = root.entry("meshes", index).is_ok_and(|at| is_fallback(&at));
            let by_nodes = by_nodes.get(&(index as u64)) == Some(&true);
            let of_shell = |primitive: &Value| {
                let material = primitive["material"].as_u64().and_then(|m| list("materials").get(m as usize));
                material.is_some_and(is_shells)
            };
            let mut primitives = mesh["primitives"].as_array().into_iter().flatten().peekable();
            let by_materials = primitives.peek().is_some() && primitives.all(of_shell);
            // Of a furred mesh, only the extension is the coat's.
            if !in_primitive(mesh) && (marked || is_shells(mesh) || by_nodes || by_materials) {
                shells.push(index);
            }
        }
        Self {
            extension: carries(json) || list("meshes").iter().any(in_primitive),
            extras: json["extras"].get(NAME).is_some(),
            shells,
        }
    }

    /// Whether there is no trace of a coat.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// What was found, in words.
    fn told(&self, document: &Document) -> String {
        let shells: Vec<&str> =
            self.shells.iter().filter_map(|&mesh| document.json["meshes"][mesh]["name"].as_str()).collect();
        let shells = match (self.shells.len(), &shells[..]) {
            (0, _) => None,
            (n, []) => Some(format!("{n} meshes of shells")),
            (_, names) => Some(format!("shells: {}", names.join(", "))),
        };
        let parts = [
            self.extension.then(|| format!("the extension {NAME}")),
            self.extras.then(|| format!("extras.{NAME}")),
            shells,
        ];
        parts.into_iter().flatten().collect::<Vec<_>>().join("; ")
    }
}

/// Whether a node, mesh or material is called as shells of the fallback are. Programs replace spaces by underscores and add
/// numbers.
pub fn is_shells(named: &Value) -> bool {
    let name = named["name"].as_str().unwrap_or_default().replace('_', " ");
    let name = name.trim_end_matches(|c: char| c.is_ascii_digit() || c == '.' || c == ' ');
    name.ends_with(" fur shells") || name.ends_with(" fur shell")
}

/// Fails where the asset wears a coat already, or what is left of one: worth asking before a long bake.
///
/// # Errors
/// Names what was found.
pub fn refuse_second(asset: &Asset) -> Result<()> {
    let worn = Worn::of(&asset.document);
    if worn.is_none() {
        return Ok(());
    }
    let field = match &worn {
        Worn { extension: true, .. } => format!("extensions.{NAME}"),
        Worn { extras: true, .. } => format!("extras.{NAME}"),
        Worn { shells, .. } => format!("meshes[{}]", shells[0]),
    };
    Err(Error::input("the input wears a coat already, or what another program left of one")
        .with_file(&asset.document.name)
        .with_field(field)
        .with_found(worn.told(&asset.document))
        .with_expected("an asset without a coat")
        .with_hint("`furrier strip IN -o OUT` takes it off; with `rebake`, `furrier bake` takes it off and bakes"))
}
