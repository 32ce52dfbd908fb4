//! The hybrid renderer on a graphics device against the same renderer on the CPU, pixel by pixel.

use crate::common::{framing, studio};
use crate::scenes::{self, Grown};
use furrier::bake::picture::{self as depicted, Only, PictureRequest};
use furrier::data::camera::Camera;
use furrier::data::film::Film;
use furrier::data::image::Image8;
use furrier::data::light::{Directional, Point, Spot};
use furrier::fur::groom::Clump;
use furrier::gpu::{Choice, Gpu};
use furrier::hybrid::device::{Device, Drawn, with_fallback};
use furrier::hybrid::gpu;
use furrier::hybrid::resolve::Blending;
use furrier::hybrid::{Settings, draw, prepare};
use furrier::math::Vec3;
use furrier::metrics::compare::{LinearImage, compare};
use furrier::preset::Preset;
use furrier::stage::background::Background;
use furrier::stage::tone::{Development, develop};
use furrier::volume::march::content::Resolution;
use furrier::volume::scene::{Lighting, Scene};
use std::cell::Cell;

/// The share of pixels of which no channel differs by more than 1/255.
pub fn share_alike(a: &Image8, b: &Image8) -> f64 {
    let near = |(a, b): (&[u8], &[u8])| a.iter().zip(b).all(|(a, b)| a.abs_diff(*b) <= 1);
    let count = a.pixels.chunks_exact(4).zip(b.pixels.chunks_exact(4)).filter(|&pair| near(pair)).count();
    count as f64 / (a.pixels.len() / 4) as f64
}

fn developed(film: &Film) -> Image8 {
    develop(film, &Development { background: Background::Colour(Vec3::splat(0.2)), ..Development::default() })
}

fn on_gpu(scene: &Scene<'_>, lighting: &Lighting, camera: &Camera, settings: &Settings) -> Film {
    let gpu = Gpu::open(&Choice::Auto).unwrap();
    let prepared = prepare(scene, lighting, settings).unwrap();
    gpu::prepare(&gpu, &prepared).unwrap().draw(camera, settings.band_bytes).unwrap().film
}

/// Holds both pictures to each other, layer by layer.
fn hold(scene: &Scene<'_>, lighting: &Lighting, camera: &Camera, settings: &Settings) {
    let cpu = draw(scene, lighting, camera, settings).unwrap().film;
    let gpu = on_gpu(scene, lighting, camera, settings);
    let (a, b) = (developed(&cpu), developed(&gpu));
    let share = share_alike(&a, &b);
    let flip = compare(&LinearImage::from(&cpu), &LinearImage::from(&gpu)).unwrap().flip;
    let mean = |of: &dyn Fn(usize) -> f32| (0..cpu.alpha.len()).map(of).sum::<f32>() / cpu.alpha.len() as f32;
    println!(
        "{share:.5} of the pixels alike, FLIP {flip:.5}, coverage {:.4} and {:.4}",
        cpu.coverage(),
        gpu.coverage()
    );
    assert!(cpu.coverage() > 0.01, "nothing is seen");
    assert!(share >= 0.999, "only {share} of the pixels are alike");
    assert!(flip <= 0.005, "FLIP {flip}");
    for (layer, difference) in [
        ("radiance", mean(&|i| (cpu.radiance[i] - gpu.radiance[i]).abs().max_element())),
        ("albedo", mean(&|i| (cpu.albedo[i] - gpu.albedo[i]).abs().max_element())),
        ("tangent", mean(&|i| (cpu.tangent[i] - gpu.tangent[i]).abs().max_element())),
        ("normal", mean(&|i| (cpu.normal[i] - gpu.normal[i]).abs().max_element())),
        ("guard", mean(&|i| (cpu.guard[i] - gpu.guard[i]).abs())),
        ("undercoat", mean(&|i| (cpu.undercoat[i] - gpu.undercoat[i]).abs())),
        ("depth", mean(&|i| (cpu.depth_m[i] - gpu.depth_m[i]).abs() / cpu.depth_m[i].max(1e-3))),
    ] {
        assert!(difference < 1e-3, "{layer} differs by {difference} in the mean");
    }
}

fn scene(guard_per_cm2: f32, clumped: bool) -> Grown {
    let (mut guard, mut undercoat) = scenes::mink();
    guard.density_per_cm2 = guard_per_cm2;
    if clumped {
        undercoat.shape.clump = Clump { spacing_mm: 4.0, strength: 0.6 };
    }
    Grown::new(scenes::bent_skin(1), &guard, &undercoat, Vec3::X, 35.0, 3)
}

fn small() -> Settings {
    Settings { size: [80, 64], ..Settings::default() }
}

#[test]
fn a_scene_in_bands_and_samples_looks_the_same_on_both() {
    let grown = scene(120.0, true);
    // Room for a few rows at a time, and lists that are too short at first.
    let settings = Settings { halvings: 1, band_bytes: 3 << 20, ..small() };
    hold(&grown.scene(), &scenes::studio(), &scenes::camera(0.35), &settings);
}

#[test]
fn a_preview_looks_the_same_on_both() {
    let settings = Settings::preview(small().size);
    hold(&scene(400.0, true).scene(), &scenes::studio(), &scenes::camera(0.35), &settings);
}

#[test]
fn simplified_blending_under_many_lights_looks_the_same_on_both() {
    let grown = scene(60.0, false);
    let settings = Settings { blending: Blending::Simplified { attenuation_per_m: 400.0 }, ..small() };
    let mut lighting = scenes::studio();
    lighting.fill_on_undercoat = true;
    for towards in [Vec3::new(-1.0, -0.5, 0.3), Vec3::new(0.2, 1.0, 0.1)] {
        lighting.fill.push(Directional::travelling(towards, Vec3::new(0.8, 1.0, 1.4)).unwrap().into());
    }
    hold(&grown.scene(), &lighting, &scenes::camera(0.35), &settings);
}

#[test]
fn lamps_and_cones_look_the_same_on_both() {
    let grown = scene(60.0, true);
    let key = Point::new(Vec3::new(-0.1, 0.15, 0.1), Vec3::new(0.25, 0.3, 0.2), Some(0.4)).unwrap();
    let over = Point::new(Vec3::new(0.08, 0.12, -0.02), Vec3::new(0.1, 0.05, 0.2), None).unwrap();
    let spot = Spot::new(over, Vec3::new(-0.3, -1.0, 0.1), 0.2, 0.5).unwrap();
    let lighting = Lighting { key: key.into(), fill: vec![spot.into()], fill_on_undercoat: true, ..scenes::studio() };
    hold(&grown.scene(), &lighting, &scenes::camera(0.35), &small());
    let swapped = Lighting { key: spot.into(), fill: vec![key.into()], ..lighting };
    hold(&grown.scene(), &swapped, &scenes::camera(0.35), &small());
}

#[test]
fn each_kind_of_hair_alone_and_bare_skin_look_the_same_on_both() {
    let grown = scene(60.0, false);
    for (guard, undercoat) in [(true, false), (false, true), (false, false)] {
        let mut scene = grown.scene();
        scene.guard = scene.guard.filter(|_| guard);
        scene.undercoat = scene.undercoat.filter(|_| undercoat);
        hold(&scene, &scenes::studio(), &scenes::camera(0.3), &small());
    }
}

#[test]
fn an_eye_inside_the_coat_sees_the_same_on_both() {
    let grown = scene(40.0, false);
    // Little may be stored, so that the march must ask the noise.
    let resolution = Resolution { most_subdivisions: 4, ..Resolution::default() };
    let settings = Settings { resolution, band_bytes: 4 << 20, ..small() };
    let camera = Camera { eye: [0.0, 0.043, 0.0], target: [0.3, 0.041, 0.01], up: [0.0, 1.0, 0.0], vfov_deg: 57.0 };
    hold(&grown.scene(), &scenes::studio(), &camera, &settings);
}

fn hold_asset(input: &str, pose: Option<(String, f64)>) {
    let preset = Preset::load("mink").unwrap().with_settings(&["guard.density_per_cm2=60".to_owned()]).unwrap();
    let request = PictureRequest {
        input: input.to_owned(),
        reading: Default::default(),
        preset,
        materials: Vec::new(),
        units: furrier::bake::units::Units::Auto,
        seed: 0,
        only: Only::Hybrid,
        pose,
    };
    let grown = depicted::Grown::new(&request).unwrap();
    let settings = Settings { size: [64, 64], ..Settings::default() };
    let camera = framing(&grown, 35.0, 20.0, 1.0, settings.size);
    let lighting = studio(&camera);
    hold(&grown.scene(), &lighting, &camera, &settings);
}

#[test]
fn the_samples_look_the_same_on_both() {
    hold_asset("sample:cylinder", None);
    hold_asset("sample:hat", None);
}

#[test]
fn a_walking_creature_looks_the_same_on_both() {
    hold_asset("sample:creature", Some(("0".to_owned(), 0.4)));
}

#[test]
fn a_device_that_fails_hands_over_and_says_so() {
    let grown = scene(40.0, false);
    let settings = Settings { size: [48, 32], ..Settings::default() };
    let (lighting, camera) = (scenes::studio(), scenes::camera(0.35));
    let cpu = draw(&grown.scene(), &lighting, &camera, &settings).unwrap().film;
    // Devices that are lost: so many, then sound ones.
    let draw_after = |lost: u32| -> Drawn {
        let opened = Cell::new(0);
        let open = || {
            let gpu = Gpu::open(&Choice::Auto)?;
            opened.set(opened.get() + 1);
            if opened.get() <= lost {
                gpu.device.destroy();
            }
            Ok(gpu)
        };
        with_fallback(open, &prepare(&grown.scene(), &lighting, &settings).unwrap(), &camera).unwrap()
    };
    let drawn = draw_after(u32::MAX);
    assert_eq!(drawn.device, "cpu");
    assert!(drawn.notes.last().unwrap().contains("the CPU did"), "{:?}", drawn.notes);
    assert_eq!(drawn.picture.film, cpu);
    let drawn = draw_after(1);
    assert_ne!(drawn.device, "cpu");
    assert_eq!(drawn.notes.len(), 1, "{:?}", drawn.notes);
    assert!(share_alike(&developed(&drawn.picture.film), &developed(&cpu)) >= 0.999);
}

#[test]
fn devices_are_read_from_their_names() {
    assert_eq!("auto".parse::<Device>().unwrap(), Device::Auto);
    assert_eq!("cpu".parse::<Device>().unwrap(), Device::Cpu);
    assert_eq!("gpu".parse::<Device>().unwrap(), Device::Gpu(Choice::Auto));
    assert_eq!("gpu:llvm".parse::<Device>().unwrap(), Device::Gpu(Choice::Named("llvm".into())));
    assert!("gpu:".parse::<Device>().is_err());
    assert!("tpu".parse::<Device>().unwrap_err().expected.unwrap().contains("cpu"));
}
