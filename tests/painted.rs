//! What is painted on a skin is read where hair has its root.

use crate::one_skin::{baked, grown, thin, write};
use furrier::asset::{self, Asset};
use furrier::bake::Method;
use furrier::data::coat::Coat;
use furrier::data::image::linear_from_srgb;
use furrier::gpu::{Choice, Gpu};
use furrier::math::{Mat4, Vec2, Vec3};
use furrier::preset::Preset;
use furrier::runtime::gpu::Renderer;
use furrier::runtime::{DrawList, Frame, Picture, Show};
use furrier::viewer::bald::Baldness;
use furrier::viewer::stage;
use serde_json::json;
use std::path::{Path, PathBuf};

/// Half an edge of the square, m.
const HALF: f32 = 0.1;
/// Pixels along an edge of pictures.
const PIXELS: u32 = 128;

/// A square of two triangles whose base colour is a picture.
pub fn square(folder: &Path, name: &str, pixel: impl Fn(u32, u32) -> [u8; 3], size: u32) -> PathBuf {
    let mut document = furrier::asset::Document::made("square");
    let mut add = |bytes: Vec<u8>, kind: &str, component: u32, count: usize, more: serde_json::Value| {
        let view = document.push_view(&bytes, None);
        let mut accessor = json!({"bufferView": view, "componentType": component, "count": count, "type": kind});
        for (key, value) in more.as_object().unwrap() {
            accessor[key] = value.clone();
        }
        document.push("accessors", accessor)
    };
    let floats = |values: &[f32]| values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
    let corners = [-HALF, 0.0, -HALF, -HALF, 0.0, HALF, HALF, 0.0, HALF, HALF, 0.0, -HALF];
    let bounds = json!({"min": [-HALF, 0.0, -HALF], "max": [HALF, 0.0, HALF]});
    let position = add(floats(&corners), "VEC3", 5126, 4, bounds);
    let uv = add(floats(&[0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 0.0]), "VEC2", 5126, 4, json!({}));
    let indices = [0_u32, 1, 2, 0, 2, 3].iter().flat_map(|v| v.to_le_bytes()).collect();
    let indices = add(indices, "SCALAR", 5125, 6, json!({}));
    let picture = image::RgbImage::from_fn(size, size, |x, y| image::Rgb(pixel(x, y)));
    let mut png = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut png, image::ImageFormat::Png).unwrap();
    let view = document.push_view(&png.into_inner(), None);
    let image = document.push("images", json!({"bufferView": view, "mimeType": "image/png"}));
    let texture = document.push("textures", json!({"source": image}));
    let material = document.push(
        "materials",
        json!({"name": "fur", "pbrMetallicRoughness": {"baseColorTexture": {"index": texture}, "metallicFactor": 0.0}}),
    );
    let primitive =
        json!({"attributes": {"POSITION": position, "TEXCOORD_0": uv}, "indices": indices, "material": material});
    let mesh = document.push("meshes", json!({"primitives": [primitive]}));
    let node = document.push("nodes", json!({"mesh": mesh}));
    document.push("scenes", json!({"nodes": [node]}));
    document.json["scene"] = json!(0);
    write(&document, folder, name)
}

/// Where a point of the square is in its texture.
fn uv_of(p: Vec3) -> Vec2 {
    Vec2::new(p.x, p.z) / (2.0 * HALF) + 0.5
}

fn upright(settings: &[&str]) -> Preset {
    let all = ["groom.comb=upright", "groom.lean_deg=0", "groom.gravity=0", "colour.variation=0"];
    thin(&all.iter().chain(settings).copied().collect::<Vec<_>>())
}

/// A grey map beside the asset.
fn map(folder: &Path, name: &str, size: u32, value: impl Fn(u32, u32) -> u8) -> String {
    let path = folder.join(name);
    image::GrayImage::from_fn(size, size, |x, y| image::Luma([value(x, y)])).save(&path).unwrap();
    path.to_string_lossy().into_owned()
}

/// The square from above, along parallel rays.
fn above() -> Frame {
    let across = Mat4::from_cols_array_2d(&[
        [1.0 / HALF, 0.0, 0.0, 0.0],
        [0.0, 0.0, -1.0, 0.0],
        [0.0, -1.0 / HALF, 0.0, 0.0],
        [0.0, 0.0, 0.5, 1.0],
    ]);
    Frame {
        clip_from_world: across,
        eye: Vec3::Y.extend(0.0),
        size: [PIXELS; 2],
        lights: vec![],
        ambient: Vec3::ONE,
        shadow_map: false,
        depths: false,
        level: Some(0),
    }
}

fn with_picture<T>(asset: &Asset, coat: &Coat, look: impl FnOnce(&mut furrier::runtime::gpu::Prepared<'_>) -> T) -> T {
    let gpu = Gpu::open(&Choice::Auto).unwrap();
    let textures = stage::textures(asset, coat).unwrap();
    let scene = stage::scene(asset, coat, &textures, &asset.rest_pose().unwrap());
    looked(&gpu, &scene, coat, look)
}

fn looked<T>(
    gpu: &Gpu,
    scene: &DrawList<'_>,
    coat: &Coat,
    look: impl FnOnce(&mut furrier::runtime::gpu::Prepared<'_>) -> T,
) -> T {
    let renderer = Renderer::new(gpu, &coat.tiles, 1).unwrap();
    let mut prepared = renderer.prepare(scene).unwrap();
    look(&mut prepared)
}

fn drawn(asset: &Asset, coat: &Coat, show: Show) -> Picture {
    with_picture(asset, coat, |prepared| prepared.draw(&above(), show).unwrap().picture)
}

/// Optical depth of hair over the skin at a pixel.
fn depths(asset: &Asset, coat: &Coat) -> Picture {
    with_picture(asset, coat, |prepared| prepared.hair_over_skin(&above()).unwrap())
}

/// Red of a picture's pixel where a texture coordinate lies.
fn at(picture: &Picture, uv: Vec2) -> [f32; 4] {
    let [x, y] = (uv * PIXELS as f32).to_array().map(|c| (c as usize).min(PIXELS as usize - 1));
    picture.pixels[y * PIXELS as usize + x]
}

/// Four fields of colour on a square of two triangles, told apart by nothing but the texture.
fn fields(x: u32, y: u32) -> [u8; 3] {
    [if x < 8 { 255 } else { 60 }, if y < 8 { 255 } else { 60 }, 60]
}

#[test]
fn hair_has_the_colour_of_its_root() {
    let folder = tempfile::tempdir().unwrap();
    let input = square(folder.path(), "square.glb", fields, 16);
    let preset = upright(&["colour.guard=[[1,1,1],[1,1,1],[1,1,1]]"]);
    let grown = grown(&input, &preset);
    let scene = grown.scene();
    let strands = scene.guard.unwrap().0;
    let [low, high] = [60.0, 255.0].map(|byte| linear_from_srgb(byte / 255.0));
    let expected = |uv: Vec2| [if uv.x < 0.5 { high } else { low }, if uv.y < 0.5 { high } else { low }];
    // A texel either side of the border it is between the two.
    let clear = |uv: Vec2| (uv - 0.5).abs().min_element() > 1.0 / 16.0 && (uv - 0.5).abs().max_element() < 0.46;
    let mut seen = 0;
    for i in (0..strands.len()).filter(|&i| clear(uv_of(strands.points_of_m(i)[0]))) {
        let [r, g] = expected(uv_of(strands.points_of_m(i)[0]));
        let tint = strands.tint[i];
        assert!((tint.x - r).abs() < 1e-4 && (tint.y - g).abs() < 1e-4, "{tint} at {}", strands.points_of_m(i)[0]);
        seen += 1;
    }
    assert!(seen > 2000, "{seen}");
    // The volume's vertices tell them apart as well, and the roots still lie where they did.
    assert!(scene.skin.triangles.len() > 50);
    for (v, p) in scene.skin.positions_m.iter().enumerate().filter(|(_, p)| clear(uv_of(**p))) {
        let [r, g] = expected(uv_of(*p));
        let tint = scene.fields.tint[v];
        assert!((tint.x - r).abs() < 0.02 && (tint.y - g).abs() < 0.02, "{tint} at {p}");
    }
    for (i, root) in strands.roots.iter().enumerate() {
        let [p, q, r] = scene.skin.corners_m(root.triangle as usize);
        let [x, y] = root.barycentric;
        let here = p * x + q * y + r * (1.0 - x - y);
        assert!(here.distance(strands.points_of_m(i)[0]) < 1e-5, "{here} is not {}", strands.points_of_m(i)[0]);
    }
}

#[test]
fn shells_show_a_texture_as_sharp_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let input = square(folder.path(), "square.glb", fields, 16);
    let preset = upright(&["undercoat.density_per_cm2=30000"]);
    for method in [Method::Lapped, Method::Atlas { texels: Some(128) }] {
        let (asset, coat) = baked(&input, &folder.path().join("out.glb"), &preset, method);
        let picture = drawn(&asset, &coat, Show { skin: false, ..Show::default() });
        // The share of red in the light of hair: 0.9 on one side, 0.33 on the other.
        let share = |uv: Vec2| {
            let [r, _, b, _] = at(&picture, uv);
            r / b
        };
        let (left, right) = (share(Vec2::new(0.3, 0.7)), share(Vec2::new(0.7, 0.7)));
        assert!(left > 10.0 * right, "{method:?}: {left} and {right}");
        // Across a tenth of the square around the border it is all over.
        let (near, beyond) = (share(Vec2::new(0.44, 0.7)), share(Vec2::new(0.56, 0.7)));
        assert!(near > 0.8 * left && beyond < 1.5 * right, "{method:?}: {near} of {left}, {beyond} of {right}");
    }
    // A planted fault: without its texture the coat is of one colour.
    let (asset, mut coat) = baked(&input, &folder.path().join("out.glb"), &preset, Method::Lapped);
    coat.primitives[0].colour = None;
    let picture = drawn(&asset, &coat, Show { skin: false, ..Show::default() });
    let [left, right] = [0.3, 0.7].map(|u| at(&picture, Vec2::new(u, 0.7))[0]);
    assert!((left / right - 1.0).abs() < 0.5);
}

#[test]
fn half_the_density_is_half_the_optical_depth() {
    let folder = tempfile::tempdir().unwrap();
    let input = square(folder.path(), "square.glb", |_, _| [255; 3], 4);
    let half = map(folder.path(), "half.png", 16, |x, _| if x < 8 { 128 } else { 255 });
    // Sparse enough that no slab counts as opaque.
    let settings = format!("maps.density={half:?}");
    let sparse = ["undercoat.density_per_cm2=200", "guard.density_per_cm2=5", &settings];
    let (asset, coat) = baked(&input, &folder.path().join("out.glb"), &upright(&sparse), Method::Lapped);
    let picture = depths(&asset, &coat);
    let mean = |u: f32| {
        let places = (10..90).map(|v| at(&picture, Vec2::new(u, v as f32 / 100.0))[0]);
        places.sum::<f32>() / 80.0
    };
    let ratio = mean(0.25) / mean(0.75);
    assert!(mean(0.75) > 1e-3 && (ratio - 128.0 / 255.0).abs() < 0.025, "{} and {}: {ratio}", mean(0.25), mean(0.75));
    // As many hairs, too.
    let grown = grown(&input, &upright(&["guard.density_per_cm2=200", &settings]));
    let scene = grown.scene();
    let strands = scene.guard.unwrap().0;
    let between = |low: f32, high: f32| {
        (0..strands.len()).filter(|&i| (low..high).contains(&uv_of(strands.points_of_m(i)[0]).x)).count() as f32
    };
    let ratio = between(0.1, 0.4) / between(0.6, 0.9);
    assert!((ratio - 128.0 / 255.0).abs() < 0.025, "{ratio}");
}

#[test]
fn hair_painted_inside_a_face_whose_corners_are_bare_is_there() {
    let folder = tempfile::tempdir().unwrap();
    let input = square(folder.path(), "square.glb", |_, _| [255; 3], 4);
    let inside =
        map(
            folder.path(),
            "inside.png",
            64,
            |x, y| if (16..48).contains(&x) && (16..48).contains(&y) { 255 } else { 0 },
        );
    for key in ["density", "length"] {
        let setting = format!("maps.{key}={inside:?}");
        let preset = upright(&["undercoat.density_per_cm2=20000", &setting]);
        let out = folder.path().join("out.glb");
        let (asset, coat) = baked(&input, &out, &preset, Method::Lapped);
        let picture = depths(&asset, &coat);
        let [inner, outer] = [0.5, 0.1].map(|u| at(&picture, Vec2::new(u, 0.5))[0]);
        assert!(inner > 0.5 && outer < 1e-3, "{key}: {inner} inside, {outer} outside");
        // Every vertex of the fallback is of the square's corners or lies within it, and counts where hair is.
        let document = &asset.document;
        let fallback = &document.json["meshes"][1]["primitives"][0]["attributes"];
        let read = |name: &str, width| document.floats(fallback[name].as_u64().unwrap() as usize, width).unwrap();
        for (colour, place) in read("COLOR_0", 4).chunks(4).zip(read("POSITION", 3).chunks(3)) {
            let off = (uv_of(Vec3::from_slice(place)) - 0.5).abs().max_element();
            assert!(place[1] > 0.0, "{key}: {place:?}");
            if !(0.2..0.3).contains(&off) {
                let expected = if off < 0.25 { 1.0 } else { 0.0 };
                assert!((colour[3] - expected).abs() < 0.05, "{key}: {} at {place:?}", colour[3]);
            }
        }
    }
    // A face without any hair has no shells.
    let none = map(folder.path(), "none.png", 8, |_, _| 0);
    let preset = upright(&[&format!("maps.density={none:?}")]);
    let (_, coat) = baked(&input, &folder.path().join("out.glb"), &preset, Method::Lapped);
    assert!(coat.primitives.is_empty());
}

#[test]
fn painted_length_ends_hair_and_leaves_no_specks_nor_halo() {
    let folder = tempfile::tempdir().unwrap();
    let input = square(folder.path(), "square.glb", |_, _| [200, 120, 80], 4);
    let preset = |map: &str| {
        let settings = format!("maps.length={map:?}");
        upright(&["undercoat.density_per_cm2=20000", "guard.density_per_cm2=200", &settings])
    };
    let out = folder.path().join("out.glb");
    let full = map(folder.path(), "full.png", 64, |_, _| 255);
    let stripes = map(folder.path(), "stripes.png", 64, |x, _| if x % 2 == 0 { 255 } else { 0 });
    let half = map(folder.path(), "half.png", 64, |x, _| if x < 32 { 0 } else { 255 });
    let luminances = |preset: &Preset| {
        let (asset, coat) = baked(&input, &out, preset, Method::Lapped);
        let picture = drawn(&asset, &coat, Show::default());
        (picture.pixels.iter().map(|p| p[0] + p[1] + p[2]).collect::<Vec<f32>>(), picture)
    };
    let darkest = |list: &[f32]| list.iter().copied().fold(f32::INFINITY, f32::min);
    let (whole, _) = luminances(&preset(&full));
    let (striped, picture) = luminances(&preset(&stripes));
    assert!(picture.pixels.iter().flatten().all(|x| x.is_finite()));
    assert!(darkest(&striped) > 0.8 * darkest(&whole), "{} in stripes, {} without", darkest(&striped), darkest(&whole));

    // Bare skin is bare to the pixel: as it is without any coat, up to the texels beside its border; the map repeats.
    let (asset, coat) = baked(&input, &out, &preset(&half), Method::Lapped);
    let furred = drawn(&asset, &coat, Show::default());
    let bare = drawn(&asset, &Coat { primitives: vec![], ..coat.clone() }, Show::default());
    for x in 4..PIXELS as usize / 2 - 4 {
        let i = 64 * PIXELS as usize + x;
        let off = (0..3).map(|c| (furred.pixels[i][c] - bare.pixels[i][c]).abs()).fold(0.0, f32::max);
        assert!(off < 2e-3, "pixel {x} beside the border: {:?}, bare {:?}", furred.pixels[i], bare.pixels[i]);
    }
    let beyond = 64 * PIXELS as usize + PIXELS as usize / 2 + 6;
    assert!((furred.pixels[beyond][0] - bare.pixels[beyond][0]).abs() > 0.02, "hair beside it");

    // Half as long hair is half as high: in a stack seen from the side nothing is above it.
    let short = map(folder.path(), "short.png", 64, |x, _| if x < 32 { 128 } else { 255 });
    let grown = grown(&input, &preset(&short));
    let scene = grown.scene();
    let strands = scene.guard.unwrap().0;
    let tallest = |left: bool| {
        let own = (0..strands.len()).filter(|&i| {
            let u = uv_of(strands.points_of_m(i)[0]).x;
            if left { (0.1..0.4).contains(&u) } else { (0.6..0.9).contains(&u) }
        });
        own.map(|i| strands.points_of_m(i)[strands.points_per_strand - 1].y).fold(0.0, f32::max)
    };
    let ratio = tallest(true) / tallest(false);
    assert!((ratio - 0.5).abs() < 0.05, "{ratio}");
}

#[test]
fn fallback_shells_show_the_pattern() {
    let folder = tempfile::tempdir().unwrap();
    let input = square(folder.path(), "square.glb", fields, 16);
    let (asset, _) = baked(&input, &folder.path().join("out.glb"), &upright(&[]), Method::Lapped);
    let document = &asset.document;
    let fallback = &document.json["meshes"][1]["primitives"][0]["attributes"];
    let read = |name: &str, width| document.floats(fallback[name].as_u64().unwrap() as usize, width).unwrap();
    let (colours, positions) = (read("COLOR_0", 4), read("POSITION", 3));
    assert!(positions.len() / 3 > 2 * 30, "{} vertices", positions.len() / 3);
    for (colour, place) in colours.chunks(4).zip(positions.chunks(3)) {
        let uv = uv_of(Vec3::from_slice(place));
        if (uv.x - 0.5).abs() > 0.07 && (uv.x - 0.5).abs() < 0.45 {
            let expected = linear_from_srgb(if uv.x < 0.5 { 1.0 } else { 60.0 / 255.0 });
            assert!((colour[0] - expected).abs() < 0.05, "{} at {uv}, not {expected}", colour[0]);
        }
    }
}

#[test]
fn missing_hair_is_counted_as_bald() {
    let folder = tempfile::tempdir().unwrap();
    let input = write(&asset::load("sample:plane").unwrap().document, folder.path(), "plane.glb");
    let preset = upright(&["undercoat.density_per_cm2=20000"]);
    let (asset, coat) = baked(&input, &folder.path().join("out.glb"), &preset, Method::Lapped);
    let gpu = Gpu::open(&Choice::Auto).unwrap();
    let textures = stage::textures(&asset, &coat).unwrap();
    let pose = asset.rest_pose().unwrap();
    let count = |fault: &dyn Fn(&mut DrawList<'_>)| {
        let mut scene = stage::scene(&asset, &coat, &textures, &pose);
        fault(&mut scene);
        looked(&gpu, &scene, &coat, |prepared| Baldness::of(&prepared.hair_over_skin(&above()).unwrap()))
    };
    let whole = count(&|_| ());
    assert!(whole.furred > 1000 && whole.bald == 0, "{whole:?}");
    // Planted faults: hair of the left half leans into the skin, or is a tenth as long as told.
    let left = |fault: &dyn Fn(&mut Vec3)| {
        count(&|scene: &mut DrawList<'_>| {
            let fur = &mut scene.furs[0];
            let places = fur.positions_m.clone();
            fur.offsets_m.iter_mut().zip(&places).filter(|(_, p)| p.x < 0.0).for_each(|(o, _)| fault(o));
        })
    };
    let turned = left(&|o| *o = -*o);
    assert!(turned.share() > 0.4 && turned.share() < 0.6, "{turned:?}");
}
