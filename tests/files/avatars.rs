//! Avatars (VRM 0 and 1): what they say of the skin holds for its coat.

use super::scenes::{coated, shells, skinned_node};
use super::{bake, close, glb, hair_colour, plane, says};
use furrier::asset::coat::{strip, write_coat};
use furrier::asset::{self, Document, Fallback, read_document};
use serde_json::{Value, json};

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

/// A plane as an avatar with two furred materials, the first with a colour, and this expression: VRM 1, or VRM 0.
fn with_expression(expression: &Value, second: bool, alone: bool) -> Document {
    let colour = json!({"baseColorFactor": [0.5, 0.25, 0.1, 1]});
    let mut document = plane(json!({"name": "Body", "pbrMetallicRoughness": colour}), &[]);
    if !alone {
        let mut primitive = document.json["meshes"][0]["primitives"][0].clone();
        primitive["material"] = json!(document.push("materials", json!({"name": "Coat"})));
        document.json["meshes"][0]["primitives"].as_array_mut().unwrap().push(primitive);
    }
    document.json["extensions"] = if second {
        json!({"VRMC_vrm": {"specVersion": "1.0", "expressions": {"custom": {"Blush": expression}}}})
    } else {
        json!({"VRM": {"specVersion": "0.0", "blendShapeMaster": {"blendShapeGroups": [expression]}}})
    };
    document
}

/// What baking says, and what is written.
fn baked(document: &Document) -> (Vec<String>, Document) {
    let folder = tempfile::tempdir().unwrap();
    let asset = asset::Asset::new(document.clone(), Vec::new()).unwrap();
    let out = folder.path().join("out.glb");
    let notes = write_coat(&asset, &crate::made::coat_for(&asset), Fallback::Shells(2), &out).unwrap();
    (notes, read_document(&out).unwrap().0)
}

/// Bakes with one preset for all, and gives what is said and written.
fn really_baked(document: &Document) -> (Vec<String>, Document) {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out.vrm");
    let said = bake(&glb(document, folder.path(), "in.vrm"), &out).unwrap().notes;
    (said, read_document(&out).unwrap().0)
}

#[test]
fn shells_change_their_colour_with_the_skin_below() {
    let bind = json!({"material": 0, "type": "color", "targetValue": [1.0, 0.125, 0.1, 1]});
    let glow = json!({"material": 0, "type": "emissionColor", "targetValue": [1.0, 0.0, 0.0, 1]});
    let newer = with_expression(&json!({"materialColorBinds": [bind, glow]}), true, true);
    let (said, out) = really_baked(&newer);
    assert!(says(&said, &["\"Blush\"", "\"Body\"", "shells of the fallback follow"]), "{said:?}");
    let binds = out.json["extensions"]["VRMC_vrm"]["expressions"]["custom"]["Blush"]["materialColorBinds"].clone();
    let shells: Vec<usize> = (1..out.count("materials")).collect();
    assert_eq!((shells.len(), binds.as_array().unwrap().len()), (2, 4), "{binds}");
    for (bind, shell) in binds.as_array().unwrap()[2..].iter().zip(&shells) {
        // Twice as red and half as green as it was.
        assert_eq!(*bind, json!({"material": shell, "type": "color", "targetValue": [2.0, 0.5, 1.0, 1.0]}));
    }
    // VRM 0 knows materials by name, and colours as they are shown.
    let value =
        json!({"materialName": "Body", "propertyName": "_Color", "targetValue": [1.0, 0.388573, 0.349190, 1.0]});
    let older = with_expression(&json!({"name": "Joy", "materialValues": [value]}), false, true);
    let (said, out) = really_baked(&older);
    assert!(says(&said, &["\"Joy\"", "shells of the fallback follow"]), "{said:?}");
    let values = &out.json["extensions"]["VRM"]["blendShapeMaster"]["blendShapeGroups"][0]["materialValues"];
    let added = &values[1];
    assert_eq!((&added["materialName"], &added["propertyName"]), (&out.json["materials"][1]["name"], &json!("_Color")));
    for (i, expected) in [1.353, 0.735, 1.0].into_iter().enumerate() {
        let found = added["targetValue"][i].as_f64().unwrap();
        assert!((found - expected).abs() < 0.01, "{i}: {found}");
    }
    // Taken off, they are gone with the shells.
    for (document, out) in
        [(newer, really_baked(&with_expression(&json!({"materialColorBinds": [bind]}), true, true)).1), (older, out)]
    {
        let mut changed = out;
        changed.json["asset"]["copyright"] = json!("changed");
        let bare = strip(&changed).unwrap().document;
        assert_eq!(bare.count("materials"), document.count("materials"));
        assert!(!bare.json.to_string().contains("shell"), "{}", bare.json["extensions"]);
    }
}

#[test]
fn a_colour_that_fur_does_not_follow_is_said_with_the_expression() {
    let colour =
        |target: [f64; 4]| json!({"materialColorBinds": [{"material": 0, "type": "color", "targetValue": target}]});
    // Shells over two materials have one colour between them.
    let (said, out) = really_baked(&with_expression(&colour([1.0, 0.0, 0.0, 1.0]), true, false));
    assert!(says(&said, &["keeps its colour", "\"Blush\"", "\"Body\"", "alone"]), "{said:?}");
    assert_eq!(out.json["extensions"]["VRMC_vrm"]["expressions"]["custom"]["Blush"], colour([1.0, 0.0, 0.0, 1.0]));
    // A texture that moves.
    let moved = json!({"textureTransformBinds": [{"material": 0, "scale": [1, 1], "offset": [0.5, 0]}]});
    let (said, _) = baked(&with_expression(&moved, true, true));
    assert!(says(&said, &["\"Blush\"", "moves the texture"]), "{said:?}");
    let still = json!({"textureTransformBinds": [{"material": 0, "scale": [1, 1], "offset": [0, 0]}]});
    assert!(!says(&baked(&with_expression(&still, true, true)).0, &["Blush"]));
    // Black hair takes no colour by a factor.
    let mut black = with_expression(&colour([1.0, 0.0, 0.0, 1.0]), true, true);
    black.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = json!([0, 0, 0, 1]);
    let (said, _) = really_baked(&black);
    assert!(says(&said, &["\"Blush\"", "its own colour has nothing of it"]), "{said:?}");
    // What has no fur is nobody's concern.
    let other = json!({"materialColorBinds": [{"material": 7, "type": "color", "targetValue": [1, 0, 0, 1]}]});
    assert!(!says(&really_baked(&with_expression(&other, true, true)).0, &["Blush"]));
}

#[test]
fn the_older_avatars_own_colours_are_those_of_hair() {
    let folder = tempfile::tempdir().unwrap();
    let mut document =
        plane(json!({"name": "Body", "pbrMetallicRoughness": {"baseColorFactor": [0.2, 0.3, 0.4, 1]}}), &[]);
    let of = |shader: &str| json!({"VRM": {"materialProperties": [{"name": "Body", "shader": shader, "vectorProperties": {"_Color": [0.735357, 0.537099, 0.0, 1.0]}}]}});
    for (shader, expected) in [("VRM/MToon", [0.5, 0.25, 0.0]), ("VRM_USE_GLTFSHADER", [0.2, 0.3, 0.4])] {
        document.json["extensions"] = of(shader);
        let found = hair_colour(&glb(&document, folder.path(), "in.glb"));
        assert!(close(found, expected), "{shader}: {found}");
    }
}
