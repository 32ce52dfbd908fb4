//! Levels of detail in a scene: meshes beside each other that stand for one thing.

use super::document::Document;
use super::extension::is_fallback;
use super::json::At;
use crate::error::Result;
use std::collections::BTreeMap;

/// The node above, and the name without its level, in small letters.
type Name = (Option<usize>, String);

/// Which nodes show a coarser level of something that another node shows finer.
#[derive(Clone, Debug, Default)]
pub struct Levels {
    /// Per node: the level of detail that it, or a node above it, shows; 0 is the finest.
    pub level: Vec<u32>,
    /// Per node: whether it is in a scene for MSFT_lod alone, which shows it, or a node above it, in place of another.
    pub linked: Vec<bool>,
    /// The names of a finest level and of those that stand for it from afar.
    pub groups: Vec<(String, Vec<String>)>,
}

impl Levels {
    /// Looks for names such as `Beast_LOD1`, and for MSFT_lod, among the nodes that are `shown`. `order` has parents before
    /// children.
    ///
    /// # Errors
    /// Names what MSFT_lod points at that is not there.
    pub fn of(
        nodes: &[At<'_>],
        document: &Document,
        parent: &[Option<usize>],
        (order, shown): (&[usize], &[usize]),
    ) -> Result<Self> {
        let mut levels = Self { level: vec![0; nodes.len()], linked: vec![false; nodes.len()], groups: Vec::new() };
        // Nodes with something to see, at or below them: an empty one is no level, nor are shells.
        let mut visible = vec![false; nodes.len()];
        for &node in order.iter().rev() {
            visible[node] |= has_mesh(&nodes[node], document);
            if let (true, Some(above)) = (visible[node], parent[node]) {
                visible[above] = true;
            }
        }
        // What stands side by side has one name but for the level.
        let mut groups: BTreeMap<Name, Vec<(u32, usize)>> = BTreeMap::new();
        for &node in shown.iter().filter(|&&node| visible[node]) {
            if let Some((stem, level)) = names_of(&nodes[node], document).iter().find_map(|name| level_of(name)) {
                // A name that is nothing but a level means something beside its siblings alone.
                let beside = if stem.is_empty() { parent[node] } else { None };
                groups.entry((beside, stem.to_lowercase())).or_default().push((level, node));
            }
        }
        for mut group in groups.into_values() {
            group.sort_unstable();
            group.dedup();
            let mut numbers: Vec<u32> = group.iter().map(|(number, _)| *number).collect();
            numbers.dedup();
            let rank = |number: u32| numbers.partition_point(|&other| other < number) as u32;
            let coarser: Vec<(usize, u32)> =
                group.iter().map(|&(number, node)| (node, rank(number))).filter(|(_, level)| *level > 0).collect();
            levels.add(group[0].1, &coarser, nodes, document);
        }
        for &node in shown {
            let Some(lod) = nodes[node].get("extensions").and_then(|e| e.get("MSFT_lod")) else { continue };
            let ids =
                lod.list("ids")?.iter().map(|id| id.index_into("nodes", nodes.len())).collect::<Result<Vec<_>>>()?;
            ids.iter().for_each(|&id| levels.linked[id] = true);
            let new: Vec<(usize, u32)> = ids.into_iter().zip(1..).filter(|&(id, _)| levels.level[id] == 0).collect();
            levels.add(node, &new, nodes, document);
        }
        for &node in order {
            if let Some(above) = parent[node] {
                levels.level[node] = levels.level[node].max(levels.level[above]);
                levels.linked[node] |= levels.linked[above];
            }
        }
        Ok(levels)
    }

    fn add(&mut self, finest: usize, coarser: &[(usize, u32)], nodes: &[At<'_>], document: &Document) {
        let name = |node: usize| {
            let names = names_of(&nodes[node], document);
            let told = names.iter().find(|name| level_of(name).is_some()).or(names.first()).cloned();
            told.unwrap_or_else(|| format!("nodes[{node}]"))
        };
        coarser.iter().for_each(|&(node, level)| self.level[node] = level);
        if !coarser.is_empty() {
            self.groups.push((name(finest), coarser.iter().map(|&(node, _)| name(node)).collect()));
        }
    }
}

/// Whether a node shows a mesh that is no shell of a coat.
fn has_mesh(node: &At<'_>, document: &Document) -> bool {
    let mesh = node.get("mesh").and_then(|mesh| mesh.size().ok());
    mesh.and_then(|mesh| document.root().entry("meshes", mesh).ok()).is_some_and(|mesh| !is_fallback(&mesh))
}

/// A node's name and that of its mesh, where they have any.
fn names_of(node: &At<'_>, document: &Document) -> Vec<String> {
    let text =
        |at: &At<'_>| at.get("name").and_then(|name| name.value.as_str()).filter(|n| !n.is_empty()).map(str::to_owned);
    let of_mesh = || text(&document.root().entry("meshes", node.get("mesh")?.size().ok()?).ok()?);
    text(node).into_iter().chain(of_mesh()).collect()
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
