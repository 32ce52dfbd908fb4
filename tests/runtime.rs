//! The runtime's pictures of hand-made coats: order, light, what is shown, and a golden one.

use crate::coats;
use furrier::data::camera::Camera;
use furrier::data::coat::Tile;
use furrier::data::image::{Image8, srgb_from_linear, unorm8};
use furrier::data::light::Directional;
use furrier::error::Kind;
use furrier::gpu::{Choice, Gpu};
use furrier::math::{DVec3, Vec3, Vec4};
use furrier::metrics::compare::{Difference, LinearImage, compare, load};
use furrier::runtime::gpu::Renderer;
use furrier::runtime::{Blending, Frame, Picture, Show, SkinMesh};
use std::path::Path;

/// Looks at the origin from `eye`.
pub fn look(eye: Vec3, size: [u32; 2]) -> Frame {
    let camera = Camera { eye: eye.as_dvec3().into(), target: [0.0; 3], up: [0.0, 1.0, 0.0], vfov_deg: 30.0 };
    let (far, aspect) = (f64::from(eye.length()) * 2.0, f64::from(size[0]) / f64::from(size[1]));
    Frame {
        clip_from_world: camera.clip_from_world(DVec3::ZERO, aspect, far * 0.05, far).as_mat4(),
        eye: Vec4::from((eye, 1.0)),
        size,
        lights: vec![
            Directional { to_light: Vec3::new(-0.5, 0.7, 0.6).normalize(), irradiance: Vec3::splat(3.0) }.into(),
        ],
        ambient: Vec3::splat(0.5),
        shadow_map: true,
        depths: false,
        level: None,
    }
}

fn small_tile() -> Tile {
    coats::tile(&coats::fox(), 0.008, 8, 64, 1)
}

/// The golden scene: a small furred ball.
pub fn ball() -> Picture {
    let gpu = Gpu::open(&Choice::Auto).unwrap();
    let tiles = [small_tile()];
    let ball = coats::sphere(0.05, 10, 0.5, &tiles[0]);
    let renderer = Renderer::new(&gpu, &tiles, 1).unwrap();
    renderer
        .prepare(&ball.scene(&tiles))
        .unwrap()
        .draw(&look(Vec3::new(0.05, 0.05, 0.26), [96, 96]), Show::default())
        .unwrap()
        .picture
}

fn light(picture: &Picture) -> LinearImage {
    LinearImage {
        width: picture.size[0] as usize,
        height: picture.size[1] as usize,
        colour: picture.pixels.iter().map(|p| Vec3::new(p[0], p[1], p[2])).collect(),
        alpha: picture.pixels.iter().map(|p| p[3]).collect(),
    }
}

fn coded(light: &LinearImage) -> Image8 {
    let mut image = Image8::new(light.width as u32, light.height as u32, 4);
    for ((out, colour), &alpha) in image.pixels.chunks_exact_mut(4).zip(&light.colour).zip(&light.alpha) {
        let straight = *colour / alpha.max(1e-6);
        out[..3].copy_from_slice(&straight.to_array().map(|c| unorm8(srgb_from_linear(c))));
        out[3] = unorm8(alpha);
    }
    image
}

/// Compares with the golden picture `name`; FURRIER_UPDATE_GOLDEN=1 writes it instead. A missing one fails.
fn against_golden(picture: &Picture, name: &str) -> Difference {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(name);
    let light = light(picture);
    if std::env::var_os("FURRIER_UPDATE_GOLDEN").is_some() {
        let image = coded(&light);
        image::save_buffer(&path, &image.pixels, image.width, image.height, image::ColorType::Rgba8).unwrap();
    }
    compare(&load(&path).unwrap(), &light).unwrap()
}

/// What two adapters may differ by, and eight bits.
pub fn like_golden(difference: &Difference) -> bool {
    difference.flip < 0.02
        && difference.bias.abs() < 0.02
        && (difference.coverage[0] - difference.coverage[1]).abs() < 0.005
}

#[test]
fn the_ball_looks_as_it_did() {
    let difference = against_golden(&ball(), "ball.png");
    println!("{difference:?}");
    assert!(like_golden(&difference), "{difference:?}");
}

#[test]
fn every_kind_of_geometry_adds_to_the_picture() {
    let gpu = Gpu::open(&Choice::Auto).unwrap();
    let tiles = [small_tile()];
    let ball = coats::sphere(0.05, 10, 0.5, &tiles[0]);
    let renderer = Renderer::new(&gpu, &tiles, 1).unwrap();
    let view = look(Vec3::new(0.05, 0.05, 0.26), [64, 64]);
    let none = Show { skin: false, shells: false, fins: false };
    let mut prepared = renderer.prepare(&ball.scene(&tiles)).unwrap();
    let mut coverage = |show| prepared.draw(&view, show).unwrap().picture.coverage();
    assert_eq!(coverage(none), 0.0);
    let skin = coverage(Show { skin: true, ..none });
    let shells = coverage(Show { shells: true, ..none });
    let fins = coverage(Show { fins: true, ..none });
    let all = coverage(Show::default());
    assert!(skin > 0.3 && shells > skin && fins > 0.05 && all > skin + 0.05, "{skin} {shells} {fins} {all}");
}

#[test]
fn light_adds_up_and_darkness_is_dark() {
    let gpu = Gpu::open(&Choice::Auto).unwrap();
    let tiles = [small_tile()];
    let ball = coats::sphere(0.05, 10, 0.5, &tiles[0]);
    let renderer = Renderer::new(&gpu, &tiles, 1).unwrap();
    let mut prepared = renderer.prepare(&ball.scene(&tiles)).unwrap();
    let mut view = look(Vec3::new(0.05, 0.05, 0.26), [48, 48]);
    let mut sum = |lights: &[Directional], ambient: f32| -> f64 {
        view.lights = lights.iter().copied().map(Into::into).collect();
        view.ambient = Vec3::splat(ambient);
        let picture = prepared.draw(&view, Show::default()).unwrap().picture;
        picture.pixels.iter().map(|p| f64::from(p[0] + p[1] + p[2])).sum()
    };
    let above = Directional { to_light: Vec3::Y, irradiance: Vec3::ONE };
    let left = Directional { to_light: Vec3::NEG_X, irradiance: Vec3::splat(2.0) };
    // The first light is the key; further ones fill, and are shadowed otherwise.
    let dark = Directional { irradiance: Vec3::ZERO, ..above };
    let (a, b, c) = (sum(&[above], 0.0), sum(&[dark, left], 0.0), sum(&[], 0.3));
    assert_eq!(sum(&[], 0.0), 0.0);
    let all = sum(&[above, left], 0.3);
    assert!((all / (a + b + c) - 1.0).abs() < 5e-3, "{all} for {a} + {b} + {c}");
}

/// Views of one pose do not remember each other: camera, light, size and what is shown change from one to the next.
#[test]
fn a_prepared_pose_is_drawn_from_anywhere() {
    let gpu = Gpu::open(&Choice::Auto).unwrap();
    let tiles = [small_tile()];
    let ball = coats::sphere(0.05, 10, 0.5, &tiles[0]);
    let renderer = Renderer::new(&gpu, &tiles, 2).unwrap();
    let front = look(Vec3::new(0.05, 0.05, 0.26), [40, 32]);
    let above = Frame { ambient: Vec3::splat(0.1), ..look(Vec3::new(0.01, 0.24, 0.02), [40, 32]) };
    let larger = look(Vec3::new(-0.2, 0.0, 0.1), [64, 48]);
    let bare = Show { shells: false, fins: false, ..Show::default() };
    let all = [(&front, Show::default()), (&above, Show::default()), (&above, bare), (&larger, Show::default())];
    let anew = all.map(|(view, show)| renderer.prepare(&ball.scene(&tiles)).unwrap().draw(view, show).unwrap());
    let mut prepared = renderer.prepare(&ball.scene(&tiles)).unwrap();
    for i in [0, 1, 2, 3, 0, 2, 1] {
        let (view, show) = all[i];
        assert_eq!(prepared.draw(view, show).unwrap().picture, anew[i].picture, "view {i}");
    }
    for (i, j) in [(0, 1), (1, 2)] {
        assert_ne!(anew[i].picture, anew[j].picture);
    }
}

/// A black plate that hides the right half of the ball, its edge aslant.
fn plate<'a>() -> SkinMesh<'a> {
    let corner = |x: f32, y: f32| Vec3::new(x, y, 0.12);
    SkinMesh {
        positions_m: vec![corner(-0.05, -0.2), corner(0.3, -0.2), corner(0.05, 0.2), corner(0.3, 0.2)],
        normals: vec![Vec3::Z; 4],
        colour: vec![Vec3::ZERO; 4],
        triangles: vec![[0, 1, 2], [2, 1, 3]],
        ..SkinMesh::default()
    }
}

#[test]
fn a_bare_edge_before_fur_is_smooth() {
    let gpu = Gpu::open(&Choice::Auto).unwrap();
    let tiles = [small_tile()];
    let ball = coats::sphere(0.05, 10, 0.5, &tiles[0]);
    let mut scene = ball.scene(&tiles);
    scene.skins.push(plate());
    let frame = look(Vec3::new(0.0, 0.0, 0.3), [96, 96]);
    let [once, finely] = [1, 6].map(|samples| {
        let renderer = Renderer::new(&gpu, &tiles, samples).unwrap();
        renderer.prepare(&scene).unwrap().draw(&frame, Show::default()).unwrap().picture
    });
    // How much of the fur's green an edge lets through, by rows: with whole pixels it would be off by a quarter in the mean.
    let mut off = vec![];
    for row in 40..56 {
        let at = |picture: &Picture, x: usize| picture.pixels[row * 96 + x][1];
        let fur = (30..36).map(|x| at(&finely, x)).sum::<f32>() / 6.0;
        for x in 40..60 {
            let share = at(&finely, x) / fur;
            if (0.1..0.9).contains(&share) && at(&finely, x + 1) < 0.1 * fur {
                off.push((at(&once, x) / fur - share).abs());
            }
        }
    }
    let mean = off.iter().sum::<f32>() / off.len() as f32;
    println!("off by {mean:.3} at {} places", off.len());
    assert!(off.len() >= 8 && mean < 0.2, "{mean} at {}", off.len());
}

#[test]
fn costs_are_counted() {
    let gpu = Gpu::open(&Choice::Auto).unwrap();
    let tiles = [small_tile()];
    let ball = coats::sphere(0.05, 10, 0.5, &tiles[0]);
    let renderer = Renderer::new(&gpu, &tiles, 1).unwrap();
    let mut prepared = renderer.prepare(&ball.scene(&tiles)).unwrap();
    let frame = look(Vec3::new(0.05, 0.05, 0.26), [96, 96]);
    let middle = 48 * 96 + 48;
    let mut at = |frame: &Frame, show: Show| {
        let [fragments, reads, ..] = prepared.cost(frame, show, Blending::Sorted).unwrap().pixels[middle];
        (fragments, reads)
    };
    // Skin alone: what it may read of its tile, of what is painted and of its colour, and the shadow map's four.
    let skin = Show { shells: false, fins: false, ..Show::default() };
    assert_eq!(at(&frame, skin), (1.0, 17.0));
    let unshadowed = Frame { shadow_map: false, ..frame.clone() };
    assert_eq!(at(&unshadowed, skin), (1.0, 13.0));
    // Seven shells: each reads its medium at least once, its ends and the skin's edge; what shows also its colour and the map.
    let shells = Show { skin: false, fins: false, ..Show::default() };
    let (fragments, reads) = at(&frame, shells);
    let (_, without) = at(&unshadowed, shells);
    println!("{fragments} fragments, {reads} reads, {without} without the map");
    assert!((3.0..=7.0).contains(&fragments) && reads >= 3.0 * fragments);
    assert!(reads - without > 0.0 && reads - without <= fragments);
    // On a slant a slab is fetched along the ray, tap after tap: each shell reads more than where it is seen from straight above.
    let all = prepared.cost(&unshadowed, shells, Blending::Sorted).unwrap();
    let per_shell = |pixel: &[f32; 4]| pixel[1] / pixel[0];
    let slanted = all.pixels.iter().filter(|pixel| pixel[0] >= 3.0).map(per_shell).fold(0.0, f32::max);
    println!("{slanted} reads of a shell at the most, {} in the middle", per_shell(&all.pixels[middle]));
    assert!(slanted > 6.0, "{slanted}");
}

#[test]
fn what_lies_behind_opaque_hair_is_not_shaded() {
    let gpu = Gpu::open(&Choice::Auto).unwrap();
    let tiles = [small_tile()];
    let ball = coats::sphere(0.05, 10, 0.0, &tiles[0]);
    let renderer = Renderer::new(&gpu, &tiles, 1).unwrap();
    let frame = look(Vec3::new(0.0, 0.0, 0.3), [48, 48]);
    let middle = 24 * 48 + 24;
    let drawn = |density: f32| {
        let mut scene = ball.scene(&tiles);
        scene.furs[0].tint = scene.furs[0].tint.iter().map(|tint| tint.truncate().extend(density)).collect();
        let mut prepared = renderer.prepare(&scene).unwrap();
        let fragments = prepared.cost(&frame, Show::default(), Blending::Sorted).unwrap().pixels[middle][0];
        (fragments, prepared.draw(&frame, Show::default()).unwrap().picture.pixels[middle])
    };
    // Skin and seven shells where hair is thin; of dense hair the first few and no skin, and still nothing is seen through it.
    let ((thin, _), (dense, pixel)) = (drawn(0.02), drawn(40.0));
    println!("{thin} fragments of thin hair, {dense} of dense: {pixel:?}");
    assert_eq!(thin, 8.0);
    assert!(dense <= 4.0 && pixel[3] == 1.0, "{dense} {pixel:?}");
    assert!(pixel[..3].iter().all(|light| (0.01..3.0).contains(light)), "{pixel:?}");
}

/// The ball by all blends.
fn blended(show: Show) -> [Picture; 3] {
    let gpu = Gpu::open(&Choice::Auto).unwrap();
    let tiles = [small_tile()];
    let ball = coats::sphere(0.05, 10, 0.5, &tiles[0]);
    let renderer = Renderer::new(&gpu, &tiles, 1).unwrap();
    let mut prepared = renderer.prepare(&ball.scene(&tiles)).unwrap();
    let frame = look(Vec3::new(0.05, 0.05, 0.26), [96, 96]);
    [Blending::Sorted, Blending::Weighted, Blending::Hashed]
        .map(|blend| prepared.draw_by(&frame, show, blend).unwrap().picture)
}

/// Mean of a channel.
fn mean(picture: &Picture, channel: usize) -> f32 {
    picture.pixels.iter().map(|pixel| pixel[channel]).sum::<f32>() / picture.pixels.len() as f32
}

#[test]
fn blends_without_an_order_come_near_the_sorted_one() {
    let [sorted, weighted, hashed] = blended(Show::default());
    // A coarse ball from near by, between whose locks the skin shows, is the worst for both.
    for (name, picture, most) in [("weighted", &weighted, 0.15), ("hashed", &hashed, 0.3)] {
        let flip = compare(&light(&sorted), &light(picture)).unwrap().flip;
        let off: Vec<f32> = (0..4).map(|c| mean(picture, c) / mean(&sorted, c) - 1.0).collect();
        println!("{name}: FLIP {flip:.4}, channels and coverage off by {off:?}");
        assert!(flip < most && off.iter().all(|off| off.abs() < 0.1), "{name}: {flip} {off:?}");
    }
    // Without the skin, shells and fins alone: what comes through is multiplied, whatever the order.
    let [sorted, weighted, hashed] = blended(Show { skin: false, ..Show::default() });
    let same = sorted.pixels.iter().zip(&weighted.pixels).map(|(a, b)| (a[3] - b[3]).abs()).fold(0.0, f32::max);
    println!("alpha off by {same:.4} at the most; hashed {:.4} of it in the mean", mean(&hashed, 3) / mean(&sorted, 3));
    assert!(same < 0.021, "{same}");
    assert!((mean(&hashed, 3) / mean(&sorted, 3) - 1.0).abs() < 0.03);
    // There or not: nothing in between.
    assert!(hashed.pixels.iter().all(|pixel| pixel[3] == 0.0 || pixel[3] == 1.0));
}

#[test]
fn what_cannot_be_drawn_is_refused() {
    let gpu = Gpu::open(&Choice::Auto).unwrap();
    let tiles = [small_tile()];
    let ball = coats::sphere(0.05, 4, 0.0, &tiles[0]);
    let kind = |result: furrier::Result<_>| result.map(|_: furrier::runtime::gpu::Drawn| ()).unwrap_err().kind;
    let renderer = Renderer::new(&gpu, &tiles, 1).unwrap();
    let view = look(Vec3::Z, [16, 16]);
    for view in [Frame { size: [0, 16], ..view.clone() }, Frame { size: [1_000_000, 16], ..view.clone() }] {
        assert_eq!(kind(renderer.prepare(&ball.scene(&tiles)).unwrap().draw(&view, Show::default())), Kind::Usage);
    }
    let many = Frame { lights: vec![view.lights[0]; 17], ..view };
    assert_eq!(kind(renderer.prepare(&ball.scene(&tiles)).unwrap().draw(&many, Show::default())), Kind::Usage);
    assert_eq!(Renderer::new(&gpu, &tiles, 9).err().unwrap().kind, Kind::Usage);
    let mut broken = small_tile();
    broken.shells.medium[1].pop();
    assert_eq!(Renderer::new(&gpu, &[broken], 1).err().unwrap().kind, Kind::Input);
}

#[test]
fn an_adapter_that_is_not_there_is_named() {
    let error = Gpu::open(&"gpu:no such adapter".parse().unwrap()).err().unwrap();
    assert_eq!(error.kind, Kind::Device);
    assert!(error.found.unwrap().contains("no such adapter") && error.hint.is_some());
    assert!("cuda".parse::<Choice>().unwrap_err().expected.is_some());
    assert!(furrier::gpu::missing_adapter_hint().contains("mesa-vulkan-drivers") || !cfg!(target_os = "linux"));
}
