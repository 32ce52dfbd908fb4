//! What shows a mesh, hides it, repeats it or stands for it from afar does so with its coat.

use super::{bake, glb, load, plane, says};
use crate::made::coat_for;
use crate::one_skin::{grown, thin};
use furrier::asset::coat::with_coat;
use furrier::asset::{self, Asset, Document, Fallback};
use furrier::viewer::stage;
use serde_json::{Value, json};

fn coated(document: &Document) -> (Asset, Document) {
    let asset = Asset::new(document.clone(), Vec::new()).unwrap();
    let coated = with_coat(&asset, &coat_for(&asset), Fallback::Shells(2)).unwrap();
    (asset, coated)
}

/// The node that shows the shells of the first mesh, and its index.
fn shells(document: &Document) -> (usize, Value) {
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

fn skinned_node(document: &Document) -> usize {
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

/// Meshes side by side under these names, or MSFT_lod between the first and those that the scene does not show.
fn levels(names: &[&str], shown: usize) -> Document {
    let mut document = plane(json!({"name": "Fur"}), &[]);
    document.json["nodes"][0]["name"] = json!(names[0]);
    for (i, name) in names.iter().enumerate().skip(1) {
        let mesh = document.json["meshes"][0].clone();
        let mesh = document.push("meshes", mesh);
        let node = document.push("nodes", json!({"mesh": mesh, "name": name}));
        if i < shown {
            document.json["scenes"][0]["nodes"].as_array_mut().unwrap().push(json!(node));
        }
    }
    document
}

#[test]
fn the_finest_level_of_detail_is_furred_and_the_others_named() {
    let folder = tempfile::tempdir().unwrap();
    for (names, finest) in [
        (["Beast_LOD0", "Beast_LOD1", "Beast_LOD2"], 0),
        (["Beast_LOD2", "Beast_LOD1", "Beast_LOD0"], 2),
        (["Beast.lod1", "Beast.lod2.001", "Beast.lod3"], 0),
        (["BeastLOD 1", "BeastLOD 2", "BeastLOD 10"], 0),
        (["LOD0", "LOD1", "LOD2"], 0),
    ] {
        let path = glb(&levels(&names, 3), folder.path(), "levels.glb");
        let asset = load(&path);
        let furred: Vec<usize> = asset.parts.iter().map(|part| part.nodes[0]).collect();
        assert_eq!(furred, [finest], "{names:?}");
        let others: Vec<&str> = names.iter().copied().filter(|name| *name != names[finest]).collect();
        assert!(says(&asset.warnings, &[&["without fur"], &others[..]].concat()), "{names:?}: {:?}", asset.warnings);
    }
    // Alone, or of different things, they are all there is.
    for names in [["Fox_LOD0", "Deer_LOD1", "Cat"], ["melod0", "melod1", "Explode2"]] {
        let asset = load(&glb(&levels(&names, 3), folder.path(), "levels.glb"));
        assert_eq!((asset.parts.len(), asset.warnings.len()), (3, 0), "{names:?}");
    }
    // The output keeps all levels, one of them with a coat.
    let path = glb(&levels(&["Beast_LOD0", "Beast_LOD1", "x"], 2), folder.path(), "levels.glb");
    let out = folder.path().join("out.glb");
    bake(&path, &out).unwrap();
    let written = load(&out).document.json;
    let wears = |mesh: usize| written["meshes"][mesh]["primitives"][0]["extensions"].is_object();
    assert_eq!([wears(0), wears(1)], [true, false]);
    // By the extension.
    let mut document = levels(&["Beast", "Beast far", "Beast farther"], 1);
    document.json["nodes"][0]["extensions"] = json!({"MSFT_lod": {"ids": [1, 2]}});
    let asset = load(&glb(&document, folder.path(), "levels.glb"));
    assert_eq!(asset.parts.len(), 1);
    assert!(says(&asset.warnings, &["of Beast,", "Beast far, Beast farther", "without fur"]), "{:?}", asset.warnings);
}

/// The creature as an avatar of the first or second version of VRM.
fn avatar(second: bool) -> Document {
    let mut document = asset::load("sample:creature").unwrap().document;
    let node = skinned_node(&document);
    let mesh = document.json["nodes"][node]["mesh"].clone();
    let properties = |name: &Value| json!({"name": name, "shader": "VRM/MToon", "renderQueue": 2000});
    let materials = document.json["materials"].as_array().unwrap();
    document.json["extensions"] = if second {
        let bind = json!([{"node": node, "index": 0, "weight": 1.0}, {"node": 0, "index": 3, "weight": 1.0}]);
        json!({"VRMC_vrm": {
            "specVersion": "1.0",
            "expressions": {"preset": {"blink": {"morphTargetBinds": bind}}, "custom": {"mine": {"morphTargetBinds": bind}}},
            "firstPerson": {"meshAnnotations": [{"node": node, "type": "thirdPersonOnly"}]},
        }})
    } else {
        json!({"VRM": {
            "specVersion": "0.0",
            "materialProperties": materials.iter().map(|m| properties(&m["name"])).collect::<Vec<_>>(),
            "blendShapeMaster": {"blendShapeGroups": [{"name": "Blink", "binds": [{"mesh": mesh, "index": 0, "weight": 100}]}, {"name": "Joy"}]},
            "firstPerson": {"meshAnnotations": [{"mesh": mesh, "firstPersonFlag": "ThirdPersonOnly"}]},
        }})
    };
    document
}

#[test]
fn avatars_know_their_shells() {
    let (_, out) = coated(&avatar(false));
    let vrm = &out.json["extensions"]["VRM"];
    let (node, own) = shells(&out);
    let names: Vec<&Value> = vrm["materialProperties"].as_array().unwrap().iter().map(|p| &p["name"]).collect();
    let materials: Vec<&Value> = out.json["materials"].as_array().unwrap().iter().map(|m| &m["name"]).collect();
    assert_eq!(names, materials);
    let added = vrm["materialProperties"].as_array().unwrap().last().unwrap();
    assert_eq!(added["shader"], "VRM_USE_GLTFSHADER");
    let binds = &vrm["blendShapeMaster"]["blendShapeGroups"][0]["binds"];
    assert_eq!(binds[1], json!({"mesh": own["mesh"], "index": 0, "weight": 100}));
    assert_eq!(
        vrm["firstPerson"]["meshAnnotations"][1],
        json!({"mesh": own["mesh"], "firstPersonFlag": "ThirdPersonOnly"})
    );
    let (_, out) = coated(&avatar(true));
    let vrm = &out.json["extensions"]["VRMC_vrm"];
    assert_eq!(shells(&out).0, node);
    for kind in ["/expressions/preset/blink", "/expressions/custom/mine"] {
        let binds = &vrm.pointer(kind).unwrap()["morphTargetBinds"];
        assert_eq!(binds.as_array().unwrap().len(), 3);
        assert_eq!(binds[2], json!({"node": node, "index": 0, "weight": 1.0}));
    }
    assert_eq!(vrm["firstPerson"]["meshAnnotations"][1], json!({"node": node, "type": "thirdPersonOnly"}));
}

#[test]
fn an_avatar_is_written_as_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = glb(&avatar(true), folder.path(), "in.vrm");
    let out = folder.path().join("out.vrm");
    bake(&path, &out).unwrap();
    assert!(std::fs::read(&out).unwrap().starts_with(b"glTF"));
    let (asset, coat) = asset::read_coat(&out).unwrap();
    assert!(!coat.primitives.is_empty() && asset.document.json["extensions"]["VRMC_vrm"].is_object());
}
