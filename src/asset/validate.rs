//! Checks a whole document once: every reference points at something, every accessor lies in its buffer, the nodes
//! form trees. What is written back with a coat must at least be sound itself.

use super::accessor::AccessorLayout;
use super::document::Document;
use super::json::At;
use crate::error::{Error, Result};

/// Lists that other objects point into.
const LISTS: [&str; 13] = [
    "accessors",
    "animations",
    "buffers",
    "bufferViews",
    "cameras",
    "images",
    "materials",
    "meshes",
    "nodes",
    "samplers",
    "scenes",
    "skins",
    "textures",
];

/// Texture slots of a material.
const SLOTS: [&str; 3] = ["normalTexture", "occlusionTexture", "emissiveTexture"];

/// Checks `document`.
///
/// # Errors
/// Names the first field that points nowhere or contradicts the data.
pub fn document(document: &Document) -> Result<()> {
    let root = document.root();
    for list in LISTS {
        for entry in root.list(list)? {
            if !entry.value.is_object() {
                return Err(entry.fault("an object"));
            }
        }
    }
    let check = Check { document };
    check.reference(&root, "scene", "scenes")?;
    for index in 0..document.count("accessors") {
        AccessorLayout::of(document, index)?;
    }
    for scene in root.list("scenes")? {
        check.references(&scene, "nodes", "nodes")?;
    }
    nodes(&check, &root)?;
    for mesh in root.list("meshes")? {
        for primitive in mesh.list("primitives")? {
            check.primitive(&primitive)?;
        }
    }
    for material in root.list("materials")? {
        let metallic = material.get("pbrMetallicRoughness");
        let inner = metallic.iter().flat_map(|m| [m.get("baseColorTexture"), m.get("metallicRoughnessTexture")]);
        for slot in inner.chain(SLOTS.iter().map(|slot| material.get(slot))).flatten() {
            check.reference(&slot, "index", "textures")?;
            slot.size_or("texCoord", 0)?;
        }
    }
    for texture in root.list("textures")? {
        check.reference(&texture, "source", "images")?;
        check.reference(&texture, "sampler", "samplers")?;
    }
    for image in root.list("images")? {
        check.reference(&image, "bufferView", "bufferViews")?;
    }
    for skin in root.list("skins")? {
        check.skin(&skin)?;
    }
    for animation in root.list("animations")? {
        check.animation(&animation)?;
    }
    Ok(())
}

struct Check<'a> {
    document: &'a Document,
}

impl Check<'_> {
    fn reference(&self, owner: &At<'_>, key: &str, list: &str) -> Result<Option<usize>> {
        owner.reference(key, list, self.document.count(list))
    }

    fn references(&self, owner: &At<'_>, key: &str, list: &str) -> Result<Vec<usize>> {
        owner.list(key)?.iter().map(|at| at.index_into(list, self.document.count(list))).collect()
    }

    fn primitive(&self, primitive: &At<'_>) -> Result<()> {
        self.reference(primitive, "indices", "accessors")?;
        self.reference(primitive, "material", "materials")?;
        let attributes = primitive.need("attributes")?;
        let mut lists = vec![attributes];
        lists.extend(primitive.list("targets")?);
        let mut vertices = None;
        for (name, at) in lists.iter().map(At::members).collect::<Result<Vec<_>>>()?.into_iter().flatten() {
            let index = at.index_into("accessors", self.document.count("accessors"))?;
            let count = AccessorLayout::of(self.document, index)?.count;
            let expected = *vertices.get_or_insert(count);
            if count != expected {
                return Err(Error::input("the attributes of a primitive differ in length")
                    .with_field(at.path)
                    .with_found(format!("{count} elements in {name}"))
                    .with_expected(format!("{expected}, as in the first attribute")));
            }
        }
        Ok(())
    }

    fn skin(&self, skin: &At<'_>) -> Result<()> {
        let joints = self.references(skin, "joints", "nodes")?;
        self.reference(skin, "skeleton", "nodes")?;
        if joints.is_empty() {
            return Err(skin.fault("at least one joint"));
        }
        let Some(index) = self.reference(skin, "inverseBindMatrices", "accessors")? else { return Ok(()) };
        let matrices = self.document.floats(index, 16)?;
        let at = skin.need("inverseBindMatrices")?;
        if matrices.len() < 16 * joints.len() {
            return Err(at.fault(&format!("an accessor of {} matrices, one per joint", joints.len())));
        }
        if matrices.iter().any(|m| !m.is_finite()) {
            return Err(at.fault("matrices of finite numbers"));
        }
        Ok(())
    }

    fn animation(&self, animation: &At<'_>) -> Result<()> {
        let samplers = animation.list("samplers")?;
        for sampler in &samplers {
            for key in ["input", "output"] {
                sampler.need(key)?.index_into("accessors", self.document.count("accessors"))?;
            }
        }
        for channel in animation.list("channels")? {
            channel.need("sampler")?.index_into("samplers", samplers.len())?;
            let target = channel.need("target")?;
            self.reference(&target, "node", "nodes")?;
            target.need("path")?.text()?;
        }
        Ok(())
    }
}

/// Node references, and that every node has at most one parent and no ancestor that is itself.
fn nodes(check: &Check<'_>, root: &At<'_>) -> Result<()> {
    let nodes = root.list("nodes")?;
    let mut parent = vec![None; nodes.len()];
    for (i, node) in nodes.iter().enumerate() {
        for (key, list) in [("mesh", "meshes"), ("skin", "skins"), ("camera", "cameras")] {
            check.reference(node, key, list)?;
        }
        for child in check.references(node, "children", "nodes")? {
            if let Some(other) = parent[child].replace(i) {
                return Err(node.fault(&format!(
                    "no child in common with nodes[{other}]: nodes[{child}] can have one parent only"
                )));
            }
        }
    }
    // With one parent at most, whatever cannot be reached from a root lies on a cycle or below one.
    let mut reached: Vec<usize> = (0..nodes.len()).filter(|&i| parent[i].is_none()).collect();
    let mut next = 0;
    while let Some(&i) = reached.get(next) {
        reached.extend(check.references(&nodes[i], "children", "nodes")?);
        next += 1;
    }
    if reached.len() == nodes.len() {
        return Ok(());
    }
    reached.sort_unstable();
    let lost = (0..nodes.len()).find(|i| reached.binary_search(i).is_err()).unwrap_or_default();
    Err(Error::input("the node graph has a cycle")
        .with_field(format!("nodes[{lost}].children"))
        .with_found(format!("nodes[{lost}] on a cycle, or below one"))
        .with_expected("trees")
        .with_hint("the file was written by a faulty exporter; export it again"))
}
