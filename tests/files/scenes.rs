//! What shows a mesh, hides it, repeats it or stands for it from afar does so with its coat.

use super::{bake, glb, load, plane};
use crate::made::coat_for;
use crate::one_skin::{grown, thin};
use furrier::asset::coat::with_coat;
use furrier::asset::{self, Asset, Document, Fallback};
use furrier::viewer::stage;
use serde_json::{Value, json};

pub fn coated(document: &Document) -> (Asset, Document) {
    let asset = Asset::new(document.clone(), Vec::new()).unwrap();
    let coated = with_coat(&asset, &coat_for(&asset), Fallback::Shells(2)).unwrap();
    (asset, coated)
}

/// The node that shows the shells of the first mesh, and its index.
pub fn shells(document: &Document) -> (usize, Value) {
    let nodes = document.json["nodes"].as_array().unwrap();
    let named = |node: &&Value| node["name"].as_str().is_some_and(|name| name.ends_with("fur shells"));
    let index = nodes.iter().position(|node| named(&node)).expect("shells");
    (index, nodes[index].clone())
}

fn parents(document: &Document, node: usize) -> Vec<usize> {
    let nodes = document.json["nodes"].as_array().unwrap();
    let has = |owner: &Value| owner["children"].as_array().is_some_and(|list| list.contains(&json!(node)));
    (0..nodes.len()).filter(|&i| has(&nodes[i])).collect()
}

/// How many coats are drawn.
fn drawn(asset: &Asset) -> usize {
    let coat = coat_for(asset);
    let textures = stage::textures(asset, &coat).unwrap();
    stage::scene(asset, &coat, &textures, &asset.rest_pose().unwrap()).furs.len()
}

pub fn skinned_node(document: &Document) -> usize {
    document.json["nodes"].as_array().unwrap().iter().position(|node| node.get("skin").is_some()).unwrap()
}

#[test]
fn what_hides_the_base_hides_the_coat() {
    let hidden = json!({"KHR_node_visibility": {"visible": false}});
    // A child is hidden with its node.
    let mut document = plane(json!({"name": "Fur"}), &[]);
    assert!(drawn(&coated(&document).0) > 0);
    document.json["nodes"][0]["extensions"] = hidden.clone();
    let (asset, out) = coated(&document);
    assert_eq!(drawn(&asset), 0);
    assert_eq!(parents(&out, shells(&out).0), [0]);
    // Under a skin the shells stand beside their base, and are hidden as it is, by the same animations.
    let mut document = asset::load("sample:creature").unwrap().document;
    let node = skinned_node(&document);
    let pointer = |node: usize| json!(format!("/nodes/{node}/extensions/KHR_node_visibility/visible"));
    document.json["nodes"][node]["extensions"] = hidden.clone();
    document.json["animations"][0]["channels"].as_array_mut().unwrap().push(json!({
        "sampler": 0,
        "target": {"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": pointer(node)}}},
    }));
    let (asset, out) = coated(&document);
    assert_eq!(drawn(&asset), 0);
    let (index, own) = shells(&out);
    assert_eq!(own["extensions"], hidden);
    let channels = out.json["animations"][0]["channels"].as_array().unwrap();
    let pointed = |at: usize| {
        channels.iter().filter(|c| c["target"]["extensions"]["KHR_animation_pointer"]["pointer"] == pointer(at)).count()
    };
    assert_eq!((pointed(node), pointed(index)), (1, 1));
    // Hidden from above, they hang below the same node.
    let mut document = asset::load("sample:creature").unwrap().document;
    let above = document.push("nodes", json!({"children": [node], "extensions": hidden}));
    let roots = document.json["scenes"][0]["nodes"].as_array_mut().unwrap();
    roots.retain(|root| *root != json!(node));
    roots.push(json!(above));
    let (asset, out) = coated(&document);
    assert_eq!(drawn(&asset), 0);
    assert_eq!(parents(&out, shells(&out).0), [above]);
}

#[test]
fn what_is_hidden_is_in_no_picture() {
    let folder = tempfile::tempdir().unwrap();
    let mut document = plane(json!({"name": "Fur"}), &[]);
    let node = document.push("nodes", json!({"mesh": 0, "translation": [3, 0, 0]}));
    document.json["scenes"][0]["nodes"].as_array_mut().unwrap().push(json!(node));
    let hairs = |document: &Document| {
        let grown = grown(&glb(document, folder.path(), "in.glb"), &thin(&[]));
        grown.scene().guard.unwrap().0.points_m.iter().map(|p| p.x > 1.5).collect::<Vec<bool>>()
    };
    let both = hairs(&document);
    for (hidden, far) in [(node, false), (0, true)] {
        let mut one = document.clone();
        one.json["nodes"][hidden]["extensions"] = json!({"KHR_node_visibility": {"visible": false}});
        let left = hairs(&one);
        assert_eq!(2 * left.len(), both.len());
        assert!(left.iter().all(|at| *at == far), "{hidden}");
    }
}

#[test]
fn instances_wear_the_coat_that_was_baked_once() {
    let mut document = plane(json!({"name": "Fur"}), &[]);
    let floats = |document: &mut Document, values: &[f32], kind: &str, width: usize| {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        let view = document.push_view(&bytes, None);
        json!(document.push(
            "accessors",
            json!({"bufferView": view, "componentType": 5126, "count": values.len() / width, "type": kind})
        ))
    };
    let places = floats(&mut document, &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 3.0, 0.0, 0.0], "VEC3", 3);
    let scales = floats(&mut document, &[2.0, 2.0, 2.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0], "VEC3", 3);
    let instancing = json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": places, "SCALE": scales}}});
    document.json["nodes"][0]["extensions"] = instancing.clone();
    document.json["extensionsUsed"] = json!(["EXT_mesh_gpu_instancing"]);
    document.json["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
    let folder = tempfile::tempdir().unwrap();
    let asset = load(&glb(&document, folder.path(), "herd.glb"));
    // The first is measured; from end to end there are 3 m and half an edge on either side.
    assert!((asset.parts[0].world_units(0) - 2.0 * asset.parts[0].stored.positions[0].as_dvec3()).length() < 1e-9);
    let coat = coat_for(&asset);
    let textures = stage::textures(&asset, &coat).unwrap();
    let list = stage::scene(&asset, &coat, &textures, &asset.rest_pose().unwrap());
    let middle = |fur: &furrier::runtime::CoatMesh<'_>| {
        fur.positions_m.iter().map(|p| p.x).sum::<f32>() / fur.positions_m.len() as f32
    };
    let each = list.furs.len() / 3;
    assert_eq!(3 * drawn(&Asset::new(plane(json!({"name": "Fur"}), &[]), Vec::new()).unwrap()), list.furs.len());
    let apart = middle(&list.furs[2 * each]) - middle(&list.furs[each]);
    assert!((apart - 2.0 * coat.metres_per_unit as f32).abs() < 1e-5, "{apart}");
    // One coat, and shells that are repeated as their base is.
    let path = glb(&document, folder.path(), "herd.glb");
    let out = folder.path().join("out.glb");
    let baked = bake(&path, &out).unwrap();
    assert_eq!(baked.coat.primitives.len(), 1);
    let written = load(&out).document;
    let (index, own) = shells(&written);
    assert_eq!(own["extensions"], instancing);
    assert_eq!(parents(&written, index), [0]);
}
