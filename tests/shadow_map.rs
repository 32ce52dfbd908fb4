//! The key light's shadow map: what it darkens, and what it must leave alone.

use crate::coats::{self, Furred};
use crate::common::furrier_path;
use crate::runtime::look;
use assert_cmd::Command;
use furrier::data::coat::Tile;
use furrier::data::light::{Directional, Light, Point, Spot};
use furrier::gpu::{Choice, Gpu};
use furrier::math::{Vec2, Vec3};
use furrier::runtime::gpu::{Drawn, KeyShadow, Renderer};
use furrier::runtime::{Casters, DrawList, Frame, Picture, ShadowView, Show, SkinMesh};
use predicates::str::contains;

const RADIUS_M: f32 = 0.05;
const LIMB_M: f32 = 0.015;
const ABOVE: Vec3 = Vec3::new(-0.48, 0.67, 0.57);

fn tiles() -> [Tile; 1] {
    [coats::tile(&coats::fox()[..1], 0.008, 6, 32, 1)]
}

fn body(tiles: &[Tile]) -> Furred {
    coats::sphere(RADIUS_M, 12, 0.5, &tiles[0])
}

fn key(to_light: Vec3) -> Light {
    Directional { to_light: to_light.normalize(), irradiance: Vec3::splat(3.0) }.into()
}

/// The ball's picture, mostly lit by the key.
fn frame(light: Light) -> Frame {
    let view = look(Vec3::new(0.05, 0.05, 0.26), [96, 96]);
    Frame { lights: vec![light], ambient: Vec3::splat(0.05), depths: true, ..view }
}

fn drawn(scene: &DrawList<'_>, frame: &Frame) -> Drawn {
    let gpu = Gpu::open(&Choice::Auto).unwrap();
    let renderer = Renderer::new(&gpu, scene.tiles, 1).unwrap();
    renderer.prepare(scene).unwrap().draw(frame, Show::default()).unwrap()
}

/// The same without the map, and with it.
fn both(scene: &DrawList<'_>, frame: &Frame) -> [Picture; 2] {
    [false, true].map(|shadow_map| drawn(scene, &Frame { shadow_map, ..frame.clone() }).picture)
}

fn brightness(picture: &Picture, i: usize) -> f32 {
    picture.pixels[i][..3].iter().sum()
}

/// Where each pixel's nearest surface is; none where there is no opaque one.
fn places(frame: &Frame, picture: &Picture) -> Vec<Option<Vec3>> {
    let inverse = frame.clip_from_world.inverse();
    let eye = frame.eye.truncate();
    let [width, height] = frame.size.map(|n| n as usize);
    let place = |i: usize| {
        let at = Vec2::new((i % width) as f32 + 0.5, (i / width) as f32 + 0.5) / Vec2::new(width as f32, height as f32);
        let far = inverse * Vec3::new(2.0 * at.x - 1.0, 1.0 - 2.0 * at.y, 1.0).extend(1.0);
        let ray = (far.truncate() / far.w - eye).normalize();
        (picture.pixels[i][3] > 0.99).then(|| eye + ray * picture.depth_m[i])
    };
    (0..width * height).map(place).collect()
}

/// A bare ball.
fn limb(middle_m: Vec3, radius_m: f32) -> SkinMesh<'static> {
    let ball = coats::sphere(radius_m, 8, 0.0, &tiles()[0]);
    let count = ball.positions_m.len();
    SkinMesh {
        positions_m: ball.positions_m.iter().map(|p| *p + middle_m).collect(),
        normals: ball.normals,
        colour: vec![Vec3::ONE; count],
        triangles: ball.triangles,
        ..SkinMesh::default()
    }
}

#[test]
fn a_limb_before_the_light_darkens_what_lies_behind_it_and_nothing_else() {
    let tiles = tiles();
    let body = body(&tiles);
    let towards = ABOVE.normalize();
    let lights = [
        key(towards),
        Point::new(towards * 0.5, Vec3::splat(0.6), None).unwrap().into(),
        Spot::new(Point::new(towards * 0.5, Vec3::splat(0.6), None).unwrap(), -towards, 0.0, 0.6).unwrap().into(),
    ];
    for light in lights {
        let mut scene = body.scene(&tiles);
        scene.skins.push(limb(towards * 0.12, LIMB_M));
        let frame = frame(light);
        let [bright, dark] = both(&scene, &frame);
        let unlit = drawn(&scene, &Frame { lights: vec![], ..frame.clone() }).picture;
        let (mut seen, mut sums) = ([0; 2], [0.0; 2]);
        for (i, place) in places(&frame, &bright).into_iter().enumerate() {
            let Some(place) = place.filter(|p| p.length() < 1.3 * RADIUS_M) else { continue };
            let aside = (place - towards * place.dot(towards)).length();
            let share = brightness(&dark, i) / brightness(&bright, i);
            if aside < 0.6 * LIMB_M && place.dot(towards) > 0.0 {
                // Of the light itself, whatever comes from everywhere.
                let [all, left] = [&bright, &dark].map(|picture| brightness(picture, i) - brightness(&unlit, i));
                assert!(left < 0.5 * all && all > 0.0, "{light:?}: {left} of {all} in the shadow at {place}");
                sums = [sums[0] + all, sums[1] + left];
                seen[0] += 1;
            } else if aside > 2.0 * LIMB_M {
                assert!((share - 1.0).abs() < 0.05, "{light:?}: {share} beside it at {place}");
                seen[1] += 1;
            }
        }
        assert!(seen[0] > 20 && seen[1] > 500, "{seen:?}");
        // What is left is of hair in front, which a pixel sees beside the shadow.
        println!("{:.3} of the light is left in the shadow", sums[1] / sums[0]);
        assert!(sums[1] < 0.25 * sums[0], "{sums:?}");
    }
}

#[test]
fn a_sphere_is_as_bright_as_without_a_map() {
    let tiles = tiles();
    let near = |to: Vec3| Point::new(to.normalize() * 3.0 * RADIUS_M, Vec3::splat(0.1), None).unwrap().into();
    // The farthest leaning hair: a pixel of the outline, where shells are drawn beside their triangles' edges.
    for (lean_rad, most_off) in [(0.0, 0.05), (0.5, 0.05), (1.0, 0.1)] {
        let ball = coats::sphere(RADIUS_M, 12, lean_rad, &tiles[0]);
        for light in
            [key(ABOVE), key(Vec3::X), key(Vec3::new(0.3, 0.2, -1.0)), key(Vec3::Z), near(ABOVE), near(Vec3::X)]
        {
            let [without, with] = both(&ball.scene(&tiles), &frame(light));
            let all = 0..without.pixels.len();
            let mean = |picture: &Picture| all.clone().map(|i| brightness(picture, i)).sum::<f32>();
            let most = all.clone().map(|i| brightness(&without, i)).fold(0.0, f32::max);
            let off = |i: usize| {
                (brightness(&with, i) - brightness(&without, i)).abs() / brightness(&without, i).max(0.05 * most)
            };
            let (worst, changed) = (all.clone().map(off).fold(0.0, f32::max), 1.0 - mean(&with) / mean(&without));
            println!("lean {lean_rad}, {light:?}: mean {changed:.5} darker, a pixel {worst:.4}");
            assert!(changed.abs() < 0.01 && worst < most_off, "{changed} {worst}");
        }
    }
}

#[test]
fn light_from_behind_casts_nothing_on_the_front() {
    let tiles = tiles();
    let body = body(&tiles);
    let mut scene = body.scene(&tiles);
    scene.skins.push(limb(Vec3::new(0.03, 0.02, 0.07), LIMB_M));
    let frame = frame(key(Vec3::new(-0.1, 0.1, -1.0)));
    let [without, with] = both(&scene, &frame);
    let mut seen = 0;
    for (i, place) in places(&frame, &without).into_iter().enumerate() {
        if place.is_some_and(|p| p.length() < 1.3 * RADIUS_M && p.z > 0.4 * RADIUS_M) {
            let (a, b) = (brightness(&without, i), brightness(&with, i));
            assert!((a - b).abs() < 0.01 * a, "{a} {b}");
            seen += 1;
        }
    }
    assert!(seen > 300, "{seen}");
}

/// A box with sides along the axes, no part of the asset.
fn thing(low: Vec3, high: Vec3) -> SkinMesh<'static> {
    let mut skin = SkinMesh { guest: true, ..SkinMesh::default() };
    for normal in [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z] {
        let right = normal.any_orthonormal_vector();
        let up = normal.cross(right);
        let first = skin.positions_m.len() as u32;
        for (x, y) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            let corner = normal + right * x + up * y;
            skin.positions_m.push(0.5 * (low + high) + 0.5 * (high - low) * corner);
        }
        skin.normals.extend([normal; 4]);
        skin.triangles.extend([[0, 1, 2], [0, 2, 3]].map(|t| t.map(|v| first + v)));
    }
    skin.colour = vec![Vec3::splat(0.5); 24];
    skin.coat_density = vec![1.0; 24];
    skin.coat_uv = vec![Vec2::ZERO; 24];
    skin
}

#[test]
fn a_box_sinks_into_fur_and_darkens_what_stands_beside_it() {
    let tiles = tiles();
    let mat = coats::plane(0.12, 12, 0.2, &tiles[0]);
    let fur_m = tiles[0].height_m;
    let half = 0.015;
    let [low, high] = [Vec3::new(-half, -half, 0.2 * fur_m), Vec3::new(half, half, 0.03)];
    let light = key(Vec3::new(1.0, 0.0, 1.0));
    let frame = Frame { lights: vec![light], ..frame(light) };
    let bare = drawn(&mat.scene(&tiles), &frame).picture;
    let mut scene = mat.scene(&tiles);
    scene.skins.push(thing(low, high));
    let [unshadowed, with] = both(&scene, &frame);
    let mut seen = [0; 4];
    // Places on the mat, as it is without the box.
    for (i, (under, over)) in places(&frame, &bare).into_iter().zip(places(&frame, &with)).enumerate() {
        let (Some(under), Some(over)) = (under, over) else { continue };
        let grey = 0.5 * (0.05 + 3.0 / (std::f32::consts::PI * 2f32.sqrt()));
        if over.z > high.z - 1e-4 && over.x.abs().max(over.y.abs()) > 0.85 * half {
            // Its edge has part of what lies behind.
        } else if over.z > high.z - 1e-4 {
            // The lid is lit, and nothing but its own grey.
            let close = with.pixels[i][..3].iter().all(|c| (c - grey).abs() < 0.01 * grey);
            assert!(close, "{:?} for {grey}", with.pixels[i]);
            seen[0] += 1;
        } else if (over - under).length() > 1e-4 {
            // Fur behind the box is hidden.
            assert!(over.distance(frame.eye.truncate()) < under.distance(frame.eye.truncate()));
            seen[1] += 1;
        } else if under.y.abs() < 0.8 * half && under.x < -half - 0.003 && under.x > -half - 0.6 * high.z {
            let share = brightness(&with, i) / brightness(&bare, i);
            assert!(share < 0.5 && brightness(&unshadowed, i) > 0.95 * brightness(&bare, i), "{share} at {under}");
            seen[2] += 1;
        } else if under.x > half + 0.002 && under.x.abs() < 0.05 && under.y.abs() < 0.05 {
            let share = brightness(&with, i) / brightness(&bare, i);
            assert!((share - 1.0).abs() < 0.03, "{share} at {under}");
            seen[3] += 1;
        }
    }
    println!("lid, side, shadow, light: {seen:?}");
    assert!(seen.iter().all(|&count| count > 20), "{seen:?}");
}

#[test]
fn a_sheet_casts_its_shadow_whichever_side_the_light_is_on() {
    let tiles = tiles();
    let body = body(&tiles);
    let towards = ABOVE.normalize();
    let sheet = coats::plane(0.06, 4, 0.0, &tiles[0]);
    for side in [1.0, -1.0] {
        let turn = furrier::math::Quat::from_rotation_arc(Vec3::Z * side, towards);
        let skin = SkinMesh {
            positions_m: sheet.positions_m.iter().map(|p| turn * *p + 0.13 * towards).collect(),
            normals: vec![turn * Vec3::Z; sheet.normals.len()],
            colour: vec![Vec3::ONE; sheet.normals.len()],
            triangles: sheet.triangles.clone(),
            ..SkinMesh::default()
        };
        let mut scene = body.scene(&tiles);
        scene.skins.push(skin);
        let frame = frame(key(towards));
        let [without, with] = both(&scene, &frame);
        let lit = places(&frame, &without).into_iter().enumerate().filter(|(_, place)| {
            place.is_some_and(|p| p.length() < 1.3 * RADIUS_M && (p - towards * p.dot(towards)).length() < 0.02)
        });
        let shares: Vec<f32> = lit.map(|(i, _)| brightness(&with, i) / brightness(&without, i)).collect();
        assert!(shares.len() > 20 && shares.iter().all(|&share| share < 0.4), "{side}: {shares:?}");
    }
    // It does not darken its own fur.
    let light = key(Vec3::new(0.8, 0.1, 0.6));
    let [without, with] = both(&sheet.scene(&tiles), &frame(light));
    for i in 0..without.pixels.len() {
        assert!((brightness(&with, i) - brightness(&without, i)).abs() < 0.02, "{i}");
    }
}

#[test]
fn the_same_scene_gives_the_same_bits() {
    let tiles = tiles();
    let body = body(&tiles);
    let mut scene = body.scene(&tiles);
    scene.skins.push(limb(ABOVE.normalize() * 0.12, LIMB_M));
    let frame = frame(key(ABOVE));
    assert_eq!(drawn(&scene, &frame).picture, drawn(&scene, &frame).picture);
}

#[test]
fn what_no_map_can_hold_is_said() {
    let tiles = tiles();
    let body = body(&tiles);
    let scene = body.scene(&tiles);
    let point = |at: Vec3, range_m| Light::from(Point::new(at, Vec3::ONE, range_m).unwrap());
    let shadow = |scene: &DrawList<'_>, light| drawn(scene, &frame(light)).shadow;
    assert_eq!(shadow(&scene, point(Vec3::new(0.01, 0.0, 0.0), None)), KeyShadow::TooNear);
    assert_eq!(shadow(&scene, point(Vec3::X * 0.3, None)), KeyShadow::Cast { guests_reach: true });
    let dark = Frame { lights: vec![], ..frame(key(ABOVE)) };
    assert_eq!(drawn(&scene, &dark).shadow, KeyShadow::Off);
    let unasked = Frame { shadow_map: false, ..frame(key(ABOVE)) };
    assert_eq!(drawn(&scene, &unasked).shadow, KeyShadow::Off);
    // A spot within the asset has its own cone.
    let inside = Spot::new(Point::new(Vec3::ZERO, Vec3::ONE, None).unwrap(), Vec3::X, 0.0, 0.5).unwrap();
    assert_eq!(shadow(&scene, inside.into()), KeyShadow::Cast { guests_reach: true });

    let reaches = |middle: Vec3, light: Light| {
        let mut scene = body.scene(&tiles);
        scene.skins.push(thing(middle - 0.01, middle + 0.01));
        ShadowView::of(&light, &Casters::of(&scene)).unwrap().guests_reach
    };
    for (middle, light, expected) in [
        (Vec3::X * 0.2, key(Vec3::X), true),
        (Vec3::X * -0.2, key(Vec3::X), false),
        (Vec3::Y * 0.2, key(Vec3::X), false),
        (Vec3::X * 0.2, point(Vec3::X * 0.4, None), true),
        (Vec3::X * 0.6, point(Vec3::X * 0.4, None), false),
        (Vec3::X * 0.2, point(Vec3::X * 0.4, Some(0.1)), false),
        (Vec3::X * -0.2, point(Vec3::X * 0.4, None), false),
    ] {
        assert_eq!(reaches(middle, light), expected, "{middle} {light:?}");
    }
}

#[test]
fn an_occluder_is_read_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let furrier = |arguments: &[&str]| Command::new(furrier_path()).args(arguments).assert();
    let furry = path("plane.glb");
    let size = ["--set", "guard.density_per_cm2=60"];
    furrier(&[&["bake", "sample:plane", "-q", "-o", &furry][..], &size].concat()).success();
    std::fs::write(path("empty.obj"), "v 0 0 0\n").unwrap();
    let picture = path("out.png");
    let view =
        |more: &[&str]| furrier(&[&["view", &furry, "--screenshot", &picture, "--size", "32x32"][..], more].concat());
    view(&["--occluder", &path("empty.obj")]).code(3).stderr(contains("the OBJ has no faces"));
    view(&["--occluder", &path("none.obj")]).code(3).stderr(contains("none.obj"));
    view(&["--occluder", "sample:sphere", "--show", "field"]).code(2).stderr(contains("--occluder"));
    view(&["--occluder", "sample:sphere"]).success();
    std::fs::write(path("far.obj"), "v 9 0 0\nv 9 1 0\nv 9 0 1\nf 1 2 3\n").unwrap();
    view(&["--occluder", &path("far.obj"), "--light", "dir:0,-1,0:3,3,3"])
        .success()
        .stderr(contains("casts no shadow"));
}
