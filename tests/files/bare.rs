//! Which parts have fur by themselves.

use super::{bake, glb, plane, says};
use furrier::asset::{self, Asset, Document};
use serde_json::{Value, json};

#[test]
fn names_tell_what_is_bare_in_many_languages() {
    let bare = [
        "Eyeball",
        "Iris",
        "Std_Cornea_R",
        "Gums",
        "Tongue.001",
        "Whiskers",
        "Nails",
        "Beak",
        "Mouth_Inside",
        "Glasses",
        "eyebrow",
        "LEye",
        "REye_mat",
        "MI_Teeth",
        "Std_Upper_Teeth",
        "EyeMoisture",
        "Toenails",
        "Claws2",
        "N00_000_00_FaceMouth_00_FACE (Instance)",
        "N00_000_00_EyeIris_00_EYE (Instance)",
        "N00_000_00_FaceBrow_00_FACE (Instance)",
        "目",
        "白目",
        "瞳",
        "目ハイライト",
        "まつげ",
        "眉毛",
        "口内",
        "歯",
        "舌",
        "爪",
        "メガネ",
        "角",
        "眼睛",
        "牙齿",
        "胡须",
        "눈",
        "눈썹",
        "이빨",
        "발톱",
        "Auge_L",
        "Zähne",
        "Zunge",
        "Krallen",
        "Schnabel",
        "Yeux",
        "Dents",
        "Griffes",
        "Ojos",
        "Dientes",
        "Uñas",
        "Pezuñas",
        "Olhos",
        "Occhi",
        "Unghie",
        "глаза",
        "Зубы",
        "Когти",
    ];
    for name in bare {
        assert!(asset::is_bare(name), "{name}");
    }
    let furred = [
        "Fur",
        "Body",
        "Std_Skin_Head",
        "N00_000_00_Body_00_SKIN (Instance)",
        "Hat",
        "体",
        "毛",
        "顔",
        "角色",
        "皮毛",
        "Fell",
        "Pelage",
        "Pelo",
        "шерсть",
        "털",
        "Handle",
        "Hornet",
        "Background",
        "Irishwolf",
        "Paddock",
        "Numbat",
        "Clipping",
    ];
    for name in furred {
        assert!(!asset::is_bare(name), "{name}");
    }
}

/// Parts of one mesh, each with this material; cards are single quads, bodies the whole plane.
fn parts(materials: &[(Value, bool)]) -> Document {
    let mut document = plane(materials[0].0.clone(), &[]);
    let whole = document.json["meshes"][0]["primitives"][0].clone();
    let indices = document.integers(whole["indices"].as_u64().unwrap() as usize, 1).unwrap();
    document.json["materials"] = json!([]);
    let mut primitives = Vec::new();
    for (material, card) in materials {
        let own = if *card { &indices[..6] } else { &indices[..] };
        let mut primitive = whole.clone();
        primitive["indices"] = json!(super::push_indices(&mut document, own));
        primitive["material"] = json!(document.push("materials", material.clone()));
        primitives.push(primitive);
    }
    document.json["meshes"][0]["primitives"] = json!(primitives);
    document
}

fn chosen(document: Document) -> (Vec<usize>, String) {
    let asset = Asset::new(document, Vec::new()).unwrap();
    let selection = asset::select(&asset.parts, &[]).unwrap();
    (selection.parts, selection.note.unwrap_or_default())
}

#[test]
fn alpha_tells_cards_and_glass() {
    let fur = (json!({"name": "Fur"}), false);
    let of = |name: &str, mode: &str, card: bool| (json!({"name": name, "alphaMode": mode}), card);
    let (parts_chosen, note) = chosen(parts(&[
        fur.clone(),
        of("Shine", "BLEND", false),
        of("Strands", "MASK", true),
        of("Torn", "MASK", false),
    ]));
    assert_eq!(parts_chosen, [0, 3], "{note}");
    for words in ["fur on Fur, Torn", "Shine as light shines through", "Strands as cards"] {
        assert!(note.contains(words), "{note}");
    }
    // Exporters that call everything transparent do not leave a bald animal.
    assert_eq!(chosen(parts(&[of("Fur", "BLEND", false), of("Eyes", "BLEND", false)])).0, [0]);
    // What is named is furred, whatever it is.
    let asset = Asset::new(parts(&[fur, of("Shine", "BLEND", false)]), Vec::new()).unwrap();
    assert_eq!(asset::select(&asset.parts, &["Shine".to_owned()]).unwrap().parts, [1]);
}

#[test]
fn meshes_that_share_a_material_are_told_by_their_names() {
    let mut document = plane(json!({"name": "Atlas"}), &[]);
    document.json["meshes"][0]["name"] = json!("Body");
    for (name, of_node) in [("Teeth", false), ("Eye_L", true)] {
        let mut mesh = document.json["meshes"][0].clone();
        mesh["name"] = json!(if of_node { "Mesh.003" } else { name });
        let mesh = document.push("meshes", mesh);
        let node = document.push("nodes", json!({"mesh": mesh, "name": if of_node { name } else { "Object" }}));
        document.json["scenes"][0]["nodes"].as_array_mut().unwrap().push(json!(node));
    }
    let (parts_chosen, note) = chosen(document.clone());
    assert_eq!(parts_chosen, [0], "{note}");
    assert!(note.contains("\"teeth\"") && note.contains("\"eye\""), "{note}");
    // A model whose every part has such a name is furred by its materials alone.
    document.json["meshes"][0]["name"] = json!("Mouth test");
    assert_eq!(chosen(document).0, [0, 1, 2]);
}

#[test]
fn the_choice_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let document = parts(&[(json!({"name": "Fur"}), false), (json!({"name": "Iris"}), true)]);
    let path = glb(&document, folder.path(), "parts.glb");
    let baked = bake(&path, &folder.path().join("out.glb")).unwrap();
    assert!(says(&baked.notes, &["fur on Fur", "Iris by the name, \"iris\""]), "{:?}", baked.notes);
}
