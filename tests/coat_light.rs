//! A coat in light beside the fur that it stands for, as `report coat` measures it.

use crate::common::{furrier_path, skipped};
use serde_json::Value;
use std::process::Command;

/// How far a coat's light may be off in the mean.
const BIAS: f64 = 0.07;
/// How far its coverage may be off, points.
const COVERAGE: f64 = 2.0;

/// What is wrong with the pictures of a coat: each in the light it is named by.
fn faults(preset: &str, more: &[&str]) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out.json");
    let mut command = Command::new(furrier_path());
    command.args(["-q", "report", "coat", "sample:creature", "--preset", preset, "--size", "128x128"]);
    command.args(["--distances", "1:2", "--lights", "studio,front,sky"]).args(more).arg("-o").arg(&out);
    assert!(command.status().unwrap().success());
    let report: Value = serde_json::from_slice(&std::fs::read(&out).unwrap()).unwrap();
    let mut found = Vec::new();
    for picture in report["pictures"].as_array().unwrap() {
        let number = |name: &str| picture[name].as_f64().unwrap();
        let light = picture["light"].as_str().unwrap();
        let (bias, coverage) = (number("bias"), number("coverage"));
        println!("{preset}, {light}: bias {bias:.3}, coverage {coverage:.2}, FLIP {:.3}", number("flip"));
        if bias.abs() > BIAS {
            found.push(format!("{light}: {bias:.3} of the light"));
        }
        if coverage.abs() > COVERAGE {
            found.push(format!("{light}: {coverage:.2} points of coverage"));
        }
    }
    found
}

#[test]
fn a_coat_is_as_bright_as_its_fur() {
    if furrier::gpu::adapters().is_empty() {
        return skipped("no graphics adapter");
    }
    assert_eq!(faults("fox", &[]), Vec::<String>::new());
    // Two slabs alone cannot tell hair that is in the light from hair that is not.
    assert!(!faults("fox", &["--layers", "3"]).is_empty());
}
