//! Indices from one part of a glTF document into another: those of the core, of the extensions named here, and of ours.

use serde_json::Value;

/// Extensions whose references are among those that are visited, or that have none. A name that ends in `_` stands for all
/// that start so.
const KNOWN: [&str; 17] = [
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_avif",
    "EXT_texture_webp",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_materials_",
    "KHR_mesh_quantization",
    "KHR_node_",
    "KHR_texture_",
    "KHR_xmp_json_ld",
    "MSFT_lod",
    "MSFT_texture_dds",
    "VRM",
    "VRMC_materials_",
    "VRMC_springBone",
    "VRMC_vrm",
];

/// Whether all references of this extension are known.
pub fn known(extension: &str) -> bool {
    KNOWN.iter().any(|known| extension == *known || known.ends_with('_') && extension.starts_with(known))
}

/// Calls `see` with the list and the place of every index in `value`, which stands below the document's member `top` (empty
/// for the document itself).
pub fn visit(value: &mut Value, top: &str, see: &mut dyn FnMut(&'static str, &mut Value)) {
    match (value, top) {
        (Value::Object(members), "") => members.iter_mut().for_each(|(key, inner)| walk(inner, key, key, see)),
        (value, top) => walk(value, top, top, see),
    }
}

fn walk(value: &mut Value, top: &str, parent: &str, see: &mut dyn FnMut(&'static str, &mut Value)) {
    match value {
        Value::Object(members) => {
            for (key, inner) in members.iter_mut().filter(|(key, _)| *key != "extras") {
                match (list(top, parent, key), inner) {
                    (Some(list), index @ Value::Number(_)) => see(list, index),
                    (Some(list), Value::Array(items)) => {
                        for item in items {
                            if item.is_number() { see(list, item) } else { walk(item, top, key, see) }
                        }
                    }
                    // Names of its attributes are numbers of its own.
                    (_, inner) if key == "KHR_draco_mesh_compression" => {
                        if let Some(view) = inner.get_mut("bufferView") {
                            see("bufferViews", view);
                        }
                    }
                    (_, inner) => walk(inner, top, key, see),
                }
            }
        }
        Value::Array(items) => items.iter_mut().for_each(|item| walk(item, top, parent, see)),
        _ => {}
    }
}

/// What the member `key` of an object that is the member `parent`, below the document's `top`, points into.
fn list(top: &str, parent: &str, key: &str) -> Option<&'static str> {
    Some(match (top, parent, key) {
        (_, _, "bufferView") => "bufferViews",
        (_, _, "node" | "children" | "joints" | "skeleton" | "center" | "bones" | "firstPersonBone") => "nodes",
        ("scenes", _, "nodes") | ("nodes", "MSFT_lod", "ids") => "nodes",
        (_, _, "mesh") => "meshes",
        (_, _, "material") | ("materials", "MSFT_lod", "ids") => "materials",
        (_, _, "index") if parent.ends_with("Texture") => "textures",
        (_, "textureProperties", _) | (_, "meta", "texture") => "textures",
        ("textures", _, "source") | (_, "meta", "thumbnailImage") => "images",
        ("textures", _, "sampler") => "samplers",
        (_, _, "inverseBindMatrices") | ("animations", _, "input" | "output") => "accessors",
        ("meshes", "attributes" | "targets", _) | (_, "attributes", _) => "accessors",
        ("meshes", _, "indices") => "accessors",
        // A coat's own.
        (_, "blend", "weights") | (_, "fins", "edges" | "strips") => "accessors",
        ("extensions", "shells" | "fin", "albedo" | "medium" | "ends" | "tangent") => "bufferViews",
        _ => return None,
    })
}
