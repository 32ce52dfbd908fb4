//! What is broken of parts that get no fur.

use super::{glb, load, plane, png, request, says};
use crate::one_skin::{grown, thin};
use furrier::asset::{self, Document};
use furrier::bake::{Request, bake};
use furrier::error::Kind;
use furrier::viewer::stage;
use serde_json::json;

/// A plane of fur beside one in a shirt with this picture.
fn shirt(image: &[u8]) -> Document {
    let mut document = plane(json!({"name": "Fur"}), &[image]);
    document.push("textures", json!({"source": 0}));
    let texture = json!({"baseColorFactor": [0.2, 0.3, 0.4, 1], "baseColorTexture": {"index": 0}});
    let material = document.push("materials", json!({"name": "Shirt", "pbrMetallicRoughness": texture}));
    let mut mesh = document.json["meshes"][0].clone();
    mesh["primitives"][0]["material"] = json!(material);
    let mesh = document.push("meshes", mesh);
    let node = document.push("nodes", json!({"mesh": mesh, "translation": [0.5, 0, 0]}));
    document.json["scenes"][0]["nodes"].as_array_mut().unwrap().push(json!(node));
    document
}

#[test]
fn a_broken_picture_stops_fur_of_its_colour_alone() {
    let folder = tempfile::tempdir().unwrap();
    let whole = png([255, 0, 0]);
    let mut vast = whole.clone();
    // Width and height of the header, and its sum, which readers may or may not look at.
    vast[16..24].copy_from_slice(&[0, 0, 255, 255, 0, 0, 255, 255]);
    let cut = whole[..whole.len() - 20].to_vec();
    let headless = whole[..20].to_vec();
    for (what, image) in [("vast", &vast), ("cut", &cut), ("headless", &headless)] {
        let path = glb(&shirt(image), folder.path(), "shirt.glb");
        let out = folder.path().join("out.glb");
        // Fur on what is whole: said, and done.
        let of = |material: &str| Request { materials: vec![material.to_owned()], ..request(&path, &out) };
        let baked = bake(&of("Fur"), &mut |_| ()).unwrap_or_else(|error| panic!("{what}: {error}"));
        assert!(
            what == "cut" || says(&baked.warnings, &["images[0]", "\"Shirt\"", "no fur"]),
            "{what}: {:?}",
            baked.warnings
        );
        // It is seen, and drawn hair by hair.
        let (asset, coat) = asset::read_coat(&out).unwrap_or_else(|error| panic!("{what}: {error}"));
        let textures = stage::textures(&asset, &coat).unwrap_or_else(|error| panic!("{what}: {error}"));
        assert!(says(&textures.notes, &["images[0]", "\"Shirt\""]), "{what}: {:?}", textures.notes);
        let mut fur_only = load(&path).document;
        fur_only.json["materials"][1]["name"] = json!("Glasses");
        assert!(says(&grown(&glb(&fur_only, folder.path(), "named.glb"), &thin(&[])).notes, &["images[0]"]), "{what}");
        // Fur of its colour is not.
        std::fs::remove_file(&out).unwrap();
        let error = bake(&of("Shirt"), &mut |_| ()).unwrap_err();
        assert_eq!((error.kind, error.field.as_deref()), (Kind::Input, Some("images[0]")), "{what}: {error}");
        assert!(!out.exists());
    }
}
