//! A coat taken off again.

use super::NAME;
use super::expressions;
use super::input::{Input, give_back};
use super::references::{known, visit};
use super::worn::{Worn, is_shells};
use crate::asset::document::Document;
use crate::error::{Error, Result};
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;

/// Lists that hold parts of a coat, each before those that it points into.
const LISTS: [&str; 8] = ["nodes", "meshes", "materials", "textures", "images", "samplers", "accessors", "bufferViews"];

/// A document without its coat.
#[derive(Clone, Debug)]
pub struct Stripped {
    /// What is left.
    pub document: Document,
    /// The bytes of the file that the coat was baked on, or why they are not there.
    pub input: Input,
    /// How many entries were taken out of each of the document's lists.
    pub removed: Vec<(&'static str, usize)>,
    /// What could not be taken out, one sentence each.
    pub notes: Vec<String>,
}

/// Takes the coat off a document, or what another program left of one.
///
/// # Errors
/// When there is none, or what it says of its input contradicts itself.
pub fn strip(document: &Document) -> Result<Stripped> {
    let worn = Worn::of(document);
    if worn.is_none() {
        return Err(Error::input("the file wears no coat, nor what another program left of one")
            .with_file(&document.name)
            .with_field(format!("extensions.{NAME}"))
            .with_found("nothing")
            .with_expected("a coat"));
    }
    let input = give_back(document).map_err(|error| error.with_file(&document.name))?;
    let mut bare = Bare::new(document.clone());
    bare.take_extension();
    bare.take_shells(&worn.shells);
    LISTS.iter().for_each(|list| bare.clear(list));
    bare.tidy();
    Ok(Stripped { document: bare.document, input, removed: bare.removed, notes: bare.notes })
}

/// The document to bake a new coat on: the input's own where the file is as it was baked, else what is left without the coat.
/// One without a coat stays as it is. What was done is added to `warnings`.
///
/// # Errors
/// As [`strip`] and [`Document::parse`].
pub fn bared(document: Document, warnings: &mut Vec<String>) -> Result<Document> {
    if Worn::of(&document).is_none() {
        return Ok(document);
    }
    let stripped = strip(&document)?;
    match stripped.input {
        Input::Whole(bytes) => {
            warnings.push("the input wore a coat, which was taken off: its own input came back".into());
            Document::parse(&bytes, &document.name, warnings)
        }
        Input::Lost(why) => {
            warnings.push(format!("the input wore a coat, which was taken off; its own input is not in it: {why}"));
            warnings.extend(stripped.notes);
            // As a file of its own: that is what a later strip gives back.
            Document::parse(&stripped.document.to_glb()?, &document.name, warnings)
        }
    }
}

/// A document while its coat is taken off.
struct Bare {
    document: Document,
    /// Entries that the coat uses or used: they go, unless something else uses them too.
    coats: Vec<(&'static str, usize)>,
    /// Whether the references of all its extensions are known, so that entries may change their places.
    known: bool,
    removed: Vec<(&'static str, usize)>,
    notes: Vec<String>,
}

impl Bare {
    fn new(mut document: Document) -> Self {
        let used = document.json.get_mut("extensionsUsed").and_then(Value::as_array_mut);
        let mut unknown = Vec::new();
        if let Some(used) = used {
            used.retain(|name| name != NAME);
            unknown.extend(used.iter().filter_map(Value::as_str).filter(|name| !known(name)).map(str::to_owned));
        }
        let mut notes = Vec::new();
        if !unknown.is_empty() {
            notes.push(format!(
                "what {} point to is not known: parts of the coat that stand before others stay in the file, unused",
                unknown.join(", ")
            ));
        }
        Self { document, coats: Vec::new(), known: unknown.is_empty(), removed: Vec::new(), notes }
    }

    /// Notes what `value`, no longer part of the document, pointed to.
    fn forget(&mut self, mut value: Value, top: &str) {
        visit(&mut value, top, &mut |list, index| {
            if let Some(index) = index.as_u64() {
                self.coats.push((list, index as usize));
            }
        });
    }

    /// Takes the extension off the document, its meshes and their primitives, and the copy off the extras.
    fn take_extension(&mut self) {
        let mut taken = Vec::new();
        let mut take = |owner: &mut Value, top| {
            if let Some(extension) = remove_member(owner, "extensions", NAME) {
                taken.push((extension, top));
            }
        };
        let json = &mut self.document.json;
        take(json, "extensions");
        for mesh in entries(json, "meshes") {
            take(mesh, "meshes");
            entries(mesh, "primitives").iter_mut().for_each(|primitive| take(primitive, "meshes"));
        }
        remove_member(json, "extras", NAME);
        taken.into_iter().for_each(|(value, top)| self.forget(value, top));
    }

    /// Has no node show these meshes. Nodes that do nothing else go.
    fn take_shells(&mut self, shells: &[usize]) {
        self.coats.extend(shells.iter().map(|&mesh| ("meshes", mesh)));
        let json = &mut self.document.json;
        // Of a tile that no shell shows, the materials are there all the same.
        let materials = entries(json, "materials").iter().enumerate().filter(|(_, material)| is_shells(material));
        self.coats.extend(materials.map(|(index, _)| ("materials", index)));
        let joints: BTreeSet<u64> = (entries(json, "skins").iter())
            .flat_map(|skin| skin["joints"].as_array().into_iter().flatten().chain(skin.get("skeleton")))
            .filter_map(Value::as_u64)
            .collect();
        let shown: BTreeSet<u64> = shells.iter().map(|&mesh| mesh as u64).collect();
        let mut gone = BTreeSet::new();
        for (index, node) in entries(json, "nodes").iter_mut().enumerate() {
            if !node["mesh"].as_u64().is_some_and(|mesh| shown.contains(&mesh)) {
                continue;
            }
            let leads_on = ["children", "camera"].iter().any(|key| node.get(key).is_some());
            if !leads_on && !joints.contains(&(index as u64)) {
                gone.insert(index as u64);
            }
            let called = is_shells(node);
            if let Some(node) = node.as_object_mut() {
                ["mesh", "skin", "weights"].iter().for_each(|key| drop(node.shift_remove(*key)));
                if called {
                    node.shift_remove("name");
                }
            }
        }
        for animation in entries(json, "animations") {
            let of_shells = |channel: &Value| channel["target"]["node"].as_u64().is_some_and(|n| gone.contains(&n));
            if let Some(channels) = animation["channels"].as_array_mut() {
                channels.retain(|channel| !of_shells(channel));
            }
        }
        drop_references(json, "", "", &gone, &shown);
        expressions::forget(json);
        self.coats.extend(gone.iter().map(|&node| ("nodes", node as usize)));
    }

    /// Takes those entries of `list` out that only the coat uses.
    fn clear(&mut self, list: &'static str) {
        let mut used = BTreeSet::new();
        visit(&mut self.document.json, "", &mut |to, index| {
            if to == list {
                used.extend(index.as_u64());
            }
        });
        let length = self.document.count(list);
        let mut gone: BTreeSet<usize> = (self.coats.iter())
            .filter(|(of, index)| *of == list && *index < length && !used.contains(&(*index as u64)))
            .map(|(_, index)| *index)
            .collect();
        if !self.known {
            let mut end = length;
            while end > 0 && gone.contains(&(end - 1)) {
                end -= 1;
            }
            gone.retain(|&index| index >= end);
        }
        if gone.is_empty() {
            return;
        }
        if list == "bufferViews" {
            super::ranges::cut(&mut self.document, &gone);
        }
        let json = &mut self.document.json;
        let (mut place, mut taken, mut places) = (0, Vec::new(), Vec::with_capacity(length));
        if let Some(entries) = json[list].as_array_mut() {
            for (index, entry) in std::mem::take(entries).into_iter().enumerate() {
                places.push(place);
                if gone.contains(&index) {
                    taken.push(entry);
                } else {
                    entries.push(entry);
                    place += 1;
                }
            }
        }
        // VRM 0 describes materials in a list of its own, in their order.
        if list == "materials"
            && let Some(of_vrm) = json.pointer_mut("/extensions/VRM/materialProperties").and_then(Value::as_array_mut)
            && of_vrm.len() == length
        {
            let mut index = 0..;
            of_vrm.retain(|_| index.next().is_none_or(|index| !gone.contains(&index)));
        }
        visit(json, "", &mut |to, index| {
            if let Some(new) = index.as_u64().filter(|_| to == list).and_then(|old| places.get(old as usize)) {
                *index = json!(new);
            }
        });
        self.removed.push((list, gone.len()));
        taken.into_iter().for_each(|entry| self.forget(entry, list));
    }

    /// Leaves no empty lists, which glTF does not allow.
    fn tidy(&mut self) {
        let json = &mut self.document.json;
        if let Some(animations) = json.get_mut("animations").and_then(Value::as_array_mut) {
            animations.retain(|animation| animation["channels"].as_array().is_none_or(|channels| !channels.is_empty()));
        }
        entries(json, "nodes").iter_mut().for_each(|node| drop_empty(node, "children"));
        entries(json, "scenes").iter_mut().for_each(|scene| drop_empty(scene, "nodes"));
        if self.document.binary.is_empty()
            && let Some(buffers) = json.get_mut("buffers").and_then(Value::as_array_mut)
        {
            buffers.clear();
        }
        for list in LISTS.iter().chain(&["animations", "buffers", "extensionsUsed"]) {
            drop_empty(json, list);
        }
    }
}

/// The entries of the array `key`.
fn entries<'a>(owner: &'a mut Value, key: &str) -> &'a mut [Value] {
    owner.get_mut(key).and_then(Value::as_array_mut).map(Vec::as_mut_slice).unwrap_or_default()
}

/// Takes `name` out of the object `key`, and that out of `owner` where nothing else is in it.
fn remove_member(owner: &mut Value, key: &str, name: &str) -> Option<Value> {
    let owner = owner.as_object_mut()?;
    let inner = owner.get_mut(key)?.as_object_mut()?;
    let taken = inner.shift_remove(name);
    if taken.is_some() && inner.is_empty() {
        owner.shift_remove(key);
    }
    taken
}

fn drop_empty(owner: &mut Value, key: &str) {
    if owner.get(key).and_then(Value::as_array).is_some_and(Vec::is_empty) {
        owner.as_object_mut().and_then(|owner: &mut Map<String, Value>| owner.shift_remove(key));
    }
}

/// Takes nodes that go out of lists of nodes, and what extensions say of them and of meshes that go. `value` is the member
/// `parent` of something below the document's member `top`.
fn drop_references(value: &mut Value, top: &str, parent: &str, nodes: &BTreeSet<u64>, meshes: &BTreeSet<u64>) {
    let refers =
        |item: &Value, key: &str, to: &BTreeSet<u64>| item[key].as_u64().is_some_and(|index| to.contains(&index));
    match value {
        Value::Array(items) => {
            if matches!((top, parent), (_, "nodes" | "children" | "bones") | ("nodes", "ids")) {
                items.retain(|item| item.as_u64().is_none_or(|index| !nodes.contains(&index)));
            }
            if !matches!(parent, "nodes" | "channels") {
                items.retain(|item| !refers(item, "node", nodes) && !refers(item, "mesh", meshes));
            }
            items.iter_mut().for_each(|item| drop_references(item, top, parent, nodes, meshes));
        }
        Value::Object(members) => {
            for (key, inner) in members.iter_mut().filter(|(key, _)| *key != "extras") {
                drop_references(inner, if top.is_empty() { key } else { top }, key, nodes, meshes);
            }
        }
        _ => {}
    }
}
