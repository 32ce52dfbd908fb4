//! How large a file's unit is taken to be: by what is furred, not by what stands around it.

use crate::common::shared;
use crate::meshes;
use furrier::asset::{self, Asset, Document, Fallback};
use furrier::bake::units::{Scale, Units, scale};
use furrier::bake::{Baked, Method, Request, bake};
use furrier::coat::summary::summarise;
use furrier::math::Vec3;
use furrier::preset::Preset;
use serde_json::{Value, json};
use std::path::Path;

/// Points and triangles of one material.
#[derive(Clone)]
struct Piece {
    material: &'static str,
    points: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

/// A ball, whose box has a diagonal of `radius` · 2 √3.
fn ball(material: &'static str, centre: Vec3, radius: f32) -> Piece {
    let mesh = meshes::sphere(6, radius);
    let points = mesh.positions_m.iter().map(|p| *p + centre).collect();
    Piece { material, points, triangles: mesh.triangles }
}

/// A square of this edge on the ground.
fn square(material: &'static str, edge: f32) -> Piece {
    let corners = [[-0.5, 0.0, -0.5], [-0.5, 0.0, 0.5], [0.5, 0.0, 0.5], [0.5, 0.0, -0.5]];
    let points = corners.map(|p| Vec3::from(p) * edge).to_vec();
    Piece { material, points, triangles: vec![[0, 1, 2], [0, 2, 3]] }
}

fn floats(document: &mut Document, points: &[Vec3]) -> usize {
    let bytes: Vec<u8> = points.iter().flat_map(|p| p.to_array()).flat_map(f32::to_le_bytes).collect();
    let view = document.push_view(&bytes, Some(34962));
    let [low, high] = [Vec3::min, Vec3::max].map(|of| points.iter().copied().reduce(of).unwrap().to_array());
    let accessor = json!({"bufferView": view, "componentType": 5126, "count": points.len(), "type": "VEC3",
        "min": low, "max": high});
    document.push("accessors", accessor)
}

fn primitive(document: &mut Document, piece: &Piece, skinned: bool) -> Value {
    let material = document.push("materials", json!({"name": piece.material}));
    let mut attributes = json!({"POSITION": floats(document, &piece.points)});
    if skinned {
        let n = piece.points.len();
        let view = document.push_view(&vec![0; 4 * n], Some(34962));
        let joints = json!({"bufferView": view, "componentType": 5121, "count": n, "type": "VEC4"});
        attributes["JOINTS_0"] = document.push("accessors", joints).into();
        let weights: Vec<u8> = [1.0, 0.0, 0.0, 0.0].repeat(n).into_iter().flat_map(f32::to_le_bytes).collect();
        let view = document.push_view(&weights, Some(34962));
        let weights = json!({"bufferView": view, "componentType": 5126, "count": n, "type": "VEC4"});
        attributes["WEIGHTS_0"] = document.push("accessors", weights).into();
    }
    let bytes: Vec<u8> = piece.triangles.iter().flatten().copied().flat_map(u32::to_le_bytes).collect();
    let view = document.push_view(&bytes, Some(34963));
    let indices =
        json!({"bufferView": view, "componentType": 5125, "count": 3 * piece.triangles.len(), "type": "SCALAR"});
    let indices = document.push("accessors", indices);
    json!({"attributes": attributes, "indices": indices, "material": material})
}

/// How the meshes of an asset hang together.
#[derive(Clone, Copy, PartialEq)]
enum Rig {
    /// Not at all.
    None,
    /// Each on a skin of its own; the joints of all hang on one.
    Skins,
    /// The first has a skin, the others hang on its joint.
    Rigid,
}

/// An asset of these meshes, each with its primitives.
fn made(meshes: &[Vec<Piece>], rig: Rig) -> Asset {
    let mut document = Document::made("made");
    // Node 0 is the joint that all hang on, and moves nothing; nodes 1, 2, … are joints below it.
    let below: Vec<usize> = (1..=meshes.len()).collect();
    document.push("nodes", json!({"name": "hips", "children": below}));
    for bone in &below {
        document.push("nodes", json!({"name": format!("bone {bone}")}));
    }
    let mut shown = vec![0];
    for (i, pieces) in meshes.iter().enumerate() {
        let skinned = rig == Rig::Skins || (rig == Rig::Rigid && i == 0);
        let primitives: Vec<Value> = pieces.iter().map(|piece| primitive(&mut document, piece, skinned)).collect();
        let mut node = json!({"mesh": document.push("meshes", json!({"primitives": primitives}))});
        if skinned {
            // The hips are a joint of the first skin alone.
            let joints = if i == 0 { vec![1, 0] } else { vec![i + 1] };
            node["skin"] = document.push("skins", json!({"joints": joints})).into();
        }
        let node = document.push("nodes", node);
        if rig == Rig::Rigid && i > 0 {
            document.json["nodes"][i + 1]["children"] = json!([node]);
        } else {
            shown.push(node);
        }
    }
    document.push("scenes", json!({"nodes": shown}));
    Asset::new(document, Vec::new()).unwrap()
}

fn scaled(asset: &Asset, preset: &str, materials: &[&str], units: Units) -> Scale {
    let materials: Vec<String> = materials.iter().map(|&m| m.to_owned()).collect();
    let chosen = asset::select(&asset.parts, &materials).unwrap().parts;
    scale(units, &Preset::load(preset).unwrap(), asset, &chosen, false).unwrap()
}

fn close(found: f64, expected: f64) {
    assert!((found / expected - 1.0).abs() < 1e-5, "{found} instead of {expected}");
}

const FOX_M: f64 = 1.2;
const MINK_M: f64 = 0.62;
/// Diagonal of the box around a ball of radius 1.
const BALL: f64 = 3.464_101_6;

#[test]
fn what_is_furred_is_as_large_as_the_animal() {
    let mut fur = ball("Fur", Vec3::X, 1.0);
    fur.points.push(Vec3::splat(900.0));
    let asset = made(&[vec![fur], vec![square("Ground", 60.0)], vec![ball("Eyes", Vec3::Y * 40.0, 9.0)]], Rig::None);
    let alone = scaled(&asset, "fox", &["Fur"], Units::Auto);
    close(alone.metres_per_unit, FOX_M / BALL);
    close(alone.diagonal_m, FOX_M);
    assert!(alone.note.unwrap().contains("as large as the fox"));
    assert_eq!(alone.warnings, Vec::<String>::new());
    let literal = scaled(&asset, "fox", &["Fur"], Units::Centimetres);
    close(literal.diagonal_m, 0.01 * BALL);
    assert_eq!((literal.note, literal.warnings), (None, vec![]));
}

#[test]
fn furred_parts_are_measured_together() {
    let balls = [0.0, 10.0].map(|x| vec![ball("Fur", Vec3::X * x, 1.0)]);
    let both = scaled(&made(&balls, Rig::None), "fox", &[], Units::Auto);
    close(both.metres_per_unit, FOX_M / f64::from(Vec3::new(12.0, 2.0, 2.0).length()));
}

#[test]
fn a_speck_far_off_does_not_decide() {
    let mut fur = ball("Fur", Vec3::ZERO, 1.0);
    let speck = ball("Fur", Vec3::new(50.0, -70.0, 0.0), 0.01);
    let first = fur.points.len() as u32;
    fur.triangles.extend(speck.triangles.iter().map(|t| t.map(|v| v + first)));
    fur.points.extend(speck.points);
    let specked = scaled(&made(&[vec![fur]], Rig::None), "fox", &[], Units::Auto);
    close(specked.metres_per_unit, FOX_M / BALL);
    assert!(matches!(&specked.warnings[..], [told] if told.contains("specks")), "{:?}", specked.warnings);
    // A tail, thin as it is, is no speck: a hundredth as wide as the body and twice as long.
    let mut tailed = ball("Fur", Vec3::ZERO, 1.0);
    let first = tailed.points.len() as u32;
    for i in 0..=40 {
        tailed.points.extend([-0.01, 0.01].map(|y| Vec3::new(1.0 + 0.1 * i as f32, y, 0.0)));
        let a = first + 2 * i;
        tailed.triangles.extend((i < 40).then_some([a, a + 2, a + 1]));
        tailed.triangles.extend((i < 40).then_some([a + 1, a + 2, a + 3]));
    }
    let tailed = scaled(&made(&[vec![tailed]], Rig::None), "fox", &[], Units::Auto);
    close(tailed.diagonal_m, FOX_M);
    close(tailed.metres_per_unit, FOX_M / f64::from(Vec3::new(6.0, 2.0, 2.0).length()));
    assert!(tailed.warnings.is_empty(), "{:?}", tailed.warnings);
}

/// A body of radius `radius`, and a hat a quarter as large on it.
fn hatted(radius: f32, rig: Rig) -> Asset {
    let (body, hat) = (ball("Skin", Vec3::ZERO, radius), ball("Hat", Vec3::Y * 0.5 * radius, 0.25 * radius));
    made(&[vec![body], vec![hat]], rig)
}

#[test]
fn a_small_part_of_a_figure_takes_the_files_unit() {
    let one_mesh = made(&[vec![ball("Skin", Vec3::ZERO, 0.5), ball("Hat", Vec3::Y * 0.2, 0.1)]], Rig::None);
    for asset in [one_mesh, hatted(0.5, Rig::Skins), hatted(0.5, Rig::Rigid)] {
        let hat = scaled(&asset, "mink", &["Hat"], Units::Auto);
        close(hat.metres_per_unit, 1.0);
        assert!(hat.note.is_none());
        let [told] = &hat.warnings[..] else { panic!("{:?}", hat.warnings) };
        for part in ["small part of a figure", "0.62 m across", "figure 1.73 m across", "`units`", "`set`"] {
            assert!(told.contains(part), "{part:?} is not in {told}");
        }
        assert!(scaled(&asset, "mink", &["Hat"], Units::Metres).warnings.is_empty());
        // Most of the figure is the animal.
        let all = scaled(&asset, "mink", &["Skin"], Units::Auto);
        close(all.diagonal_m, MINK_M);
        assert!(all.warnings.is_empty(), "{:?}", all.warnings);
    }
}

#[test]
fn a_hat_for_itself_is_as_large_as_the_preset_says() {
    let hat = scaled(&hatted(0.5, Rig::None), "mink", &["Hat"], Units::Auto);
    close(hat.diagonal_m, MINK_M);
    assert!(hat.warnings.is_empty(), "{:?}", hat.warnings);
}

#[test]
fn a_figures_unit_is_the_one_that_makes_it_plausible() {
    for (radius, metres_per_unit, unit) in [(60.0, 0.01, "centimetre"), (600.0, 0.001, "millimetre")] {
        let hat = scaled(&hatted(radius, Rig::Skins), "mink", &["Hat"], Units::Auto);
        close(hat.metres_per_unit, metres_per_unit);
        assert!(hat.warnings[0].contains(unit), "{:?}", hat.warnings);
    }
    for radius in [0.001, 1e5] {
        let hat = scaled(&hatted(radius, Rig::Skins), "mink", &["Hat"], Units::Auto);
        close(hat.diagonal_m, MINK_M);
        assert!(hat.warnings[0].contains("figure is 2.48 m across"), "{:?}", hat.warnings);
    }
}

#[test]
fn ground_that_would_be_furred_is_told_of() {
    let asset = made(&[vec![ball("Fur", Vec3::Y, 1.0)], vec![square("Moss", 60.0)]], Rig::None);
    let both = scaled(&asset, "fox", &[], Units::Auto);
    assert!(matches!(&both.warnings[..], [told] if told.contains("\"Moss\" is flat and 24 times")), "{both:?}");
    // By its name it is bare, and not measured.
    let named = made(&[vec![ball("Fur", Vec3::Y, 1.0)], vec![square("Ground", 60.0)]], Rig::None);
    assert!(scaled(&named, "fox", &[], Units::Auto).warnings.is_empty());
    let rug = made(&[vec![ball("Fur", Vec3::Y, 1.0)], vec![square("Rug", 4.0)]], Rig::None);
    assert!(scaled(&rug, "fox", &[], Units::Auto).warnings.is_empty());
}

/// A bake of few texels and hairs.
fn baked(input: &Path, materials: &[&str], preset: &str) -> (Asset, Baked) {
    let folder = tempfile::tempdir().unwrap();
    let few = ["guard.density_per_cm2=20", "undercoat.density_per_cm2=100", "shells.layers=4", "shells.tile_mm=8"];
    let few = few.into_iter().chain(["shells.texture_size=16", "fins.texture_width=16", "fins.texture_height=16"]);
    let request = Request {
        input: input.to_string_lossy().into(),
        reading: Default::default(),
        out: folder.path().join("out.glb"),
        preset: Preset::load(preset).unwrap().with_settings(&few.map(str::to_owned).collect::<Vec<_>>()).unwrap(),
        presets: vec![],
        materials: materials.iter().map(|&m| m.to_owned()).collect(),
        units: Units::Auto,
        method: Method::Lapped,
        seed: 0,
        fallback: Fallback::None,
        judge: false,
        cache: None,
        draft: false,
    };
    let baked = bake(&request, &mut |_| {}).unwrap();
    (asset::load(&request.input).unwrap(), baked)
}

/// The longest offset of the coat, units of the world.
fn longest_units(asset: &Asset, baked: &Baked) -> f64 {
    let mut longest = 0.0_f64;
    for primitive in &baked.coat.primitives {
        let part = asset.parts.iter().find(|p| (p.mesh, p.primitive) == (primitive.mesh, primitive.primitive)).unwrap();
        for (offset, &v) in primitive.offset.iter().zip(&primitive.base_vertex) {
            longest = longest.max((part.world_from_local(v as usize) * offset.as_dvec3()).length());
        }
    }
    longest
}

#[test]
fn hair_is_as_long_with_a_ground_as_without() {
    let Some(input) = shared().map(|shared| shared.join("wild/with_ground.glb")) else { return };
    let folder = tempfile::tempdir().unwrap();
    let alone = folder.path().join("alone.glb");
    let mut document = asset::load(&input.to_string_lossy()).unwrap().document;
    document.json["scenes"] = json!([{"nodes": [0]}]);
    std::fs::write(&alone, document.to_glb().unwrap()).unwrap();
    let longest = [(&input, &["Fur"][..]), (&alone, &[])].map(|(input, materials)| {
        let (asset, baked) = baked(input, materials, "fox");
        assert!(baked.warnings.iter().all(|w| !w.contains("flat") && !w.contains("figure")), "{:?}", baked.warnings);
        close(baked.diagonal_m, FOX_M);
        longest_units(&asset, &baked)
    });
    println!("{longest:?} units of the file");
    close(longest[0], longest[1]);
}

#[test]
fn sixty_meshes_have_the_right_hair_and_a_note_on_their_draw_calls() {
    let Some(input) = shared().map(|shared| shared.join("wild/sixty_meshes_cm.glb")) else { return };
    let (asset, baked) = baked(&input, &[], "fox");
    let share = f64::from(baked.coat.tiles[0].height_m) / FOX_M;
    let found = longest_units(&asset, &baked) / asset.diagonal_units;
    println!("longest hair {found:.5} of the diagonal, the fox's {share:.5}");
    assert!((0.8..=1.001).contains(&(found / share)), "{found} of the diagonal, not {share}");
    assert_eq!(summarise(&baked.coat).draw_calls, 240);
    let told = baked.notes.iter().find(|note| note.contains("240 draw calls over 60 primitives"));
    let told = told.unwrap_or_else(|| panic!("{:?}", baked.notes));
    assert!(told.contains("joined") && told.contains("`set` shells.layers"), "{told}");
}

#[test]
fn a_persons_hat_is_told_from_a_mink_and_real_animals_are_left_in_peace() {
    let Some(shared) = shared() else { return };
    let folder = tempfile::tempdir().unwrap();
    for name in ["avatar0", "avatar1"] {
        let copy = folder.path().join(name).with_extension("glb");
        std::fs::write(&copy, std::fs::read(shared.join(format!("wild/{name}.vrm"))).unwrap()).unwrap();
        let asset = asset::load(&copy.to_string_lossy()).unwrap();
        let hat = scaled(&asset, "mink", &["Hat"], Units::Auto);
        println!("{name}: {:?}", hat.warnings);
        close(hat.metres_per_unit, 1.0);
        assert!(hat.warnings[0].contains("figure 2.31 m across"), "{:?}", hat.warnings);
    }
    for (name, preset) in [("Fox", "fox"), ("quaternius_Deer", "fox"), ("quaternius_ShibaInu", "fox")] {
        let asset = asset::load(&shared.join(format!("real/{name}.glb")).to_string_lossy()).unwrap();
        let scale = scaled(&asset, preset, &[], Units::Auto);
        println!(
            "{name}: {} m per unit, {} of the whole",
            scale.metres_per_unit,
            scale.diagonal_m / scale.metres_per_unit / asset.diagonal_units
        );
        assert!(scale.warnings.is_empty(), "{name}: {:?}", scale.warnings);
        close(scale.diagonal_m, FOX_M);
    }
}
