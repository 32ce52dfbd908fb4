//! The page of a library, errors, and what they are compared with.

use super::{batch, json, said, triangles};
use crate::common::skipped;
use furrier::batch::results::{Results, SAME_FLIP};
use serde_json::json;

#[test]
fn a_page_shows_each_asset_and_what_was_before() {
    if furrier::gpu::adapters().is_empty() {
        return skipped("no graphics adapter");
    }
    let folder = triangles(2);
    let report = folder.path().join("report");
    let run = |more: &[&str]| {
        let (code, value) = json(batch(folder.path(), more).arg("--report").arg(&report));
        assert_eq!(code, 0, "{value}");
        let page = std::fs::read_to_string(report.join("index.html")).unwrap();
        let pictures = std::fs::read_dir(report.join("pictures")).unwrap().count();
        (page, pictures)
    };
    let (page, pictures) = run(&[]);
    assert_eq!((page.matches("<img ").count(), pictures), (2, 2), "{page}");
    let results = Results::read(&report.join("results.json")).unwrap();
    let first = report.join(results.rows[0].picture.as_deref().unwrap());
    let drawn = image::open(&first).unwrap().to_rgba8();
    assert_eq!(drawn.dimensions(), (256, 256));
    let colours: std::collections::BTreeSet<[u8; 4]> = drawn.pixels().map(|p| p.0).collect();
    assert!(colours.len() > 50, "hardly anything was drawn");
    // Other coats: both pictures of each, side by side.
    let (page, pictures) = run(&["--set", "colour.tint=[0.1,0.5,0.1]"]);
    assert_eq!((page.matches("<img ").count(), pictures), (4, 4), "{page}");
    assert!(page.contains("class=old"), "{page}");
    // Again: nothing changed since, so there is nothing to compare with.
    let (page, pictures) = run(&["--set", "colour.tint=[0.1,0.5,0.1]"]);
    assert_eq!((page.matches("<img ").count(), pictures), (2, 2), "{page}");
}

/// Few hairs and no undercoat: drawn hair by hair in no time.
const FEW: [&str; 4] = ["--set", "guard.density_per_cm2=1", "--set", "undercoat.density_per_cm2=0"];

#[test]
fn an_error_over_the_limit_or_that_grew_fails_the_run() {
    if furrier::gpu::adapters().is_empty() {
        return skipped("no graphics adapter");
    }
    let folder = triangles(1);
    let report = folder.path().join("report");
    let ended = batch(folder.path(), &FEW).args(["--measure", "--report"]).arg(&report).output().unwrap();
    assert!(ended.status.success(), "{}", said(&ended));
    let path = report.join("results.json");
    let mut results = Results::read(&path).unwrap();
    let flip = results.rows[0].flip.expect("measured");
    assert!((-0.1..1.0).contains(&flip), "{flip}");
    let run = |more: &[&str]| batch(folder.path(), &FEW).args(more).output().unwrap();
    let path = path.to_string_lossy().into_owned();
    assert_eq!(run(&["--regress", &path, "--max-flip", "1"]).status.code(), Some(0));
    // What is compared with was better by more than what is the same.
    results.rows[0].flip = Some(flip - 2.0 * SAME_FLIP);
    results.write(path.as_ref()).unwrap();
    let ended = run(&["--regress", &path]);
    assert_eq!(ended.status.code(), Some(1), "{}", said(&ended));
    assert!(said(&ended).contains("t0.obj") && said(&ended).contains("before"), "{}", said(&ended));
    let worse = results.worse(Some(0.0), None).len();
    assert_eq!(worse, usize::from(flip - 2.0 * SAME_FLIP > 0.0));
    std::fs::write(&path, json!({"rows": []}).to_string()).unwrap();
    assert_eq!(run(&["--regress", &path]).status.code(), Some(3));
    assert_eq!(run(&["--max-flip", "2"]).status.code(), Some(2));
}
