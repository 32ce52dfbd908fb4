//! Levels of detail: what they hold, how one passes into the next, and the report on them.

use crate::accuracy::{hair, recipe};
use crate::common::furrier_path;
use crate::{coats, runtime};
use furrier::coat::tile::bake;
use furrier::data::coat::Tile;
use furrier::data::shell::{Incidence, Slabs, Stack};
use furrier::fur::groom::Shape;
use furrier::gpu::{Choice, Gpu};
use furrier::math::{Mat3, Vec2, Vec3};
use furrier::runtime::gpu::Renderer;
use furrier::runtime::{Detail, Frame, Picture, Show};
use serde_json::Value;
use std::process::Command;

#[test]
fn slabs_rise_from_the_skin() {
    let uneven = Slabs::with_tops(vec![0.0, 0.5, 0.7, 0.9]).unwrap();
    assert_eq!((uneven.count(), uneven.span(1), uneven.tops()), (3, [0.5, 0.7], &[0.0, 0.5, 0.7, 0.9][..]));
    let at = |height| uneven.at(height);
    assert_eq!([-1.0, 0.0, 0.49, 0.5, 0.8, 0.95, 2.0].map(at), [0, 0, 0, 1, 2, 2, 2]);
    assert_eq!(Slabs::even(4), Slabs::with_tops(vec![0.0, 0.25, 0.5, 0.75, 1.0]).unwrap());
    for bad in [vec![], vec![0.0], vec![0.1, 0.5], vec![0.0, 0.5, 0.5], vec![0.0, 1.1], vec![0.0, f32::NAN]] {
        assert!(Slabs::with_tops(bad.clone()).is_none(), "{bad:?}");
    }
}

#[test]
fn a_level_comes_in_as_the_finer_one_goes() {
    let most_px = [24.0, 12.0, 3.0];
    let of = |height_px: f32| Detail::of(height_px, most_px.into_iter());
    let mut last = 0.0;
    for step in 0..400 {
        let detail = of(100.0 * 0.98_f32.powi(step));
        let shares: f32 = detail.levels().map(|(_, share)| share).sum();
        assert!((shares - 1.0).abs() < 1e-6 && detail.levels().all(|(level, _)| level <= 3));
        assert!(detail.level() >= last && detail.level() - last < 0.1, "level {} after {last}", detail.level());
        last = detail.level();
    }
    assert_eq!((of(30.1).level(), of(24.0).level(), of(12.0).level(), of(1.0).level()), (0.0, 1.0, 2.0, 3.0));
    assert!((0.0..1.0).contains(&of(27.0).fins()) && of(27.0).fins() > 0.0 && of(24.0).fins() == 0.0);
    assert_eq!(Detail::of(1.0, std::iter::empty()), Detail::fixed(0));
}

/// Mean coverage of a level at angles to the normal, by pixels half a tile wide.
fn coverages(tile: &Tile, level: usize) -> [f32; 3] {
    let tile = tile.at_level(level);
    let stack = Stack::new(&tile);
    [0.0_f32, 45.0, 70.0].map(|degrees| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let seen = Incidence::new(Vec3::new(sin, 0.0, -cos), Mat3::IDENTITY, 0.5);
        let spot = |i: usize| Vec2::new((i % 8) as f32, (i / 8) as f32) / 8.0;
        (0..64).map(|i| stack.coverage(spot(i), &seen)).sum::<f32>() / 64.0
    })
}

#[test]
fn levels_halve_and_hide_as_much_as_the_finest() {
    let tile = bake(&hair(true, Shape::default()), &recipe(0.0));
    let counts: Vec<usize> = (0..=tile.levels.len()).map(|i| tile.at_level(i).shells.slabs.count()).collect();
    assert_eq!(counts, [12, 6, 3, 1]);
    assert!(tile.levels.windows(2).all(|pair| pair[0].most_px > pair[1].most_px));
    let finest = coverages(&tile, 0);
    let off = |tile: &Tile, level: usize| {
        coverages(tile, level).iter().zip(finest).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
    };
    for level in 1..=tile.levels.len() {
        assert!(off(&tile, level) < 0.02, "level {level}: {:?} for {finest:?}", coverages(&tile, level));
        // A planted fault: slabs a quarter higher than their hair was spread over.
        let mut faulty = tile.clone();
        let tops = faulty.levels[level - 1].shells.slabs.tops().iter().map(|top| top * 0.8).collect();
        faulty.levels[level - 1].shells.slabs = Slabs::with_tops(tops).unwrap();
        assert!(off(&faulty, level) > 0.02, "level {level} hides a fault");
    }
    // All that levels add is less than a third.
    let bytes = |level: usize| {
        let tile = tile.at_level(level);
        tile.shells.albedo.iter().flatten().map(|image| image.pixels.len()).sum::<usize>()
    };
    assert!(3 * (1..=tile.levels.len()).map(bytes).sum::<usize>() < bytes(0));
}

/// A furred ball in a level, or in that which is chosen.
fn ball(tile: &Tile, away_m: f32, level: Option<usize>) -> (Picture, f32) {
    let gpu = Gpu::open(&Choice::Auto).unwrap();
    let tiles = std::slice::from_ref(tile);
    let furred = coats::sphere(0.05, 14, 0.3, tile);
    let renderer = Renderer::new(&gpu, tiles, 1).unwrap();
    let frame = Frame { level, ..runtime::look(Vec3::new(0.1, 0.2, 0.97) * away_m, [64, 64]) };
    let drawn = renderer.prepare(&furred.scene(tiles)).unwrap().draw(&frame, Show::default()).unwrap();
    (drawn.picture, drawn.level)
}

/// Mean alpha, and luminance over it.
fn means(picture: &Picture) -> [f64; 2] {
    let light: f64 = picture.pixels.iter().map(|p| f64::from(0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2])).sum();
    [picture.coverage(), light / (picture.coverage() * picture.pixels.len() as f64)]
}

#[test]
fn no_coverage_and_no_light_pops_from_level_to_level() {
    let tile = bake(&hair(true, Shape::default()), &recipe(17.0));
    let off = |a: [f64; 2], b: [f64; 2]| [(a[0] / b[0] - 1.0).abs(), (a[1] / b[1] - 1.0).abs()];
    // Light: as measured, a single slab being the furthest off (`docs/steps/levels.md`).
    for (level, bound) in (1..=tile.levels.len()).zip([0.07, 0.02, 0.13]) {
        // So far away that the level just suffices: 64 pixels see 2 tan 15° of the distance.
        let pixel_m = tile.height_m / tile.levels[level - 1].most_px;
        let away_m = pixel_m * 64.0 / (2.0 * 15.0_f32.to_radians().tan());
        let [finer, own] = [level - 1, level].map(|level| means(&ball(&tile, away_m, Some(level)).0));
        let [coverage, light] = off(own, finer);
        println!("level {level}: coverage {coverage:.4}, light {light:.4} off");
        assert!(coverage < 0.01 && light < bound, "level {level}: coverage {coverage:.4}, light {light:.4} off");
        let (between, drawn) = ball(&tile, away_m / 1.12, None);
        assert!((drawn - level as f32 + 0.5).abs() < 0.4, "level {drawn} between {} and {level}", level - 1);
        let ends = [level - 1, level].map(|level| means(&ball(&tile, away_m / 1.12, Some(level)).0));
        let between = means(&between);
        for i in 0..2 {
            let [low, high] = [ends[0][i].min(ends[1][i]), ends[0][i].max(ends[1][i])];
            let within = low * 0.995..high * 1.005;
            assert!(within.contains(&between[i]), "level {drawn}: {} not in {within:?}", between[i]);
        }
    }
}

#[test]
fn levels_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("levels.json");
    let mut command = Command::new(furrier_path());
    command.args(["-q", "report", "levels", "sample:sphere", "--size", "40x40", "--distances", "1,3", "--dolly", "3"]);
    command.args(["--texture-size", "64", "--layers", "6", "--device", "cpu", "--preset", "mink"]);
    command.args(crate::sweeps::SPARSE).arg("-o").arg(&out);
    assert!(command.status().unwrap().success());
    let report: Value = serde_json::from_slice(&std::fs::read(&out).unwrap()).unwrap();
    let rows = report["levels"].as_array().unwrap();
    let of = |row: &Value, name: &str| row[name].as_f64().unwrap_or(f64::NAN);
    let found: Vec<(f64, f64, f64)> =
        rows.iter().map(|row| (of(row, "distance"), of(row, "level"), of(row, "layers"))).collect();
    assert_eq!(
        found,
        [(1.0, 0.0, 6.0), (1.0, 1.0, 3.0), (1.0, 2.0, 2.0), (3.0, 0.0, 6.0), (3.0, 1.0, 3.0), (3.0, 2.0, 2.0)]
    );
    for pair in rows.windows(2).filter(|pair| pair[0]["distance"] == pair[1]["distance"]) {
        assert!(of(&pair[1], "reads_per_covered_pixel") < of(&pair[0], "reads_per_covered_pixel"));
        assert!(of(&pair[1], "bytes") < of(&pair[0], "bytes") && of(&pair[1], "flip_to_finer") > 0.0);
    }
    assert!(of(&rows[3], "height_px") < 0.5 * of(&rows[0], "height_px"));
    for of in ["coat", "fur"] {
        assert_eq!(report["dolly"][of].as_array().unwrap().len(), 2);
    }
    for kind in ["csv", "svg", "png"] {
        assert!(out.with_extension(kind).is_file(), "no {kind}");
    }
}
