//! From a mesh and a preset to a picture, against the same coat grown hair by hair: `sample:sphere`, one camera.

use furrier::asset::coat::{Fallback, read_coat};
use furrier::bake::picture::{Grown, Only, PictureRequest};
use furrier::bake::units::Units;
use furrier::bake::{Method, Request, bake};
use furrier::cast::Caster;
use furrier::cast::Geometry;
use furrier::cast::Rays;
use furrier::data::camera::Camera;
use furrier::data::ray::DepthRange;
use furrier::fur::groom::fibre::Fibre;
use furrier::fur::grow;
use furrier::math::Vec3;
use furrier::preset::Preset;
use furrier::runtime::Show;
use furrier::stage::camera::Viewpoint;
use furrier::stage::options;
use furrier::viewer::{Shown, ViewOptions, screenshot};

const RADIUS_M: f32 = 0.1;
const PIXELS: usize = 160;
const EYE: Vec3 = Vec3::new(0.2, 0.15, 0.75);
const SPARSE: [&str; 10] = [
    "guard.density_per_cm2=60",
    "guard.length.mm=14",
    "guard.shape.bend_deg=0",
    "guard.shape.noise=0",
    "guard.shape.clump.strength=0",
    "undercoat.density_per_cm2=120",
    "undercoat.length.mm=8",
    "undercoat.shape.bend_deg=0",
    "undercoat.shape.noise=0",
    "undercoat.shape.clump.strength=0",
];

fn preset(more: &[&str]) -> Preset {
    let settings: Vec<String> = SPARSE.iter().chain(more).map(|s| (*s).to_owned()).collect();
    Preset::load("fox").unwrap().with_settings(&settings).unwrap()
}

fn request(preset: Preset, out: &std::path::Path) -> Request {
    Request {
        input: "sample:sphere".into(),
        reading: Default::default(),
        out: out.to_owned(),
        preset,
        presets: vec![],
        materials: vec![],
        units: Units::Auto,
        method: Method::Lapped,
        seed: 1,
        fallback: Fallback::None,
        judge: false,
        cache: None,
        draft: false,
    }
}

fn camera() -> Camera {
    crate::scenes::looking(EYE, Vec3::ZERO, Vec3::Y, 20.0)
}

/// Mean alpha in the ring of `width_m` around the skin's outline.
fn ring(alpha: &[f32], width_m: f32) -> f32 {
    let rays = Rays::Perspective { view: crate::scenes::view(&camera(), [PIXELS; 2]), supersampling: 1 };
    let (mut sum, mut count) = (0.0, 0.0);
    for (i, a) in alpha.iter().enumerate() {
        let ray = rays.ray(i % PIXELS, i / PIXELS, 0);
        let closest = EYE - ray.direction * EYE.dot(ray.direction);
        if (0.0..width_m).contains(&(closest.length() - RADIUS_M)) {
            sum += a;
            count += 1.0;
        }
    }
    sum / count
}

/// Ring coverage as baked and drawn.
fn drawn(preset: &Preset, show: Show, width_m: f32) -> f32 {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("sphere.glb");
    bake(&request(preset.clone(), &out), &mut |_| {}).unwrap();
    let (asset, coat) = read_coat(&out).unwrap();
    let viewpoint = Viewpoint::Camera(camera());
    let stage = options::Options { size: [PIXELS as u32; 2], viewpoint, ..options::Options::default() };
    let options = ViewOptions { stage, show: Shown::Coat(show), ..ViewOptions::default() };
    let shot = screenshot(&asset, &coat, &options).unwrap();
    ring(&shot.picture.pixels.iter().map(|p| p[3]).collect::<Vec<_>>(), width_m)
}

/// Ring coverage of the same coat grown on the sphere, hair by hair.
fn strands(preset: &Preset, width_m: f32) -> f32 {
    let grown = Grown::new(&PictureRequest {
        input: "sample:sphere".into(),
        reading: Default::default(),
        preset: preset.clone(),
        materials: vec![],
        units: Units::Auto,
        seed: 3,
        only: Only::Hybrid,
        pose: None,
    })
    .unwrap();
    let scene = grown.scene();
    let fibre = Fibre::undercoat(&preset.undercoat, &preset.colour, scene.skin.diagonal_m());
    let undercoat = grow::skin::grow(&fibre, scene.skin, scene.fields, 9);
    let guard = scene.guard.map(|(strands, _)| strands);
    let scene = Geometry { guard, undercoat: Some(&undercoat), skin: Some(scene.skin), ..Geometry::default() };
    let rays = Rays::Perspective { view: crate::scenes::view(&camera(), [PIXELS; 2]), supersampling: 2 };
    ring(&Caster::new(scene).render(&rays, DepthRange::ALL).alpha, width_m)
}

#[test]
fn the_fringe_of_a_baked_sphere_is_that_of_its_strands_and_follows_density_and_length() {
    let all = Show::default();
    let width_m = 0.014;
    let cases: [(&str, &[&str]); 3] = [
        ("as it is", &[]),
        ("twice as dense", &["guard.density_per_cm2=120", "undercoat.density_per_cm2=240"]),
        ("half as long", &["guard.length.mm=7", "undercoat.length.mm=4"]),
    ];
    for (name, more) in cases {
        let preset = preset(more);
        let (ours, truth) = (drawn(&preset, all, width_m), strands(&preset, width_m));
        println!("{name}: ring coverage {ours:.3}, strands {truth:.3}");
        assert!((ours - truth).abs() <= 0.05, "{name}: {ours} for {truth}");
    }
    let bald = drawn(&preset(&[]), Show { shells: false, ..all }, width_m);
    let truth = strands(&preset(&[]), width_m);
    assert!((bald - truth).abs() > 0.05, "fins alone pass: {bald} for {truth}");
}

#[test]
fn a_colour_map_decides_the_colour_of_the_coat() {
    let folder = tempfile::tempdir().unwrap();
    let map = folder.path().join("colour.png");
    // Left half red, right half blue, by the sphere's own UV.
    let pixel = |x: u32, _| if x < 32 { image::Rgb([200, 20, 20]) } else { image::Rgb([20, 20, 200]) };
    image::RgbImage::from_fn(64, 64, pixel).save(&map).unwrap();
    let mut preset = preset(&[]);
    preset.maps.colour = Some(map);
    let out = folder.path().join("sphere.glb");
    bake(&request(preset, &out), &mut |_| {}).unwrap();
    let (asset, coat) = read_coat(&out).unwrap();
    let worn = &coat.primitives[0];
    let uv = &asset.parts[0].stored.uv_sets[0];
    let linear = |byte: f32| ((byte / 255.0 + 0.055) / 1.055).powf(2.4);
    let (strong, weak) = (linear(200.0), linear(20.0));
    // The file brings the map along; the tint does not change it.
    let texture = worn.colour.as_ref().expect("a texture of colour");
    let image = asset.document.decode_image(texture.image).unwrap().expect("a picture");
    let mut seen = [0; 2];
    for (&base, tint) in worn.base_vertex.iter().zip(&worn.tint) {
        let u = uv[base as usize].x;
        // Where the halves meet, filtering mixes them.
        if (u - 0.5).abs() < 0.03 || !(0.03..0.97).contains(&u) {
            continue;
        }
        let tint = tint.truncate() * texture.sample(&image, uv[base as usize]).truncate();
        let side = usize::from(u > 0.5);
        seen[side] += 1;
        let [own, other] = if side == 0 { [tint.x, tint.z] } else { [tint.z, tint.x] };
        assert!((own / strong - 1.0).abs() < 0.05 && (other - weak).abs() < 0.05 * strong, "u {u}: {tint}");
    }
    assert!(seen[0] > 100 && seen[1] > 100, "{seen:?}");
}
