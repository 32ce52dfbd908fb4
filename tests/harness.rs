//! Tests of the tests: every comparison must catch a planted fault.

use crate::architecture::breaches;
use crate::docs::first_difference;

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
