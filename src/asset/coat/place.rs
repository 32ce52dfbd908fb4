//! Where the fallback hangs in the scene: wherever its base does, and hidden with it.

use crate::asset::document::Document;
use crate::asset::json::At;
use crate::asset::scene_graph::SceneGraph;
use crate::error::Result;
use serde_json::{Value, json};

/// Extensions of a node that decide whether and where its own mesh is seen.
const OF_MESH: [&str; 2] = ["EXT_mesh_gpu_instancing", "KHR_node_visibility"];

/// Shows the mesh `shells` wherever `node` shows its base: a child of it, or, under a skin (which overrides the node's
/// own place), a root beside it, or, where something above or at the node hides it, beside or below it. Gives the node.
pub fn place(document: &mut Document, scene: &SceneGraph, node: usize, shells: usize, name: &str) -> Result<usize> {
    let base = document.json["nodes"][node].clone();
    let mut added = json!({"name": format!("{name} fur shells"), "mesh": shells});
    for key in ["skin", "weights"] {
        if let Some(value) = base.get(key) {
            added[key] = value.clone();
        }
    }
    let skinned = base.get("skin").is_some();
    // Instances are the node's, not its children's; what hides a node hides them too.
    let own = |name: &&str| *name == "EXT_mesh_gpu_instancing" || skinned;
    for name in OF_MESH.into_iter().filter(own) {
        if let Some(value) = base.get("extensions").and_then(|extensions| extensions.get(name)) {
            added["extensions"][name] = value.clone();
        }
    }
    let added_index = document.push("nodes", added);
    // What MSFT_lod alone shows is in no scene beside it.
    let leveled = has(&base, "MSFT_lod") || scene.levels.linked[node];
    let hidden_from_above = ancestors(scene, node).any(|above| {
        let above = &document.json["nodes"][above];
        has(above, "KHR_node_visibility") || has(above, "MSFT_lod")
    });
    match scene.parent[node] {
        Some(above) if skinned && hidden_from_above && !leveled => hang(document, above, added_index),
        _ if skinned && !leveled => {
            for scene in scenes_with(document, node)? {
                if let Some(list) = document.json["scenes"][scene]["nodes"].as_array_mut() {
                    list.push(json!(added_index));
                }
            }
        }
        _ => hang(document, node, added_index),
    }
    animate(document, node, added_index);
    Ok(added_index)
}

fn has(node: &Value, extension: &str) -> bool {
    node.get("extensions").is_some_and(|extensions| extensions.get(extension).is_some())
}

fn ancestors(scene: &SceneGraph, node: usize) -> impl Iterator<Item = usize> {
    std::iter::successors(scene.parent[node], |&above| scene.parent[above])
}

fn hang(document: &mut Document, above: usize, added: usize) {
    if let Some(owner) = document.json["nodes"][above].as_object_mut()
        && let Some(list) = owner.entry("children").or_insert_with(|| json!([])).as_array_mut()
    {
        list.push(json!(added));
    }
}

/// Weights are animated on the node, and a skinned node's visibility is its own, so the shells' node needs the same channels.
fn animate(document: &mut Document, node: usize, added: usize) {
    let visible = |node: usize| json!(format!("/nodes/{node}/extensions/KHR_node_visibility/visible"));
    let skinned = document.json["nodes"][added].get("skin").is_some();
    let animations = document.json.get_mut("animations").and_then(Value::as_array_mut);
    for animation in animations.into_iter().flatten() {
        let Some(channels) = animation.get_mut("channels").and_then(Value::as_array_mut) else { continue };
        let mut copies = Vec::new();
        for channel in channels.iter() {
            let target = &channel["target"];
            let mut copy = channel.clone();
            if target["node"].as_u64() == Some(node as u64) && target["path"] == "weights" {
                copy["target"]["node"] = json!(added);
                copies.push(copy);
            } else if skinned && target["extensions"]["KHR_animation_pointer"]["pointer"] == visible(node) {
                copy["target"]["extensions"]["KHR_animation_pointer"]["pointer"] = visible(added);
                copies.push(copy);
            }
        }
        channels.extend(copies);
    }
}

/// Scenes in whose trees `node` is.
fn scenes_with(document: &Document, node: usize) -> Result<Vec<usize>> {
    let root = document.root();
    let nodes = root.list("nodes")?;
    let mut found = Vec::new();
    for (index, scene) in root.list("scenes")?.iter().enumerate() {
        let mut reached: Vec<usize> = scene.list("nodes")?.iter().map(At::size).collect::<Result<_>>()?;
        while let Some(here) = reached.pop() {
            if here == node {
                found.push(index);
                break;
            }
            for child in nodes[here].list("children")? {
                reached.push(child.size()?);
            }
        }
    }
    Ok(found)
}
