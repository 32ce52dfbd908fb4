//! Files of older versions of the extension.

use crate::one_skin::{baked, thin, write};
use furrier::asset::coat::coat_of;
use furrier::asset::{self, Asset, Document, Fallback};
use furrier::bake::Method;
use furrier::data::coat::{Coat, CoatPrimitive};
use furrier::data::shell::code_above;
use serde_json::json;

/// What a coat primitive is in the test of files of older versions.
fn old(coat: &Coat) -> Coat {
    let plain =
        |p: &CoatPrimitive| CoatPrimitive { normal: vec![], colour: None, painted: None, longest: vec![], ..p.clone() };
    Coat { primitives: coat.primitives.iter().map(plain).collect(), ..coat.clone() }
}

#[test]
fn files_of_older_versions_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let input = write(&asset::load("sample:sphere").unwrap().document, folder.path(), "in.glb");
    let (_, coat) = baked(&input, &folder.path().join("out.glb"), &thin(&[]), Method::Lapped);
    let asset = asset::load(&input.to_string_lossy()).unwrap();
    let old = old(&coat);
    let mut document = furrier::asset::coat::with_coat(&asset, &old, Fallback::None).unwrap();
    let read = |document: &Document| coat_of(&Asset::new(document.clone(), vec![]).unwrap()).unwrap();
    assert!(read(&document) == old);
    // Versions 1 and 2 say what light comes through where 3 says how much hair lies above, and have one row of gains for all layers.
    let mut expected = old.clone();
    for tile in &mut expected.tiles {
        let fin = tile.fin.tangent.iter_mut();
        for image in tile.shells.albedo.iter_mut().flatten().chain(fin) {
            let alphas = image.pixels.iter_mut().skip(3).step_by(4);
            alphas.for_each(|byte| *byte = code_above(-(f32::from(*byte) / 255.0).max(1e-3).ln()));
        }
        tile.shells.gains.iter_mut().for_each(|mip| *mip = vec![mip[1]; mip.len()]);
    }
    for tile in document.json["extensions"]["FURRIER_mesh_fur"]["tiles"].as_array_mut().unwrap() {
        for mip in tile["shells"]["gains"].as_array_mut().unwrap() {
            *mip = mip[1].take();
        }
    }
    for version in [1, 2] {
        document.json["extensions"]["FURRIER_mesh_fur"]["version"] = json!(version);
        assert!(read(&document) == expected, "version {version}");
    }
    document.json["extensions"]["FURRIER_mesh_fur"]["version"] = json!(4);
    let error = coat_of(&Asset::new(document, vec![]).unwrap()).unwrap_err().to_string();
    assert!(error.contains("1 to 3"), "{error}");
}
