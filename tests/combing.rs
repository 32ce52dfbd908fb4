//! Coats made longer or laid down as a whole.

use crate::viewer::{creature, small};
use furrier::math::Vec3;
use furrier::runtime::{CoatMesh, DrawList};
use furrier::viewer;
use furrier::viewer::{Combing, step_texels};

/// Upright hair of a metre, hair that leans by 30° along x, and none.
fn hair() -> DrawList<'static> {
    let leaning = Vec3::new(0.5, 0.0, 0.75_f32.sqrt());
    // Far apart, each on a flat triangle of its own.
    let corners = |i: usize| [0, 1, 2].map(|k| Vec3::new(10.0 * i as f32 + (k % 2) as f32, (k / 2) as f32, 0.0));
    let fur = CoatMesh {
        normals: vec![Vec3::Z; 9],
        positions_m: (0..3).flat_map(corners).collect(),
        offsets_m: [Vec3::Z, leaning, Vec3::ZERO].into_iter().flat_map(|offset_m| [offset_m; 3]).collect(),
        triangles: &[[0, 1, 2], [3, 4, 5], [6, 7, 8]],
        ..CoatMesh::default()
    };
    DrawList { furs: vec![fur], ..DrawList::default() }
}

#[test]
fn hair_is_as_long_and_leans_as_far_as_it_is_told() {
    for (length, slant_deg) in [(1.0, 45.0), (2.5, 20.0), (0.5, -20.0), (1.0, 75.0)] {
        let mut scene = hair();
        Combing::new(length, slant_deg).unwrap().comb(&mut scene);
        let [upright, leaning, none] = [0, 3, 6].map(|v| scene.furs[0].offsets_m[v]);
        assert_eq!(none, Vec3::ZERO);
        for offset in [upright, leaning] {
            assert!((offset.length() - length).abs() < 1e-5, "{length}, {slant_deg}: {offset}");
        }
        let lean_deg = |towards: Vec3, offset: Vec3| offset.dot(towards).atan2(offset.z).to_degrees();
        assert!((lean_deg(Vec3::NEG_Y, upright) - slant_deg).abs() < 1e-3, "{upright}");
        assert!((lean_deg(Vec3::X, leaning) - (30.0 + slant_deg).min(80.0)).abs() < 1e-3, "{leaning}");
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
        fur.offsets_m = vec![Vec3::Z * tile.height_m; 9];
        Combing::new(length, slant_deg).unwrap().comb(&mut scene);
        step_texels(&scene)
    };
    let slab_texels = tile.height_m / tile.shells.layers as f32 * tile.shells.size as f32 / tile.edge_m;
    assert_eq!(step(1.0, 0.0), 0.0);
    assert!((step(1.0, 30.0) / (0.5 * slab_texels) - 1.0).abs() < 1e-4);
    assert!((step(2.0, 30.0) / slab_texels - 1.0).abs() < 1e-4);
}

/// Two walls that meet in a valley along y: hair on each that lies down towards the other would run under its skin.
#[test]
fn hair_that_is_laid_into_a_crease_gives_way() {
    let at = |x: f32, y: f32| Vec3::new(x, y, 1.2 * x.abs());
    let (columns, rows) = (21_u32, 5_u32);
    let positions_m: Vec<Vec3> = (0..rows)
        .flat_map(|row| (0..columns).map(move |column| (row, column)))
        .map(|(row, column)| at(0.1 * (column as f32 - 10.0), row as f32))
        .collect();
    let quads = (0..rows - 1).flat_map(|row| (0..columns - 1).map(move |column| row * columns + column));
    let triangles: Vec<[u32; 3]> =
        quads.flat_map(|a| [[a, a + 1, a + columns], [a + 1, a + columns + 1, a + columns]]).collect();
    let slope = Vec3::new(-1.2, 0.0, 1.0).normalize();
    let normals: Vec<Vec3> = positions_m.iter().map(|p| Vec3::new(slope.x * p.x.signum(), 0.0, slope.z)).collect();
    // Short hair, leaning a little downhill.
    let down = |p: &Vec3, n: &Vec3| (*n + Vec3::new(-0.3 * p.x.signum(), 0.0, 0.0)).normalize() * 0.5;
    let offsets_m = positions_m.iter().zip(&normals).map(|(p, n)| down(p, n)).collect();
    let fur = CoatMesh { positions_m, normals, offsets_m, triangles: &triangles, ..CoatMesh::default() };
    let mut scene = DrawList { furs: vec![fur], ..DrawList::default() };
    Combing::new(1.0, 60.0).unwrap().comb(&mut scene);
    let fur = &scene.furs[0];
    let mut under = 0;
    for (p, offset_m) in fur.positions_m.iter().zip(&fur.offsets_m) {
        let middle = *p + *offset_m * 0.5;
        under += usize::from(middle.z < 1.2 * middle.x.abs());
    }
    assert_eq!(under, 0, "of {} hairs", fur.positions_m.len());
}
