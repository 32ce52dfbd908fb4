//! Pictures of assets with coats: framing, animation, contact sheets, reports.

use crate::coats;
use furrier::asset::{self, Asset, Pose};
use furrier::data::camera::Camera;
use furrier::data::coat::{Coat, CoatPrimitive, Tile};
use furrier::math::{Vec2, Vec3, Vec4};
use furrier::runtime::{Picture, Show};
use furrier::stage::camera::{Orbit, Viewpoint};
use furrier::stage::options;
use furrier::viewer::{self, Chart, Shown, ViewOptions, parse_show, stage};

/// `tile` carried on every part of `asset` that is not bare, hair along the normals, no fins.
pub fn dressed(asset: &Asset, tile: Tile) -> Coat {
    let mut coat = Coat { metres_per_unit: 1.0, ..Coat::default() };
    for part in asset.parts.iter().filter(|part| !asset::is_bare(&part.material_name)) {
        let mesh = part.mesh(1.0).unwrap();
        let (count, normals) = (mesh.positions_m.len(), mesh.smooth_normals());
        let uv = |p: &Vec3| Vec2::new(p.x, p.y + 0.7 * p.z) / tile.edge_m;
        coat.primitives.push(CoatPrimitive {
            mesh: part.mesh,
            primitive: part.primitive,
            tile: 0,
            base_vertex: (0..count as u32).collect(),
            uv: mesh.positions_m.iter().map(uv).collect(),
            patch: vec![0; count],
            offset: (0..count).map(|v| part.local_offset(v, normals[v] * tile.height_m, 1.0)).collect(),
            axis: vec![Vec3::ZERO; count],
            tint: vec![Vec4::ONE; count],
            triangles: part.stored.triangles.clone(),
            fins: vec![],
            ..CoatPrimitive::default()
        });
    }
    coat.tiles.push(tile);
    coat
}

pub fn creature() -> (Asset, Coat) {
    let asset = asset::load("sample:creature").unwrap();
    let coat = dressed(&asset, coats::tile(&coats::fox()[..1], 0.008, 4, 32, 1));
    (asset, coat)
}

pub fn small() -> ViewOptions {
    staged([96, 72], Viewpoint::default())
}

fn staged(size: [u32; 2], viewpoint: Viewpoint) -> ViewOptions {
    ViewOptions { stage: options::Options { size, viewpoint, ..options::Options::default() }, ..ViewOptions::default() }
}

/// The rows and columns that hold anything: top, bottom, left, right.
fn extent(picture: &Picture) -> [usize; 4] {
    let (width, height) = (picture.size[0] as usize, picture.size[1] as usize);
    let lit = |x: usize, y: usize| picture.pixels[y * width + x][3] > 0.02;
    let row = |y: &usize| (0..width).any(|x| lit(x, *y));
    let column = |x: &usize| (0..height).any(|y| lit(*x, y));
    let rows = ((0..height).find(row).unwrap(), (0..height).rev().find(row).unwrap());
    let columns = ((0..width).find(column).unwrap(), (0..width).rev().find(column).unwrap());
    [rows.0, rows.1, columns.0, columns.1]
}

#[test]
fn the_whole_asset_fits_from_every_side() {
    let (asset, coat) = creature();
    for (azimuth_deg, elevation_deg) in [(0.0, 0.0), (35.0, 12.0), (120.0, -40.0), (260.0, 80.0)] {
        let viewpoint = Viewpoint::Orbit(Orbit { azimuth_deg, elevation_deg, distance: 1.0 });
        let shot = viewer::screenshot(&asset, &coat, &staged([96, 72], viewpoint)).unwrap();
        let [top, bottom, left, right] = extent(&shot.picture);
        assert!(top > 0 && bottom < 71 && left > 0 && right < 95, "cut off at {azimuth_deg}, {elevation_deg}");
        assert!(bottom - top > 50 || right - left > 70, "small at {azimuth_deg}, {elevation_deg}");
    }
}

#[test]
fn shells_move_with_the_skin() {
    let (asset, coat) = creature();
    let animation = asset.animation_names().into_iter().next().unwrap();
    let index = asset.animation(&animation).unwrap();
    let points = |pose: &Pose| stage::points_m(&stage::scene(&asset, &coat, &Default::default(), pose));
    let end_s = 1.0; // of its walk
    let rest = points(&asset.rest_pose().unwrap());
    let middle = rest.iter().sum::<Vec3>() / rest.len() as f32;
    let reach = rest.iter().map(|p| p.distance(middle)).fold(0.0, f32::max);
    // A fixed camera, so that only the animation moves anything.
    let eye = middle + Vec3::new(0.8, 0.2, 1.0).normalize() * reach * 4.0;
    let origin = asset.parts[0].centre_units;
    let at = |p: Vec3| (p.as_dvec3() + origin).into();
    let camera = Camera { eye: at(eye), target: at(middle), up: [0.0, 1.0, 0.0], vfov_deg: 40.0 };
    let shot = |seconds: Option<f64>, show: Show| {
        let moment = seconds.map(|s| (animation.clone(), s));
        let options = ViewOptions { show: Shown::Coat(show), moment, ..staged([96, 72], Viewpoint::Camera(camera)) };
        viewer::screenshot(&asset, &coat, &options).unwrap().picture
    };
    let difference =
        |a: &Picture, b: &Picture| a.pixels.iter().zip(&b.pixels).map(|(a, b)| (a[3] - b[3]).abs()).sum::<f32>();
    let skin = Show { skin: true, shells: false, fins: false };
    let skin_at_rest = shot(None, skin);
    // The moment at which points are farthest from where they rest.
    let travel = |s: f64| {
        let posed = points(&asset.pose(index, s).unwrap());
        posed.iter().zip(&rest).map(|(a, b)| a.distance(*b)).sum::<f32>()
    };
    let moved_s =
        (1..20).map(|i| end_s * f64::from(i) / 20.0).max_by(|&a, &b| travel(a).total_cmp(&travel(b))).unwrap();
    let skin_moves = difference(&skin_at_rest, &shot(Some(moved_s), skin));
    let (rest_shot, moved) = (shot(None, Show::default()), shot(Some(moved_s), Show::default()));
    assert!(skin_moves > 20.0 && difference(&rest_shot, &moved) > 0.5 * skin_moves, "skin moves {skin_moves}");
    // Hair that stayed behind would stand where skin was: beyond a hair's length of the skin nothing may be.
    let skin_moved = shot(Some(moved_s), skin);
    let near = |i: usize| {
        let (x, y) = ((i % 96) as i64, (i / 96) as i64);
        let reach = 5;
        (-reach..=reach).any(|dy| {
            (-reach..=reach).any(|dx| {
                let (x, y) = (x + dx, y + dy);
                (0..96).contains(&x) && (0..72).contains(&y) && skin_moved.pixels[(y * 96 + x) as usize][3] > 0.0
            })
        })
    };
    let stray = (0..moved.pixels.len()).filter(|&i| moved.pixels[i][3] > 0.02 && !near(i)).count();
    assert_eq!(stray, 0, "hair far from the skin");
}

#[test]
fn a_sheet_holds_every_view() {
    let (asset, coat) = creature();
    let shot = viewer::turntable(&asset, &coat, &small(), 3).unwrap();
    assert_eq!(shot.picture.size, [192, 144]);
    assert_eq!(shot.report.counts["pictures"].whole(), 3);
    let cell = |x: usize, y: usize| {
        let rows = (y * 72..y * 72 + 72).flat_map(|row| (x * 96..x * 96 + 96).map(move |column| row * 192 + column));
        rows.map(|i| shot.picture.pixels[i][3]).sum::<f32>()
    };
    assert!(cell(0, 0) > 500.0 && cell(1, 0) > 500.0 && cell(0, 1) > 500.0);
    assert_eq!(cell(1, 1), 0.0);
    let front = viewer::screenshot(&asset, &coat, &small()).unwrap().picture;
    for (sheet_row, row) in shot.picture.pixels.chunks_exact(192).zip(front.pixels.chunks_exact(96)) {
        assert_eq!(&sheet_row[..96], row);
    }
    assert!(viewer::turntable(&asset, &coat, &small(), 0).is_err());
}

#[test]
fn a_report_says_what_was_drawn() {
    let (asset, coat) = creature();
    let report = viewer::screenshot(&asset, &coat, &small()).unwrap().report;
    for step in ["open device", "draw: shadow map", "draw: skin", "draw: coat", "draw: develop"] {
        assert!(report.steps.0.iter().any(|s| s.name == step), "{step} is missing");
    }
    let furred: u64 = coat.primitives.iter().map(|p| p.triangles.len() as u64).sum();
    let all: u64 = asset.parts.iter().map(|p| p.stored.triangles.len() as u64).sum();
    // Skin once into the shadow map and once into the picture; of three slabs no more than is seen from one side.
    let coat = report.counts["triangles"].whole() - 2 * all;
    assert!((furred..3 * furred).contains(&coat), "{coat} triangles of {furred} in three slabs");
    assert!(!report.device.is_empty() && report.total_ms > 0.0);
}

#[test]
fn flags_are_read_or_refused() {
    assert_eq!(parse_show("skin, fins").unwrap(), Shown::Coat(Show { skin: true, shells: false, fins: true }));
    assert_eq!(parse_show("stretch").unwrap(), Shown::Chart(Chart::Stretch));
    assert!(parse_show("skin,field").unwrap_err().expected.unwrap().contains("field alone"));
    assert!(parse_show("skin,hair").unwrap_err().found.unwrap().contains("hair"));
    assert!(Camera::from_json(r#"{"eye": [0,0,1], "target": [0,0,0]}"#).is_ok());
    for bad in [
        r#"{"eye": [0,0,1], "target": [0,0,1]}"#,
        r#"{"eye": [0,1,0], "target": [0,0,0]}"#,
        r#"{"eye": [0,0,1], "target": [0,0,0], "fov": 40}"#,
        r#"{"eye": [0,0,1], "target": [0,0,0], "vfov_deg": 180}"#,
    ] {
        assert!(Camera::from_json(bad).is_err(), "{bad}");
    }
}

/// Share of the seen pixels that `wanted` finds in a chart of the creature.
fn charted(coat: &Coat, asset: &Asset, chart: Chart, wanted: impl Fn(Vec3) -> bool) -> (f64, Vec<String>) {
    let options = ViewOptions { show: Shown::Chart(chart), ..staged([320, 240], Viewpoint::default()) };
    let shot = viewer::screenshot(asset, coat, &options).unwrap();
    let seen: Vec<Vec3> =
        shot.picture.pixels.iter().filter(|p| p[3] > 0.99).map(|p| Vec3::new(p[0], p[1], p[2])).collect();
    assert!(seen.len() > 500, "nothing is drawn");
    (seen.iter().filter(|c| wanted(**c)).count() as f64 / seen.len() as f64, shot.legend)
}

#[test]
fn charts_show_what_they_measure() {
    let (asset, mut coat) = creature();
    let vivid = |c: Vec3| c.max_element() > 4.0 * c.min_element().max(1e-3);
    for (p, patch) in coat.primitives.iter_mut().flat_map(|worn| worn.patch.iter_mut().enumerate()) {
        *patch = u32::from(p % 2 == 0);
    }
    let (coloured, legend) = charted(&coat, &asset, Chart::Patches, vivid);
    assert!(coloured > 0.2, "{coloured}");
    assert!(legend[0].starts_with("2 patches"), "{legend:?}");

    // Squeeze all of the texture far beyond what the map shows: all furred skin turns yellow.
    let yellow = |c: Vec3| c.z < 0.3 * c.x && c.y > 0.5 * c.x;
    for uv in coat.primitives.iter_mut().flat_map(|worn| &mut worn.uv) {
        *uv *= 50.0;
    }
    let (beyond, legend) = charted(&coat, &asset, Chart::Stretch, yellow);
    assert!(beyond > 0.6, "{beyond} {legend:?}");
    assert!(legend[1].contains("0.0 % within 0.7"), "{legend:?}");

    // Hair along the normals has no direction; leaning hair has strokes, dark on light.
    let dark = |c: Vec3| c.max_element() < 0.12;
    let (upright, legend) = charted(&coat, &asset, Chart::Field, dark);
    assert!(legend[1].contains("mm long"), "{legend:?}");
    for worn in &mut coat.primitives {
        let length = worn.offset[0].length();
        worn.offset.iter_mut().for_each(|o| *o = (*o + Vec3::new(0.0, -0.2, -0.6) * length).normalize() * length);
    }
    let (leaning, _) = charted(&coat, &asset, Chart::Field, dark);
    assert!(leaning > upright + 0.005, "{upright} {leaning}");
}

#[test]
fn a_sequence_plays_an_animation_or_turns_around() {
    let (asset, coat) = creature();
    let name = asset.animation_names().into_iter().next().unwrap();
    let seconds = asset.animation_seconds(asset.animation(&name).unwrap()).unwrap();
    let taken = |options: &ViewOptions, still: bool| {
        let mut pictures = Vec::new();
        let each = &mut |picture: &Picture, image: &furrier::data::image::Image8| {
            assert_eq!((image.width, image.height), (96, 72));
            pictures.push(picture.clone());
            Ok(())
        };
        viewer::sequence(&asset, &coat, options, (4, still), each).unwrap();
        pictures
    };
    let at = |time: f64| ViewOptions { moment: Some((name.clone(), time)), ..small() };
    let shot = |options: &ViewOptions| viewer::screenshot(&asset, &coat, options).unwrap().picture;
    let played = taken(&at(0.0), false);
    assert_eq!(played.len(), 4);
    assert_eq!(played[1], shot(&at(0.25 * seconds)));
    assert_ne!(played[0], played[1]);
    let turned = taken(&at(0.25 * seconds), true);
    assert_eq!(turned[0], played[1]);
    let Viewpoint::Orbit(orbit) = Viewpoint::default() else { panic!("an orbit") };
    let half = Viewpoint::Orbit(Orbit { azimuth_deg: orbit.azimuth_deg + 180.0, ..orbit });
    assert_eq!(turned[2], shot(&ViewOptions { moment: at(0.25 * seconds).moment, ..staged([96, 72], half) }));
    let many = viewer::sequence(&asset, &coat, &small(), (0, false), &mut |_, _| Ok(())).unwrap_err();
    assert_eq!(many.parameter, Some("frames"));
}
