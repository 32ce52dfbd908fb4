//! Coats made longer or laid down as a whole.

use crate::viewer::{creature, small};
use furrier::math::Vec3;
use furrier::runtime::{CoatMesh, Combing, DrawList, step_texels};
use furrier::viewer;

/// Upright hair of a metre, hair that leans by 30° along x, and none.
fn hair() -> DrawList<'static> {
    let leaning = Vec3::new(0.5, 0.0, 0.75_f32.sqrt());
    let fur = CoatMesh {
        normals: vec![Vec3::Z; 3],
        positions_m: vec![Vec3::ZERO; 3],
        offsets_m: vec![Vec3::Z, leaning, Vec3::ZERO],
        ..CoatMesh::default()
    };
    DrawList { furs: vec![fur], ..DrawList::default() }
}

#[test]
fn hair_is_as_long_and_leans_as_far_as_it_is_told() {
    for (length, slant_deg) in [(1.0, 45.0), (2.5, 20.0), (0.5, -20.0), (1.0, 75.0)] {
        let mut scene = hair();
        Combing::new(length, slant_deg).unwrap().comb(&mut scene);
        let [upright, leaning, none] = scene.furs[0].offsets_m[..] else { panic!("three hairs") };
        assert_eq!(none, Vec3::ZERO);
        for offset in [upright, leaning] {
            assert!((offset.length() - length).abs() < 1e-5, "{length}, {slant_deg}: {offset}");
        }
        let lean_deg = |towards: Vec3, offset: Vec3| offset.dot(towards).atan2(offset.z).to_degrees();
        assert!((lean_deg(Vec3::NEG_Y, upright) - slant_deg).abs() < 1e-3, "{upright}");
        assert!((lean_deg(Vec3::X, leaning) - (30.0 + slant_deg).min(85.0)).abs() < 1e-3, "{leaning}");
    }
}

#[test]
fn a_coat_that_is_not_combed_anew_keeps_its_bits() {
    let mut scene = hair();
    Combing::default().comb(&mut scene);
    assert_eq!(scene.furs[0].offsets_m, hair().furs[0].offsets_m);
    for (length, slant_deg) in [(0.0, 0.0), (f32::NAN, 0.0), (1.0, 90.0), (1.0, f32::NAN)] {
        Combing::new(length, slant_deg).unwrap_err();
    }
}

#[test]
fn a_longer_coat_reaches_further_and_a_slanted_one_less_far() {
    let (asset, coat) = creature();
    let covered = |length, slant_deg| {
        let combing = Combing::new(length, slant_deg).unwrap();
        viewer::screenshot(&asset, &coat, &viewer::ViewOptions { combing, ..small() }).unwrap().picture.coverage()
    };
    let [as_baked, longer, slanted] =
        [(1.0, 0.0), (2.0, 0.0), (1.0, 70.0)].map(|(length, slant)| covered(length, slant));
    assert!(longer > 1.02 * as_baked && slanted < 0.995 * as_baked, "{as_baked} {longer} {slanted}");
}

#[test]
fn slabs_step_along_the_skin_by_lean_and_length() {
    let (_, coat) = creature();
    let tile = &coat.tiles[0];
    let step = |length: f32, slant_deg: f32| {
        let mut scene = DrawList { tiles: &coat.tiles, ..hair() };
        let fur = &mut scene.furs[0];
        (fur.offsets_m, fur.normals, fur.positions_m) =
            (vec![Vec3::Z * tile.height_m], vec![Vec3::Z], vec![Vec3::ZERO]);
        Combing::new(length, slant_deg).unwrap().comb(&mut scene);
        step_texels(&scene)
    };
    let slab_texels = tile.height_m / tile.shells.layers as f32 * tile.shells.size as f32 / tile.edge_m;
    assert_eq!(step(1.0, 0.0), 0.0);
    assert!((step(1.0, 30.0) / (0.5 * slab_texels) - 1.0).abs() < 1e-4);
    assert!((step(2.0, 30.0) / slab_texels - 1.0).abs() < 1e-4);
}
