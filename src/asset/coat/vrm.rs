//! Avatars (VRM 0 and 1): what they say of a mesh, a node or a material holds for the shells over it too.

use crate::asset::document::Document;
use serde_json::{Value, json};

/// What the fallback added to a document.
#[derive(Clone, Debug, Default)]
pub struct Added {
    /// How many materials there were before.
    pub materials: usize,
    /// Base mesh and its shells.
    pub meshes: Vec<(usize, usize)>,
    /// Base node and that of its shells.
    pub nodes: Vec<(usize, usize)>,
}

/// Writes the shells into the avatar's own lists.
pub fn follow(document: &mut Document, added: &Added) {
    let names: Vec<Value> =
        (added.materials..document.count("materials")).map(|m| document.json["materials"][m]["name"].clone()).collect();
    if let Some(avatar) = document.json.pointer_mut("/extensions/VRM") {
        materials(avatar, added.materials, &names);
        let groups = avatar.pointer_mut("/blendShapeMaster/blendShapeGroups").and_then(Value::as_array_mut);
        for group in groups.into_iter().flatten() {
            repeat(group.get_mut("binds"), "mesh", &added.meshes);
        }
        repeat(avatar.pointer_mut("/firstPerson/meshAnnotations"), "mesh", &added.meshes);
    }
    if let Some(avatar) = document.json.pointer_mut("/extensions/VRMC_vrm") {
        for kind in ["preset", "custom"] {
            let expressions = avatar.pointer_mut(&format!("/expressions/{kind}")).and_then(Value::as_object_mut);
            for expression in expressions.into_iter().flat_map(|all| all.values_mut()) {
                repeat(expression.get_mut("morphTargetBinds"), "node", &added.nodes);
            }
        }
        repeat(avatar.pointer_mut("/firstPerson/meshAnnotations"), "node", &added.nodes);
    }
}

/// VRM 0 has one entry per material, in their order: the shells' are shown as glTF has them.
fn materials(avatar: &mut Value, before: usize, names: &[Value]) {
    let Some(list) = avatar.get_mut("materialProperties").and_then(Value::as_array_mut) else { return };
    // A list that is not whole means nothing; more entries would not stand where they belong.
    if list.len() != before {
        return;
    }
    list.extend(names.iter().map(|name| {
        json!({
            "name": name,
            "shader": "VRM_USE_GLTFSHADER",
            "renderQueue": 3000,
            "floatProperties": {},
            "vectorProperties": {},
            "textureProperties": {},
            "keywordMap": {},
            "tagMap": {},
        })
    }));
}

/// Repeats each entry of a list that names something with shells, for these.
fn repeat(list: Option<&mut Value>, key: &str, pairs: &[(usize, usize)]) {
    let Some(list) = list.and_then(Value::as_array_mut) else { return };
    let mut more = Vec::new();
    for entry in list.iter() {
        for (_, shells) in pairs.iter().filter(|(base, _)| entry[key].as_u64() == Some(*base as u64)) {
            let mut copy = entry.clone();
            copy[key] = json!(shells);
            more.push(copy);
        }
    }
    list.extend(more);
}
