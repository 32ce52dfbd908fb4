//! Picture differences on pictures whose difference is known, and the rows of time and memory.

use furrier::math::Vec3;
use furrier::math::hash::Stream;
use furrier::metrics::compare::{LinearImage, compare, load};
use furrier::metrics::timing::{Recorder, SCHEMA_VERSION};

/// A smooth picture with structure: covered within a disc.
pub fn picture() -> LinearImage {
    let (width, height) = (48, 40);
    let mut light = LinearImage { width, height, colour: vec![], alpha: vec![] };
    let mut stream = Stream::new(5);
    for i in 0..width * height {
        let (x, y) = ((i % width) as f32 / width as f32 - 0.5, (i / width) as f32 / height as f32 - 0.5);
        let alpha = if x * x + y * y < 0.2 { 1.0 } else { 0.0 };
        let stripes = 0.4 + 0.2 * (40.0 * x).sin() + 0.1 * (2.0 * stream.unit() - 1.0);
        light.alpha.push(alpha);
        light.colour.push(Vec3::new(stripes, 0.7 * stripes, 0.4 + y * 0.3) * alpha);
    }
    light
}

/// `picture` with each pixel passed through `change`.
pub fn changed(change: impl Fn(Vec3) -> Vec3) -> LinearImage {
    let mut light = picture();
    light.colour.iter_mut().for_each(|c| *c = change(*c));
    light
}

#[test]
fn equal_pictures_do_not_differ() {
    let same = compare(&picture(), &picture()).unwrap();
    assert_eq!((same.flip, same.flip_p95, same.rel_mse, same.psnr_db, same.bias), (0.0, 0.0, 0.0, None, 0.0));
    assert!((same.ssim - 1.0).abs() < 1e-6);
    let covered = picture().alpha.iter().sum::<f32>() / (48.0 * 40.0);
    assert!((same.coverage[0] - f64::from(covered)).abs() < 1e-6 && same.coverage[0] == same.coverage[1]);
}

#[test]
fn known_differences_have_their_values() {
    let brighter = compare(&picture(), &changed(|c| c * 1.1)).unwrap();
    assert!((brighter.bias - 0.1).abs() < 1e-5, "{}", brighter.bias);
    // Constant pictures: (a − b)²/(b² + 0.01) and 20 log10 of the coded difference follow by hand.
    let flat = |value: f32| LinearImage {
        width: 16,
        height: 16,
        colour: vec![Vec3::splat(value); 256],
        alpha: vec![1.0; 256],
    };
    let difference = compare(&flat(0.5), &flat(0.6)).unwrap();
    assert!((difference.rel_mse - 0.01 / 0.26).abs() < 1e-6, "{}", difference.rel_mse);
    let coded = |v: f64| 1.055 * v.powf(1.0 / 2.4) - 0.055;
    let expected = -20.0 * (coded(0.6) - coded(0.5)).log10();
    assert!((difference.psnr_db.unwrap() - expected).abs() < 1e-3, "{difference:?} against {expected}");
}

#[test]
fn only_what_is_covered_counts() {
    let mut padded = (picture(), changed(|c| c * 1.2));
    let small = compare(&padded.0, &padded.1).unwrap();
    for light in [&mut padded.0, &mut padded.1] {
        light.height *= 2;
        light.colour.resize(light.width * light.height, Vec3::ZERO);
        light.alpha.resize(light.width * light.height, 0.0);
    }
    let large = compare(&padded.0, &padded.1).unwrap();
    assert_eq!(small.rel_mse, large.rel_mse);
    assert!((small.flip - large.flip).abs() < 2e-3, "{} {}", small.flip, large.flip);
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let mut nan = picture();
    nan.colour[7].y = f32::NAN;
    let error = compare(&picture(), &nan).unwrap_err();
    assert_eq!(error.field.as_deref(), Some("pixel (7, 0)"));
    let mut short = picture();
    short.height -= 1;
    short.colour.truncate(short.width * short.height);
    short.alpha.truncate(short.width * short.height);
    assert!(compare(&picture(), &short).is_err());
    assert!(load(std::path::Path::new("missing.png")).unwrap_err().file.is_some());
    assert!(load(std::path::Path::new("picture.bmp")).unwrap_err().expected.is_some());
}

#[test]
fn files_read_as_they_were_written() {
    let folder = tempfile::tempdir().unwrap();
    let light = picture();
    let png = folder.path().join("a.png");
    let straight = |i: usize| if light.alpha[i] > 0.0 { light.colour[i] / light.alpha[i] } else { Vec3::ZERO };
    let bytes: Vec<u8> = (0..light.colour.len())
        .flat_map(|i| {
            let c = straight(i).map(furrier::data::image::srgb_from_linear).to_array();
            [c[0], c[1], c[2], light.alpha[i]].map(furrier::data::image::unorm8)
        })
        .collect();
    image::save_buffer(&png, &bytes, 48, 40, image::ColorType::Rgba8).unwrap();
    let read = load(&png).unwrap();
    assert!(compare(&light, &read).unwrap().psnr_db.unwrap() > 50.0);

    let exr = folder.path().join("a.exr");
    let pixel = |x: usize, y: usize| {
        let i = y * light.width + x;
        (light.colour[i].x, light.colour[i].y, light.colour[i].z, light.alpha[i])
    };
    exr::prelude::write_rgba_file(&exr, light.width, light.height, pixel).unwrap();
    assert_eq!(load(&exr).unwrap(), light);
}

#[test]
fn a_report_holds_its_steps() {
    let mut recorder = Recorder::new("test");
    let made = recorder.step("make", || vec![0_u8; 1000], |made| made.len() as u64);
    recorder.row("make", 2.0, 10);
    recorder.count("things", 2);
    recorder.count("things", 3);
    recorder.error("flip", 0.25);
    let report = recorder.finish();
    assert_eq!((made.len(), report.steps.0.len(), report.steps.0[0].bytes), (1000, 1, 1000));
    assert!(report.steps.0[0].ms >= 2.0 && report.counts["things"].whole() == 5);
    let json = serde_json::to_value(&report).unwrap();
    for key in ["schema_version", "steps", "total_ms", "peak_bytes", "device", "counts", "error"] {
        assert!(!json[key].is_null(), "{key} is missing");
    }
    assert_eq!(json["schema_version"], SCHEMA_VERSION);
}
