//! Tests of the tests: every comparison must catch a planted fault.

mod formulas;
mod likeness;
mod product;

use crate::architecture::{breaches, median_lines, too_long};
use crate::circles::circles;
use crate::docs::first_difference;
use crate::hybrid_twins::share_alike;
use crate::laws::fibre::{departure, sent};
use crate::metrics::{changed, picture};
use furrier::data::image::Image8;
use furrier::data::light::Light;
use furrier::data::ray::DepthRange;
use furrier::math::Vec3;
use furrier::metrics::compare::compare;

fn breaches_of(path: &str, text: &str) -> Vec<String> {
    breaches(&[(path.to_owned(), text.to_owned())])
}

#[test]
fn the_floors_catch_planted_imports() {
    for (path, text) in [
        ("data/mesh.rs", "use crate::asset::load;"),
        ("asset/mod.rs", "fn f() { crate::viewer::draw(); }"),
        ("gpu/device.rs", "use crate::{\n    error::Error,\n    asset::{load, write},\n};"),
        ("viewer/mod.rs", "use super::report::plot;"),
        ("coat/shells/mod.rs", "use super::super::bake;"),
        ("novelty/mod.rs", "use crate::math::Vec3;"),
    ] {
        assert_eq!(breaches_of(path, text).len(), 1, "{path}: {text}");
    }
}

#[test]
fn the_floors_allow_what_they_should() {
    for (path, text) in [
        ("asset/mod.rs", "use crate::data::mesh::Mesh;\nuse crate::asset::gltf;\nuse super::asset::obj;"),
        ("math/mod.rs", "use crate::error::Error;\nuse crate::Result;"),
        ("main.rs", "fn main() { furrier::cli::run(); }"),
        ("coat/shells/mod.rs", "use super::fins;\nuse crate::{data::coat::Coat, cast};"),
    ] {
        assert_eq!(breaches_of(path, text), Vec::<String>::new());
    }
}

#[test]
fn circles_inside_folders_are_seen() {
    let files = |texts: [(&str, &str); 4]| circles(&texts.map(|(path, text)| (path.to_owned(), text.to_owned())));
    let door = ("fur/mod.rs", "mod a;\nmod b;\nuse a::f;\npub struct Hair;");
    let open = [
        door,
        ("fur/a.rs", "use super::Hair;"),
        ("fur/b.rs", "use super::{Hair, a::f};"),
        ("fur/c/mod.rs", "use crate::fur::b::g;"),
    ];
    assert_eq!(files(open), Vec::<String>::new());
    let [door, _, b, c] = open;
    assert_eq!(files([door, ("fur/a.rs", "use super::b;"), b, c]), ["fur/: a -> b -> a"]);
    assert_eq!(files([door, ("fur/a.rs", "use super::c::{d, e};"), b, c]), ["fur/: a -> c -> b -> a"]);
}

#[test]
fn a_long_file_and_a_long_median_are_seen() {
    let files = [401, 7, 400, 12].map(|lines| (format!("src/{lines}.rs"), "x\n".repeat(lines)));
    assert_eq!(too_long(&files), ["src/401.rs: 401 lines, 400 at most"]);
    assert_eq!(median_lines(&files), 400);
    assert_eq!(median_lines(&files[1..]), 12);
}

#[test]
fn a_page_that_differs_by_a_letter_or_a_line_is_not_current() {
    assert_eq!(first_difference("a\nb\n", "a\nb\n"), None);
    for kept in ["", "a\nc\n", "a\n", "a\nb\nc\n", "a\nb"] {
        assert!(first_difference(kept, "a\nb\n").is_some(), "{kept:?}");
    }
}

#[test]
fn the_furnace_sees_a_lobe_that_is_a_fiftieth_too_strong() {
    let mut fibre = crate::scenes::scattering().guard.fibre;
    assert!(departure(&fibre, 1.0) < 5e-3);
    fibre.lobes[3].scale.iter_mut().for_each(|x| *x *= 1.01);
    assert!(departure(&fibre, 1.0) > 5e-3, "{}", sent(&fibre, 0.0));
}

#[test]
fn double_precision_tells_a_hundredth_of_colour() {
    let own = crate::scenes::scattering().guard;
    let mut other = own;
    other.colouring.factors[0] += 0.02;
    assert!(crate::laws::fibre::off(&own, &other)[0] > 5e-3);
}

#[test]
fn coverage_tells_hairs_that_are_a_tenth_too_wide() {
    let (whole, thinned) = crate::thinned::whole_and_thinned(1.1);
    let more = crate::thinned::more_guard(&whole, &thinned);
    assert!(more > 0.02, "{more}");
}

#[test]
fn areas_tell_a_ribbon_from_one_a_tenth_wider() {
    use furrier::hybrid::strands::RibbonPoint;
    let ribbon_point = |x: f32, half_px: f32| RibbonPoint { x, y: 3.0 * x, z_m: 1.0, half_px };
    let wider = crate::ribbons::covered(&ribbon_point(0.2, 0.055), &ribbon_point(6.2, 0.055));
    let area = 2.0 * 0.05 * 6.0_f64.hypot(18.0);
    assert!((wider - area).abs() > 2e-3 * area + 1e-5);
}

#[test]
fn blocks_tell_hair_moved_by_a_pixel() {
    let (mut ribbons, rays) = crate::ribbons::ribbons_and_rays();
    ribbons.guard.rotate_right(2);
    assert!(crate::ribbons::worst_block(&ribbons, &rays) > 0.03);
}

#[test]
fn one_percent_of_depth_tells_hair_a_fortieth_thicker() {
    use furrier::math::DVec3;
    for direction in crate::undercoat::directions() {
        let hairs = crate::undercoat::scaled(DVec3::Z, direction);
        let thicker = crate::undercoat::Cylinders { diameter_m: 1.025 * hairs.diameter_m, ..hairs };
        for depth in [crate::undercoat::depth_of_volume, crate::undercoat::depth_of_square] {
            let (a, b) = (depth(&hairs, direction), depth(&thicker, direction));
            assert!((b - a).abs() > 0.01 * a, "{a} and {b} along {direction}");
        }
    }
}

#[test]
fn every_measure_sees_its_fault() {
    let of = |other| compare(&picture(), &other).unwrap();
    let darker = of(changed(|c| c * 0.95));
    assert!(darker.bias < -0.04 && darker.rel_mse > 1e-3 && darker.psnr_db.unwrap() < 45.0 && darker.flip > 0.01);
    let redder = of(changed(|c| c * Vec3::new(1.2, 1.0, 0.8)));
    assert!(redder.flip > 0.02 && redder.flip_p95 > redder.flip);
    // The same pixels in another order: means agree, structure does not.
    let mut mirrored = picture();
    mirrored.colour.reverse();
    mirrored.alpha.reverse();
    let mirrored = of(mirrored);
    assert!(mirrored.bias.abs() < 1e-6 && mirrored.ssim < 0.9 && mirrored.flip > 0.05);
    let mut thinner = picture();
    thinner.alpha.iter_mut().for_each(|a| *a *= 0.9);
    let thinner = of(thinner);
    assert!((thinner.coverage[1] / thinner.coverage[0] - 0.9).abs() < 1e-6);
}

#[test]
fn a_struct_out_of_step_with_its_shader_shows() {
    use crate::shaders::{Layout, in_shader};
    let parse = |text: &str| naga::front::wgsl::parse_str(text).unwrap();
    let uses = "@group(0) @binding(0) var<uniform> s: S; @compute @workgroup_size(1) fn main() { _ = s.b; }";
    let rust = Layout { fields: vec![("a".into(), 0), ("b".into(), 12)], size: 16 };
    assert_eq!(in_shader(&parse(&format!("struct S {{ a: vec3<f32>, b: f32 }} {uses}")), "S"), Some(rust));
    let rust = Layout { fields: vec![("a".into(), 0), ("b".into(), 12)], size: 16 };
    for fault in ["a: vec3<f32>, b: vec2<f32>", "b: f32, a: vec3<f32>", "a: vec3<f32>, c: f32, b: f32"] {
        assert_ne!(in_shader(&parse(&format!("struct S {{ {fault} }} {uses}")), "S").as_ref(), Some(&rust), "{fault}");
    }
}

#[test]
fn twins_tell_a_law_that_is_off_by_a_tenth() {
    use crate::twins::{alike, difference};
    let cpu: Vec<f32> = (0..100).map(|i| 0.2 + 0.006 * i as f32).collect();
    let picture = |change: &dyn Fn(f32) -> f32| {
        let pixels = cpu.iter().map(|&a| [0.0, 0.0, 0.0, change(a)]).collect();
        furrier::runtime::Picture { size: [10, 10], pixels, depth_m: vec![0.0; 100] }
    };
    assert!(alike(difference(&cpu, &picture(&|a| a))));
    // A tenth more optical depth, a constant opacity with the right mean, nothing drawn, a pixel never written.
    assert!(!alike(difference(&cpu, &picture(&|a| 1.0 - (1.0 - a).powf(1.1)))));
    assert!(!alike(difference(&cpu, &picture(&|_| 0.497))));
    assert!(!alike(difference(&cpu, &picture(&|_| 0.0))));
    assert!(!alike(difference(&cpu, &picture(&|a| if a == cpu[50] { f32::NAN } else { a }))));
}

#[test]
fn the_golden_ball_tells_small_changes() {
    use crate::runtime::like_golden;
    let of = |other| compare(&picture(), &other).unwrap();
    assert!(like_golden(&of(picture())));
    assert!(!like_golden(&of(changed(|c| c * 1.04))));
    assert!(!like_golden(&of(changed(|c| c * Vec3::new(1.15, 1.0, 0.85)))));
    let mut thinner = picture();
    thinner.alpha.iter_mut().for_each(|a| *a *= 0.98);
    assert!(!like_golden(&of(thinner)));
    let mut shifted = picture();
    shifted.colour.rotate_right(1);
    shifted.alpha.rotate_right(1);
    assert!(!like_golden(&of(shifted)));
}

#[test]
fn a_pattern_that_does_not_wrap_and_a_slab_left_out_show() {
    let hair = crate::squares::hair();
    let open = furrier::fur::undercoat::Undercoat::new(&hair, Some(Default::default()));
    assert!(crate::squares::torn(&open) > 0.5);
    let film = crate::squares::film(DepthRange::ALL);
    let half = crate::squares::film(DepthRange { far_m: crate::squares::MIDDLE_M, ..DepthRange::ALL });
    assert_eq!(crate::squares::farthest(&film, &film), 0.0);
    assert!(crate::squares::farthest(&film, &half) > 0.02);
}

#[test]
fn coverage_and_structure_tell_a_stack_that_is_off() {
    use furrier::coat::judge::CoverageRow;
    let good =
        CoverageRow { theta_deg: 40.0, strands: 0.8, stack: 0.81, constant: 0.3, rmse: 0.07, rmse_constant: 0.6 };
    assert_eq!(crate::accuracy::fault(&[good]), None);
    for faulty in [
        CoverageRow { stack: good.constant, ..good },
        CoverageRow { stack: 0.775, ..good },
        CoverageRow { rmse: 0.35, ..good },
        CoverageRow { theta_deg: 85.0, stack: 0.74, ..good },
    ] {
        assert_eq!(crate::accuracy::fault(&[good, faulty]), Some(faulty));
    }
}

#[test]
fn films_that_no_renderer_may_give_are_named() {
    use crate::hard_renders::fault;
    let plain = || crate::defocus::film(|_, _| Some((Vec3::splat(0.5), 1.0)));
    assert_eq!(fault(&plain()), None);
    let faults: [fn(&mut furrier::data::film::Film); 5] = [
        |film| film.radiance[7].y = f32::NAN,
        |film| film.radiance[7].x = -1e-3,
        |film| film.alpha[7] = 1.1,
        |film| film.depth_m[7] = f32::INFINITY,
        |film| (film.guard[7], film.undercoat[7]) = (0.6, 0.6),
    ];
    for plant in faults {
        let mut film = plain();
        plant(&mut film);
        assert!(fault(&film).is_some_and(|fault| fault.starts_with("pixel 7:")));
    }
}

#[test]
fn a_leak_of_a_hundredth_and_a_twinkle_of_a_tenth_show() {
    let mut film = crate::defocus::film(|_, _| Some((Vec3::splat(0.5), 1.0)));
    assert_eq!(crate::defocus::departure(&film, Vec3::splat(0.5), |_, _| true), 0.0);
    film.alpha[30 * crate::defocus::SIZE[0] + 30] = 0.99;
    assert!(crate::defocus::departure(&film, Vec3::splat(0.5), |_, _| true) > 5e-3);
    let mut twinkling = vec![film.clone(), film];
    assert!(crate::posed::change(&twinkling) < 1e-6);
    twinkling[1].radiance.iter_mut().step_by(5).for_each(|c| *c *= 1.1);
    assert!(crate::posed::change(&twinkling) > crate::posed::NOISE);
}

#[test]
fn twins_tell_two_pixels_in_a_thousand() {
    let mut a = Image8::new(40, 50, 4);
    a.pixels.fill(100);
    let mut b = a.clone();
    b.pixels[0] += 1;
    assert_eq!(share_alike(&a, &b), 1.0);
    for pixel in [7, 900, 1999] {
        b.pixels[4 * pixel + 2] += 2;
    }
    assert!(share_alike(&a, &b) < 0.999);
}

#[test]
fn the_reference_sees_a_light_three_hundredths_too_weak() {
    let mut lighting = crate::scenes::studio();
    let Light::Directional(key) = &mut lighting.key else { unreachable!("the studio's key is far away") };
    key.irradiance *= 0.97;
    lighting.ambient *= 0.97;
    let difference = crate::oracle::against_reference(&lighting);
    assert_eq!(crate::oracle::fault(&difference), Some("bias"));
}

#[test]
fn the_reference_sees_places_a_thousandth_of_the_hair_beside_a_ray() {
    assert!(crate::oracle::places_missed(1e-3) > 900);
}

#[test]
fn the_reference_sees_folds_a_fiftieth_beside_a_ray() {
    assert!(crate::oracle::intervals_missed(0.02) > 0.02);
}

#[test]
fn the_reference_sees_hair_a_thousandth_too_wide() {
    assert!(crate::oracle::largest_gap(1.001) > 1e-4);
}
