//! Where materials state their colour.

use super::{bake, close, glb, hair_colour, load, plane, png, says};
use furrier::asset::coat::with_coat;
use furrier::asset::{Asset, Fallback};
use serde_json::json;

fn loaded(document: furrier::asset::Document) -> Asset {
    Asset::new(document, Vec::new()).unwrap()
}

#[test]
fn specular_glossiness_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let red = png([255, 0, 0]);
    let glossy = json!({"diffuseFactor": [0.5, 0.5, 0.5, 1], "diffuseTexture": {"index": 0}});
    let extensions = json!({"KHR_materials_pbrSpecularGlossiness": glossy});
    // Alone, and beside what viewers without the extension see.
    for material in [
        json!({"name": "Fur", "extensions": extensions}),
        json!({"name": "Fur", "pbrMetallicRoughness": {"baseColorFactor": [0, 1, 0, 1]}, "extensions": extensions}),
    ] {
        let mut document = plane(material, &[&red]);
        document.push("textures", json!({"source": 0}));
        let path = glb(&document, folder.path(), "glossy.glb");
        assert_eq!(load(&path).warnings, Vec::<String>::new());
        let found = hair_colour(&path);
        assert!(close(found, [0.5, 0.0, 0.0]), "{found}");
    }
    let plain = json!({"KHR_materials_pbrSpecularGlossiness": {"diffuseFactor": [0.1, 0.4, 0.2, 1]}});
    let path = glb(&plane(json!({"name": "Fur", "extensions": plain}), &[]), folder.path(), "plain.glb");
    assert!(close(hair_colour(&path), [0.1, 0.4, 0.2]));
}

#[test]
fn colour_that_glows_is_taken_where_there_is_no_other() {
    let folder = tempfile::tempdir().unwrap();
    let black = json!({"baseColorFactor": [0, 0, 0, 1]});
    let material = |base: &serde_json::Value| json!({"name": "Fur", "pbrMetallicRoughness": base, "emissiveFactor": [1, 1, 1], "emissiveTexture": {"index": 0}});
    let mut document = plane(material(&black), &[&png([255, 0, 0])]);
    document.push("textures", json!({"source": 0}));
    let path = glb(&document, folder.path(), "glows.glb");
    assert!(says(&load(&path).warnings, &["\"Fur\"", "glows"]));
    assert!(close(hair_colour(&path), [1.0, 0.0, 0.0]));
    // Where it has a colour, that is hair's, and the other is named.
    document.json["materials"][0] = material(&json!({"baseColorFactor": [0, 0, 1, 1]}));
    let path = glb(&document, folder.path(), "blue.glb");
    assert!(says(&load(&path).warnings, &["\"Fur\"", "emissive texture is not read"]));
    assert!(close(hair_colour(&path), [0.0, 0.0, 1.0]));
}

#[test]
fn a_colour_that_is_not_read_is_said() {
    let factor = [0.2, 0.3, 0.4, 1.0];
    let textured =
        json!({"name": "Fur", "pbrMetallicRoughness": {"baseColorFactor": factor, "baseColorTexture": {"index": 0}}});
    let avif = json!({"extensions": {"EXT_texture_avif": {"source": 0}}});
    let (red, stub) = (png([255, 0, 0]), b"\xABKTX 20\xBB\r\n\x1A\n and no more".to_vec());
    let basis = json!({"extensions": {"KHR_texture_basisu": {"source": 0}}});
    let cases = [
        (avif, &red, &["EXT_texture_avif"][..]),
        (json!({}), &red, &["names no image"]),
        (basis, &stub, &["images[0]", "KTX2 texture that cannot be decoded"]),
        (json!({"source": 0}), &b"GIF89a".to_vec(), &["images[0]", "neither PNG, JPEG, WebP nor KTX2"]),
    ];
    for (texture, image, words) in cases {
        let mut document = plane(textured.clone(), &[image]);
        document.push("textures", texture);
        let asset = loaded(document);
        assert!(says(&asset.warnings, &[words, &["\"Fur\""]].concat()), "{words:?}: {:?}", asset.warnings);
        assert_eq!(asset.parts[0].base_colour.factor.to_array(), factor.map(|f| f as f32));
        assert_eq!(asset.parts[0].base_colour.texture, None);
    }
    // A texture on coordinates that the mesh does not have.
    let far = json!({"name": "Fur", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "texCoord": 3}}});
    let mut document = plane(far, &[&red]);
    document.push("textures", json!({"source": 0}));
    let asset = loaded(document);
    assert!(says(&asset.warnings, &["\"Fur\"", "TEXCOORD_3"]), "{:?}", asset.warnings);
    // A material of a kind that is not known.
    let asset = loaded(plane(json!({"name": "Fur", "extensions": {"KHR_techniques_webgl": {"technique": 0}}}), &[]));
    assert!(says(&asset.warnings, &["\"Fur\"", "KHR_techniques_webgl"]), "{:?}", asset.warnings);
    // And nothing is said where nothing is missing.
    let asset = loaded(plane(json!({"name": "Fur", "extensions": {"KHR_materials_unlit": {}}}), &[]));
    assert_eq!(asset.warnings, Vec::<String>::new());
}

#[test]
fn images_elsewhere_are_named_and_stop_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let material = json!({
        "name": "Fur",
        "pbrMetallicRoughness": {"baseColorFactor": [0.4, 0.2, 0.1, 1]},
        "normalTexture": {"index": 0},
    });
    for uri in ["http://example.com/normal.png", "../normal.png", "C:\\work\\normal.png", "gone.png"] {
        let mut document = plane(material.clone(), &[]);
        document.push("images", json!({"uri": uri}));
        document.push("textures", json!({"source": 0}));
        let path = glb(&document, folder.path(), "normal.glb");
        let out = folder.path().join("out.glb");
        let baked = bake(&path, &out).unwrap_or_else(|error| panic!("{uri}: {error}"));
        assert!(says(&baked.notes, &[uri, "the output still names it"]), "{uri}: {:?}", baked.notes);
        assert_eq!(load(&out).document.json["images"][0]["uri"], uri);
        // As a base colour it is missed, and no more.
        document.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = json!({"index": 0});
        let asset = load(&glb(&document, folder.path(), "base.glb"));
        assert!(says(&asset.warnings, &["images[0]", uri, "\"Fur\""]), "{uri}: {:?}", asset.warnings);
    }
}

#[test]
fn variants_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let mut document =
        plane(json!({"name": "Brown", "pbrMetallicRoughness": {"baseColorFactor": [0.3, 0.2, 0.1, 1]}}), &[]);
    document.push("materials", json!({"name": "White"}));
    let mappings = json!([{"material": 0, "variants": [0]}, {"material": 1, "variants": [1, 2]}]);
    document.json["meshes"][0]["primitives"][0]["extensions"] =
        json!({"KHR_materials_variants": {"mappings": mappings}});
    document.json["extensions"] =
        json!({"KHR_materials_variants": {"variants": [{"name": "summer"}, {"name": "winter"}, {"name": "snow"}]}});
    let path = glb(&document, folder.path(), "variants.glb");
    let baked = bake(&path, &folder.path().join("out.glb")).unwrap();
    // Which colour it keeps, and which the skin has.
    let words = ["\"Brown\", #957c59", "\"White\", #ffffff, in winter, snow"];
    assert!(says(&baked.warnings, &words), "{:?}", baked.warnings);
    assert!(!says(&baked.warnings, &["summer"]));
    assert!(close(hair_colour(&path), [0.3, 0.2, 0.1]));
    // Variants that change all but the colour change nothing of fur.
    document.json["materials"][1] = json!({"name": "Rough", "pbrMetallicRoughness": {"baseColorFactor": [0.3, 0.2, 0.1, 1], "roughnessFactor": 0.2}});
    let rough = bake(&glb(&document, folder.path(), "rough.glb"), &folder.path().join("out.glb")).unwrap();
    assert!(!says(&rough.warnings, &["variants"]), "{:?}", rough.warnings);
}

#[test]
fn shells_over_unlit_skin_are_unlit() {
    for unlit in [false, true] {
        let mut material = json!({"name": "Fur"});
        if unlit {
            material["extensions"] = json!({"KHR_materials_unlit": {}});
        }
        let asset = loaded(plane(material, &[]));
        let coat = crate::made::coat_for(&asset);
        let coated = with_coat(&asset, &coat, Fallback::Shells(2)).unwrap();
        let shells = coated.json["materials"].as_array().unwrap()[1..].iter();
        let worn: Vec<bool> = shells.map(|m| m["extensions"]["KHR_materials_unlit"].is_object()).collect();
        // Tiles that nothing wears are lit.
        assert_eq!(worn.iter().filter(|worn| **worn).count() >= 4, unlit, "{worn:?}");
    }
}
