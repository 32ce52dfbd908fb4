//! A coat in a file: written, read back, validated, and everything else left as it was.

use crate::common::shared;
use crate::made::{coat_for, tile};
use ::ktx2 as ktx2_reader;
use furrier::asset::coat::{NAME, with_coat};
use furrier::asset::{self, Asset, Document, Fallback, ktx2, read_coat, write_coat};
use furrier::data::image::Image8;
use furrier::math::hash::Stream;
use serde_json::Value;
use std::path::Path;

fn sample(name: &str) -> Asset {
    asset::load(&format!("sample:{name}")).expect("a sample loads")
}

/// Writes a made coat and gives the file.
fn written(asset: &Asset, fallback: Fallback, folder: &Path, name: &str) -> std::path::PathBuf {
    let out = folder.join(name);
    write_coat(asset, &coat_for(asset), fallback, &out).expect("a coat can be written");
    out
}

#[test]
fn a_coat_comes_back_as_it_was_written() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["creature", "torus"] {
        let asset = sample(name);
        for (fallback, file) in
            [(Fallback::None, "a.glb"), (Fallback::Shells(3), "b.glb"), (Fallback::Shells(8), "c.gltf")]
        {
            let (read, coat) = read_coat(&written(&asset, fallback, folder.path(), file)).expect("it can be read");
            assert_eq!(coat, coat_for(&asset), "{name} as {file}");
            assert_eq!(read.parts.len(), asset.parts.len(), "shells of the fallback are not parts");
        }
    }
}

#[test]
fn windings_survive_a_mirroring_node() {
    let mut document = sample("plane").document;
    document.json["nodes"][0]["scale"] = serde_json::json!([-1.0, 1.0, 1.0]);
    let asset = Asset::new(document, Vec::new()).expect("a mirrored plane");
    let mesh = asset.parts[0].mesh(1.0).expect("a mesh");
    assert!(
        (0..mesh.triangles.len()).all(|t| mesh.area_vector_m2(t).y > 0.0),
        "triangles face out of the mirrored skin"
    );
    let folder = tempfile::tempdir().expect("a folder");
    let out = written(&asset, Fallback::None, folder.path(), "a.glb");
    let (read, coat) = read_coat(&out).expect("it can be read");
    assert_eq!(coat, coat_for(&asset));
    let stored = read.document.json["meshes"][0]["primitives"][0]["extensions"][NAME]["indices"].as_u64();
    let indices = read.document.integers(stored.expect("an accessor") as usize, 1).expect("indices");
    let triangle = coat.primitives[0].triangles[0];
    assert_eq!(indices[..3], [triangle[0], triangle[2], triangle[1]], "as the primitive's own space winds");
}

/// What of `after` was not in `before`, though it should be the same but for what a coat adds.
fn changes(before: &Value, after: &Value, path: &str, found: &mut Vec<String>) {
    match (before, after) {
        (Value::Object(b), Value::Object(a)) => {
            for (key, value) in b {
                match a.get(key) {
                    Some(other) => changes(value, other, &format!("{path}.{key}"), found),
                    None => found.push(format!("{path}.{key} is gone")),
                }
            }
            let added = |key: &String| {
                !(b.contains_key(key) || path.is_empty() || ["extensions", "children"].contains(&key.as_str()))
            };
            found.extend(a.keys().filter(|k| added(k) && *k != NAME).map(|k| format!("{path}.{k} is new")));
        }
        (Value::Array(b), Value::Array(a)) => {
            // What is new stands behind what was there.
            if a.len() < b.len() {
                found.push(format!("{path} is shorter"));
            }
            b.iter().zip(a).enumerate().for_each(|(i, (b, a))| changes(b, a, &format!("{path}[{i}]"), found));
        }
        _ if before != after && path != ".buffers[0].byteLength" => {
            found.push(format!("{path}: {before} became {after}"))
        }
        _ => {}
    }
}

fn all_changes(before: &Document, after: &Document) -> Vec<String> {
    let mut found = Vec::new();
    changes(&before.json, &after.json, "", &mut found);
    let kept = after.binary.get(..before.binary.len()).is_some_and(|bytes| bytes == before.binary);
    if !kept {
        found.push("the bytes of the buffer".into());
    }
    found
}

#[test]
fn everything_else_comes_through_unchanged() {
    let mut assets = vec![sample("creature")];
    if let Some(folder) = shared() {
        let real = ["real/Fox.glb", "real/MorphStressTest.glb", "real/quaternius_ShibaInu.glb"];
        let hard =
            ["hard/cameras_lights.glb", "hard/unicode_names.glb", "hard/quantized.glb", "hard/instanced_nodes.glb"];
        assets.extend(
            real.iter().chain(&hard).map(|f| asset::load(&folder.join(f).to_string_lossy()).expect("it loads")),
        );
    }
    for asset in &assets {
        for fallback in [Fallback::None, Fallback::Shells(4)] {
            let coated = with_coat(asset, &coat_for(asset), fallback).expect("it takes a coat");
            assert_eq!(
                all_changes(&asset.document, &coated),
                Vec::<String>::new(),
                "{}",
                asset.document.name.display()
            );
        }
    }
}

#[test]
fn the_comparison_sees_a_planted_change() {
    let asset = sample("creature");
    let coated = with_coat(&asset, &coat_for(&asset), Fallback::None).expect("it takes a coat");
    let mut renamed = coated.clone();
    renamed.json["nodes"][0]["name"] = "other".into();
    let mut moved = coated.clone();
    moved.binary[17] ^= 1;
    let mut poorer = coated;
    poorer.json["animations"] = serde_json::json!([]);
    for planted in [renamed, moved, poorer] {
        assert_ne!(all_changes(&asset.document, &planted), Vec::<String>::new());
    }
}

#[test]
fn the_same_coat_gives_the_same_bytes() {
    let folder = tempfile::tempdir().expect("a folder");
    let asset = sample("creature");
    let [a, b] = ["a.glb", "b.glb"].map(|name| written(&asset, Fallback::Shells(4), folder.path(), name));
    assert_eq!(std::fs::read(a).expect("bytes"), std::fs::read(b).expect("bytes"));
}

#[test]
fn an_asset_with_a_coat_gets_no_second() {
    let folder = tempfile::tempdir().expect("a folder");
    let asset = sample("torus");
    let out = written(&asset, Fallback::None, folder.path(), "a.glb");
    let again = asset::load(&out.to_string_lossy()).expect("it loads");
    let error = with_coat(&again, &coat_for(&again), Fallback::None).expect_err("it wears a coat");
    assert!(error.what.contains("already") && error.hint.is_some());
}

#[test]
fn an_independent_reader_agrees_about_our_ktx2() {
    let mut stream = Stream::new(7);
    let mut image = |size: u32, channels: u32| {
        let mut image = Image8::new(size, size, channels);
        image.pixels.iter_mut().for_each(|p| *p = stream.bits() as u8);
        image
    };
    for (format, code, layers, array) in [
        (ktx2::Format::R8, ktx2_reader::Format::R8_UNORM, 3, true),
        (ktx2::Format::Rgba8, ktx2_reader::Format::R8G8B8A8_UNORM, 5, true),
        (ktx2::Format::Rgba8Srgb, ktx2_reader::Format::R8G8B8A8_SRGB, 1, false),
    ] {
        let mips: Vec<Vec<Image8>> =
            (0..4).map(|mip| (0..layers).map(|_| image(8 >> mip, format.channels())).collect()).collect();
        let borrowed: Vec<Vec<&Image8>> = mips.iter().map(|level| level.iter().collect()).collect();
        let bytes = ktx2::encode(&borrowed, format, array).expect("a texture");
        let reader = ktx2_reader::Reader::new(&bytes[..]).expect("an independent reader takes it");
        let header = reader.header();
        assert_eq!(
            (header.format, header.pixel_width, header.layer_count),
            (Some(code), 8, if array { layers } else { 0 })
        );
        assert_eq!(header.supercompression_scheme, Some(ktx2_reader::SupercompressionScheme::Zstandard));
        let srgb = format == ktx2::Format::Rgba8Srgb;
        let transfer = if srgb { ktx2_reader::TransferFunction::SRGB } else { ktx2_reader::TransferFunction::Linear };
        assert_eq!(reader.transfer_function(), Some(transfer));
        let block = reader.basic_dfd().expect("a basic descriptor");
        assert_eq!(block.sample_information.len(), format.channels() as usize);
        for (level, expected) in reader.levels().zip(&mips) {
            let texels =
                zstd::bulk::decompress(level.data, level.uncompressed_byte_length as usize).expect("Zstandard");
            let expected: Vec<u8> = expected.iter().flat_map(|image| &image.pixels).copied().collect();
            assert_eq!(texels, expected);
        }
        assert_eq!(ktx2::decode(&bytes, format).expect("our reader"), mips);
        for cut in [0, 11, 40, 79, 100, bytes.len() - 1] {
            ktx2::decode(&bytes[..cut], format).expect_err("a cut texture is refused");
        }
    }
}

#[test]
fn fallback_shells_get_denser_inwards_and_keep_the_stack_opacity() {
    let stack = tile(3).shells;
    let opacity = |count: u32| {
        let shells = asset::coat::flatten_shells(&stack, 0.01, count);
        let clear =
            |texel: usize| shells.iter().map(|s| 1.0 - f64::from(s.1.pixels[4 * texel + 3]) / 255.0).product::<f64>();
        let texels = (stack.size * stack.size) as usize;
        1.0 - (0..texels).map(clear).sum::<f64>() / texels as f64
    };
    let (all, few) = (opacity(stack.layers - 1), opacity(2));
    assert!((all - few).abs() < 0.01, "{all} with every slab, {few} with two shells");
    assert!(all > 0.1 && all < 0.99, "{all} tells nothing");
}
