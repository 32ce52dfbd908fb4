//! The coat against its hair at the window: the error map is that of `compare`, and the final picture is reached and said.

use super::contents::{Contents, ball, begin};
use crate::common::furrier_path;
use egui_kittest::kittest::Queryable;
use furrier::stage::exr;
use furrier::window::comparison::Mode;
use std::process::Command;

#[test]
fn the_error_map_is_that_of_compare_and_the_final_hair_is_said() {
    let mut contents = Contents::new(begin(ball()));
    contents.harness.set_size([420.0, 320.0].into());
    contents.app().state.open.panel = false;
    contents.app().state.comparison.mode = Mode::Error;
    contents.settle();
    contents.harness.get_by_label("final");
    let judged = contents.app().comparison().unwrap();
    let folder = tempfile::tempdir().unwrap();
    for (name, film) in [("hair.exr", &*judged.film), ("coat.exr", &judged.coat)] {
        std::fs::write(folder.path().join(name), exr::encode(film).unwrap()).unwrap();
    }
    let mut command = Command::new(furrier_path());
    let said = command.current_dir(folder.path()).args(["--json", "compare", "hair.exr", "coat.exr"]).output().unwrap();
    let said: serde_json::Value = serde_json::from_slice(&said.stdout).unwrap();
    let flip = said["flip"].as_f64().unwrap();
    println!("FLIP at the window {}, by compare {flip}", judged.difference.flip);
    assert!((flip - judged.difference.flip).abs() < 1e-4);
    // The map's own mean over what is covered is that number.
    let covered = judged.film.alpha.iter().zip(&judged.coat.alpha).map(|(a, b)| *a > 0.0 || *b > 0.0);
    let errors: Vec<f64> =
        judged.flip.iter().zip(covered).filter(|(_, in_it)| *in_it).map(|(e, _)| f64::from(*e)).collect();
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    assert!((mean - flip).abs() < 1e-4, "{mean} {flip}");
    assert!(flip > 0.001 && flip < 0.5, "{flip}");
}
