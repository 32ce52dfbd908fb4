//! Inputs as people have them, each with what a user would call right of it.

use crate::common::{framing, shared, studio};
use crate::one_skin::{baked, grown, thin};
use furrier::asset::{self, Asset};
use furrier::bake::Method;
use furrier::data::coat::Coat;
use furrier::hybrid::Settings;
use furrier::math::Vec3;
use furrier::stage::camera::Viewpoint;
use furrier::viewer::{self, ViewOptions};
use std::path::PathBuf;

fn wild(name: &str) -> Option<PathBuf> {
    shared().map(|shared| shared.join("wild").join(name))
}

/// The base colour of a file at a texture coordinate.
fn base_colour(asset: &Asset) -> impl Fn(furrier::math::Vec2) -> Vec3 {
    let texture = asset.parts[0].base_colour.texture.clone().expect("a texture");
    let image = asset.document.decode_image(texture.image).unwrap().expect("a picture");
    move |uv| texture.sample(&image, uv).truncate()
}

#[test]
fn a_leopard_keeps_its_spots() {
    let Some(path) = wild("leopard_low.glb") else { return };
    let folder = tempfile::tempdir().unwrap();
    let preset = thin(&["colour.variation=0", "colour.guard=[[1,1,1],[1,1,1],[1,1,1]]"]);
    let asset = asset::load(&path.to_string_lossy()).unwrap();
    let colour = base_colour(&asset);
    // Every hair has the texture's colour at its root. Roots are looked up in the mesh that the volume has, whose corners keep their
    // texture coordinates.
    let grown = grown(&path, &preset);
    let scene = grown.scene();
    let strands = scene.guard.unwrap().0;
    let uv = &scene.skin.uv_sets[0];
    let (mut dark, mut bright) = (0, 0);
    for (root, tint) in strands.roots.iter().zip(&strands.tint) {
        let [p, q, r] = scene.skin.triangles[root.triangle as usize].map(|v| uv[v as usize]);
        let [x, y] = root.barycentric;
        let expected = colour(p * x + q * y + r * (1.0 - x - y));
        assert!((*tint - expected).abs().max_element() < 2e-3, "{tint} instead of {expected}");
        dark += usize::from(tint.max_element() < 0.05);
        bright += usize::from(tint.x > 0.4);
    }
    assert!(dark * 50 > strands.len() && bright * 3 > strands.len(), "{dark} and {bright} of {}", strands.len());

    // The coat names the material's own texture, and its tint does not smear it.
    let (_, coat) = baked(&path, &folder.path().join("tiled.glb"), &preset, Method::Lapped);
    assert_eq!(coat.primitives[0].colour, asset.parts[0].base_colour.texture);
    assert!(coat.primitives[0].tint.iter().all(|tint| tint.truncate() == Vec3::ONE));
    // The fallback has dark and bright vertices, many more than the skin.
    let fallback = asset::load(&folder.path().join("tiled.glb").to_string_lossy()).unwrap();
    let colours = &fallback.document.json["meshes"][1]["primitives"][0]["attributes"]["COLOR_0"];
    let colours = fallback.document.floats(colours.as_u64().unwrap() as usize, 4).unwrap();
    let dark = colours.chunks(4).filter(|c| c[0] < 0.1).count();
    assert!(colours.len() / 4 > 2 * 1500 && dark > 200, "{dark} dark ones of {}", colours.len() / 4);
    // The atlas holds both in its texels.
    let (_, coat) = baked(&path, &folder.path().join("atlas.glb"), &preset, Method::Atlas { texels: Some(256) });
    let slab = &coat.tiles[0].shells.albedo[0][1];
    let medium = &coat.tiles[0].shells.medium[0][1];
    let haired = slab.pixels.chunks(4).zip(medium.pixels.chunks(4)).filter(|(_, m)| m[0] > 20).map(|(a, _)| a[0]);
    let reds: Vec<u8> = haired.collect();
    let count = |low: u8, high: u8| reds.iter().filter(|r| (low..=high).contains(r)).count() as f32 / reds.len() as f32;
    assert!(count(0, 70) > 0.02 && count(150, 255) > 0.3, "{} dark, {} bright", count(0, 70), count(150, 255));
}

#[test]
fn a_ball_in_two_primitives_is_a_ball() {
    let Some(path) = wild("ball_in_two_primitives.glb") else { return };
    let folder = tempfile::tempdir().unwrap();
    let (asset, coat) = baked(&path, &folder.path().join("out.glb"), &thin(&[]), Method::Lapped);
    assert_eq!(coat.primitives.len(), 2);
    // At a place of both, hair leaves alike.
    let mut at: std::collections::BTreeMap<[u32; 3], Vec<[u32; 3]>> = std::collections::BTreeMap::new();
    let bits = |v: Vec3| v.to_array().map(|x| (x + 0.0).to_bits());
    for primitive in &coat.primitives {
        let part = asset.parts.iter().find(|part| part.primitive == primitive.primitive).unwrap();
        for &v in primitive.triangles.iter().flatten() {
            let place = part.stored.positions[primitive.base_vertex[v as usize] as usize];
            at.entry(bits(place)).or_default().push(bits(primitive.offset[v as usize]));
        }
    }
    assert!(at.values().all(|offsets| offsets.iter().all(|o| *o == offsets[0])), "offsets differ at one place");
    // And normals are a ball's, whoever's triangles are around.
    for primitive in &coat.primitives {
        let part = asset.parts.iter().find(|part| part.primitive == primitive.primitive).unwrap();
        for (&base, normal) in primitive.base_vertex.iter().zip(&primitive.normal) {
            let radial = part.stored.positions[base as usize].normalize();
            assert!(normal.dot(radial) > 0.99, "{normal} at {radial}");
        }
    }
}

#[test]
fn a_double_sided_ear_has_fur_on_both_sides() {
    let Some(path) = wild("ear_double_sided.glb") else { return };
    let folder = tempfile::tempdir().unwrap();
    let (asset, coat) = baked(&path, &folder.path().join("out.glb"), &thin(&[]), Method::Lapped);
    let part = &asset.parts[0];
    let primitive = &coat.primitives[0];
    let base = |v: u32| primitive.base_vertex[v as usize] as usize;
    let mut sides = [0; 2];
    for &triangle in &primitive.triangles {
        let [p, q, r] = triangle.map(|v| part.stored.positions[base(v)]);
        let face = (q - p).cross(r - p);
        let normal: Vec3 = triangle.iter().map(|&v| part.stored.normals[base(v)]).sum();
        sides[usize::from(face.dot(normal) > 0.0)] += 1;
        // Hair leaves the side that it grows on.
        assert!(triangle.iter().all(|&v| face.dot(primitive.offset[v as usize]) > 0.0), "{triangle:?}");
    }
    assert_eq!(sides, [part.stored.triangles.len(); 2]);
}

#[test]
fn painted_lengths_are_those_of_hair() {
    let Some(path) = wild("painted.glb") else { return };
    let map = path.with_file_name("length.png");
    let picture = image::open(&map).unwrap().to_luma8();
    let preset = thin(&["guard.shape.length_variation=0", &format!("maps.length={:?}", map.to_string_lossy())]);
    let full = thin(&["guard.shape.length_variation=0"]);
    let strands_of = |preset| {
        let grown = grown(&path, preset);
        let scene = grown.scene();
        let strands = scene.guard.unwrap().0.clone();
        let uv = scene.skin.uv_sets[0].clone();
        let triangles = scene.skin.triangles.clone();
        let length = move |i: usize| {
            let points = strands.points_of_m(i);
            points.windows(2).map(|pair| pair[0].distance(pair[1])).sum::<f32>()
        };
        let roots = scene.guard.unwrap().0.roots.clone();
        let lengths: Vec<(furrier::math::Vec2, f32)> = roots
            .iter()
            .enumerate()
            .map(|(i, root)| {
                let [p, q, r] = triangles[root.triangle as usize].map(|v| uv[v as usize]);
                let [x, y] = root.barycentric;
                (p * x + q * y + r * (1.0 - x - y), length(i))
            })
            .collect();
        lengths
    };
    let plain = strands_of(&full);
    let whole = plain.iter().map(|(_, length)| *length).fold(0.0, f32::max);
    let usual = plain.iter().map(|(_, length)| *length).sum::<f32>() / plain.len() as f32 / whole;
    // Hair in creases is shorter; none is longer than painted.
    let (mut seen, mut sum) = (0, 0.0);
    for (uv, length) in strands_of(&preset) {
        let at = |u: f32| ((u.rem_euclid(1.0) * 384.0) as u32).min(383);
        let around = [-2.0, 0.0, 2.0].map(|d: f32| picture.get_pixel(at(uv.x + d / 384.0), at(uv.y + d / 384.0)).0[0]);
        // Away from borders of what is painted.
        if around[0] == around[1] && around[1] == around[2] {
            let expected = whole * f32::from(around[1]) / 255.0;
            assert!(length < expected + 0.03 * whole, "{length} m at {uv}, {expected} painted");
            assert!(expected > 0.0, "hair at {uv}, where none is painted");
            (seen, sum) = (seen + 1, sum + length / expected);
        }
    }
    let mean = sum / seen as f32;
    println!("{mean} of what is painted, {usual} of the preset's length without");
    assert!(
        seen > 500 && (mean / usual - 1.0).abs() < 0.05,
        "{mean} of what is painted, {usual} without, {seen} hairs"
    );
}

/// Coverage of `view` and `render` from a side.
fn coverages(path: &std::path::Path, asset: &Asset, coat: &Coat, azimuth_deg: f64) -> [f64; 2] {
    let size = [96_usize; 2];
    let grown = grown(path, &thin(CUBE));
    let camera = framing(&grown, azimuth_deg, 0.0, 1.0, size);
    let render = grown.draw(&studio(&camera), &camera, &Settings::preview(size)).unwrap().film.alpha;
    let mut options = ViewOptions::default();
    options.stage.viewpoint = Viewpoint::Camera(camera);
    options.stage.size = size.map(|pixels| pixels as u32);
    let shot = viewer::screenshot(asset, coat, &options).unwrap();
    [shot.picture.coverage(), render.iter().map(|a| f64::from(*a)).sum::<f64>() / render.len() as f64]
}

/// Hair on the cube.
const CUBE: &[&str] = &["undercoat.density_per_cm2=8000", "guard.density_per_cm2=200", "shells.layers=12"];

#[test]
fn a_cube_is_furred_on_all_its_faces() {
    let Some(path) = wild("cube_12_triangles.glb") else { return };
    let folder = tempfile::tempdir().unwrap();
    let (asset, coat) = baked(&path, &folder.path().join("out.glb"), &thin(CUBE), Method::Lapped);
    for azimuth_deg in [0.0, 45.0] {
        let [view, render] = coverages(&path, &asset, &coat, azimuth_deg);
        assert!((view - render).abs() < 0.03, "{view} in view, {render} in render from {azimuth_deg}°");
    }
    // A planted fault: a face without fur.
    let mut bald = coat.clone();
    bald.primitives[0].offset.iter_mut().for_each(|o| *o *= 0.02);
    let [view, render] = coverages(&path, &asset, &bald, 0.0);
    assert!((view - render).abs() > 0.03, "{view} and {render}");
}
