//! Broken and odd inputs end with a message or a sound result, never with a panic.

use crate::common::shared;
use furrier::asset::{self, Asset};
use furrier::error::{Error, Kind};
use std::path::Path;

/// How the table in `hard/README.md` says a file must end.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Expected {
    Bake,
    BakeAndWarn,
    Reject,
    Either,
}

/// File names and expectations, read from the table of the folder's README.
fn expectations(folder: &Path) -> Vec<(String, Expected)> {
    let text = std::fs::read_to_string(folder.join("README.md")).expect("the README is there");
    let rows = text.lines().filter_map(|line| {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let expected = match *cells.get(3)? {
            "bake" => Expected::Bake,
            "bake + warn" => Expected::BakeAndWarn,
            "reject" => Expected::Reject,
            "reject or bake" | "reject or repair" => Expected::Either,
            _ => return None,
        };
        Some((cells[1].to_owned(), expected))
    });
    rows.collect()
}

/// What is wrong with how a file ended, if anything.
fn fault(expected: Expected, result: &Result<Asset, Error>) -> Option<String> {
    match (expected, result) {
        (Expected::Reject, Ok(_)) => Some("was accepted".into()),
        (Expected::Bake | Expected::BakeAndWarn, Err(error)) => Some(format!("was rejected: {error}")),
        (Expected::BakeAndWarn, Ok(asset)) if asset.warnings.is_empty() => Some("gave no warning".into()),
        (_, Ok(asset)) => unsound(asset),
        (_, Err(error)) => {
            let told =
                error.file.is_some() && error.field.is_some() && error.found.is_some() && error.expected.is_some();
            (!told || error.kind != Kind::Input)
                .then(|| format!("was rejected without saying all there is to say: {error}"))
        }
    }
}

/// What a later step could not live with.
fn unsound(asset: &Asset) -> Option<String> {
    asset.parts.iter().find_map(|part| {
        let mesh = match part.mesh(1.0) {
            Ok(mesh) => mesh,
            Err(error) => return Some(error.to_string()),
        };
        let finite = mesh.uv_sets.iter().flatten().all(|uv| uv.is_finite())
            && (0..mesh.positions_m.len()).all(|v| part.local_offset(v, mesh.normals[v], 1.0).is_finite());
        (!finite || mesh.triangles.is_empty()).then(|| "holds numbers that are not finite, or no triangle".to_owned())
    })
}

#[test]
fn every_hard_file_ends_as_its_readme_says() {
    let Some(folder) = shared().map(|shared| shared.join("hard")) else { return };
    let mut faults = Vec::new();
    let table = expectations(&folder);
    assert!(table.len() > 60, "the table has only {} rows", table.len());
    for (name, expected) in table {
        let result = asset::load(&folder.join(&name).to_string_lossy());
        faults.extend(fault(expected, &result).map(|fault| format!("{name} {fault}")));
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn samples_are_sound_and_of_the_stated_size() {
    for (name, triangles, area_cm2) in [("cylinder", 3584, 190.0), ("hat", 5632, 1500.0), ("plane", 512, 400.0)] {
        let asset = asset::load(&format!("sample:{name}")).expect("a sample loads");
        let mesh = asset.parts[0].mesh(1.0).expect("a sample is sound");
        let area: f32 = (0..mesh.triangles.len()).map(|t| mesh.area_m2(t)).sum();
        assert_eq!(mesh.triangles.len(), triangles, "{name}");
        assert!((area * 1e4 / area_cm2 - 1.0).abs() < 0.01, "{name} has {} cm²", area * 1e4);
    }
    for name in asset::sample::NAMES {
        let asset = asset::load(&format!("sample:{name}")).expect("a sample loads");
        assert_eq!(asset.warnings, Vec::<String>::new(), "{name}");
        assert_eq!(unsound(&asset), None, "{name}");
    }
}

#[test]
fn the_judge_of_hard_files_sees_faults() {
    let good = asset::load("sample:sphere");
    let bad = Err(Error::input("no field"));
    assert!(fault(Expected::Bake, &good).is_none());
    assert!(fault(Expected::Reject, &good).is_some());
    assert!(fault(Expected::BakeAndWarn, &good).is_some());
    assert!(fault(Expected::Bake, &bad).is_some());
    assert!(fault(Expected::Reject, &bad).is_some());
}

#[test]
fn every_real_file_loads() {
    let Some(folder) = shared().map(|shared| shared.join("real")) else { return };
    for entry in std::fs::read_dir(folder).expect("the folder can be read") {
        let path = entry.expect("an entry").path();
        if path.extension().is_some_and(|e| e == "glb" || e == "obj") {
            let asset = asset::load(&path.to_string_lossy()).unwrap_or_else(|e| panic!("{e}"));
            assert_eq!(unsound(&asset), None, "{}", path.display());
        }
    }
}
