//! Tests of the tests: every comparison must catch a planted fault.

use crate::architecture::breaches;
use crate::docs::first_difference;
use crate::laws::shading::furnace;
use furrier::shade::kajiya_kay::KajiyaKay;

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
        ("coat/shells/mod.rs", "use super::fins;\nuse crate::{data::coat::Coat, render};"),
    ] {
        assert_eq!(breaches_of(path, text), Vec::<String>::new());
    }
}

#[test]
fn a_page_that_differs_by_a_letter_or_a_line_is_not_current() {
    assert_eq!(first_difference("a\nb\n", "a\nb\n"), None);
    for kept in ["", "a\nc\n", "a\n", "a\nb\nc\n", "a\nb"] {
        assert!(first_difference(kept, "a\nb\n").is_some(), "{kept:?}");
    }
}

#[test]
fn the_furnace_sees_a_highlight_without_its_normalisation() {
    let hair = KajiyaKay::<f64>::new(0.0, 0.5, 20.0);
    let sent = furnace(0.0, |angles| hair.scatter(angles).1 * 2.0 * std::f64::consts::PI);
    assert!((sent - 0.5).abs() > 0.1, "{sent}");
}

#[test]
fn areas_tell_a_ribbon_from_one_a_tenth_wider() {
    use furrier::render::strands::Knot;
    let knot = |x: f32, half_px: f32| Knot { x, y: 3.0 * x, z_m: 1.0, half_px };
    let wider = crate::ribbons::covered(&knot(0.2, 0.055), &knot(6.2, 0.055));
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
        let (a, b) = (
            crate::undercoat::depth_of_volume(&hairs, direction),
            crate::undercoat::depth_of_volume(&thicker, direction),
        );
        assert!((b - a).abs() > 0.01 * a, "{a} and {b} along {direction}");
    }
}
