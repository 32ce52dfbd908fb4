//! Levels of detail in a scene: meshes beside each other that stand for one thing.

use super::document::Document;
use super::json::At;
use crate::error::Result;
use std::collections::BTreeMap;

/// The node above, and the name without its level.
type Name = (Option<usize>, String);

/// Which nodes show a coarser level of something that another node shows finer, and what to tell of it.
#[derive(Clone, Debug, Default)]
pub struct Levels {
    /// Per node: whether it, or a node above it, is a coarser level.
    pub coarser: Vec<bool>,
    /// One sentence each.
    pub notes: Vec<String>,
}

impl Levels {
    /// Looks for names such as `Beast_LOD1`, and for MSFT_lod. `order` has parents before children.
    ///
    /// # Errors
    /// Names what MSFT_lod points at that is not there.
    pub fn of(nodes: &[At<'_>], document: &Document, parent: &[Option<usize>], order: &[usize]) -> Result<Self> {
        let mut levels = Self { coarser: vec![false; nodes.len()], notes: Vec::new() };
        // What stands side by side has one name but for the level.
        let mut groups: BTreeMap<Name, Vec<(u32, usize)>> = BTreeMap::new();
        for (node, at) in nodes.iter().enumerate() {
            if let Some((stem, level)) = name_of(at, document).as_deref().and_then(level_of) {
                // A name that is nothing but a level means something beside its siblings alone.
                let beside = if stem.is_empty() { parent[node] } else { None };
                groups.entry((beside, stem)).or_default().push((level, node));
            }
        }
        for group in groups.values() {
            let Some(&(finest, node)) = group.iter().min() else { continue };
            let coarser: Vec<usize> =
                group.iter().filter(|(level, _)| *level > finest).map(|(_, node)| *node).collect();
            levels.leave_out(&coarser, node, nodes, document);
        }
        for (node, at) in nodes.iter().enumerate() {
            let Some(lod) = at.get("extensions").and_then(|e| e.get("MSFT_lod")) else { continue };
            let ids =
                lod.list("ids")?.iter().map(|id| id.index_into("nodes", nodes.len())).collect::<Result<Vec<_>>>()?;
            let new: Vec<usize> = ids.into_iter().filter(|&id| !levels.coarser[id]).collect();
            levels.leave_out(&new, node, nodes, document);
        }
        for &node in order {
            levels.coarser[node] |= parent[node].is_some_and(|above| levels.coarser[above]);
        }
        Ok(levels)
    }

    fn leave_out(&mut self, coarser: &[usize], finest: usize, nodes: &[At<'_>], document: &Document) {
        let name = |node: usize| name_of(&nodes[node], document).unwrap_or_else(|| format!("nodes[{node}]"));
        coarser.iter().for_each(|&node| self.coarser[node] = true);
        if !coarser.is_empty() {
            let names: Vec<String> = coarser.iter().map(|&node| name(node)).collect();
            self.notes.push(format!(
                "coarser levels of detail of {}, which alone is furred and drawn: {} stay as they are, without fur",
                name(finest),
                names.join(", ")
            ));
        }
    }
}

/// A node's name, or that of its mesh.
fn name_of(node: &At<'_>, document: &Document) -> Option<String> {
    let text =
        |at: &At<'_>| at.get("name").and_then(|name| name.value.as_str()).filter(|n| !n.is_empty()).map(str::to_owned);
    text(node).or_else(|| {
        let mesh = node.get("mesh")?.size().ok()?;
        text(&document.root().entry("meshes", mesh).ok()?)
    })
}

/// What a name says besides its level, and the level: `Beast_LOD1` is level 1 of `Beast`.
fn level_of(name: &str) -> Option<(String, u32)> {
    // Blender numbers things of one name.
    let numbered = |(_, number): &(&str, &str)| number.len() == 3 && number.chars().all(|c| c.is_ascii_digit());
    let name = name.rsplit_once('.').filter(numbered).map_or(name, |(name, _)| name);
    let lower = name.to_ascii_lowercase();
    let found = lower.match_indices("lod").find_map(|(at, token)| {
        let before = name[..at].chars().next_back();
        // `BeastLOD1` is one, `melod1` is not.
        let starts = before.is_none_or(|b| !b.is_alphabetic() || (b.is_lowercase() && name[at..].starts_with("LOD")));
        let rest = &name[at + token.len()..];
        let digits = rest.trim_start_matches(['_', '-', ' ', '.']);
        let end = digits.find(|c: char| !c.is_ascii_digit()).unwrap_or(digits.len());
        let ends = digits[end..].chars().next().is_none_or(|c| !c.is_alphanumeric());
        let level = digits[..end].parse().ok()?;
        (starts && ends).then(|| (format!("{}{}", &name[..at], &digits[end..]), level))
    });
    found.map(|(stem, level)| (stem.trim_matches(['_', '-', ' ', '.']).to_owned(), level))
}
