//! How long lapped patches take, and how that grows with the mesh: `cargo bench --bench patch [-- FILTER]`.
//!
//! First come ratios that a busy machine hardly changes, each from runs that take turns, the best of several: how time
//! grows with the mesh, and an atlas over what xatlas alone takes with the same chart options. Then the times as divan
//! measures them. `-- growth` and `-- charts` print one of the ratios alone, any other filter none.
//!
//! Spheres are combed by gravity; their triangle count is 8 n². The bunnies need `../shared` and are left out without.
#![allow(
    clippy::expect_used,
    clippy::print_stdout,
    reason = "a bench that cannot go on stops, and prints what it found"
)]

#[path = "../tests/meshes.rs"]
#[allow(dead_code, reason = "tests use the rest")]
mod meshes;

use furrier::data::mesh::Mesh;
use furrier::fur::field::{FieldSource, directions};
use furrier::fur::patch::{Parameterisation, parameterise, xatlas_alone};
use furrier::math::Vec3;
use std::time::Instant;

/// A shared mesh of one part, 1 m across; `None` where it is missing.
fn real_mesh(name: &str) -> Option<Mesh> {
    let path = format!("{}/../shared/assets/real/{name}.glb", env!("CARGO_MANIFEST_DIR"));
    let asset = furrier::asset::load(&path).ok()?;
    asset.parts.first()?.mesh(1.0 / asset.diagonal_units).ok()
}

fn main() {
    let filter = std::env::args().skip(1).find(|a| !a.starts_with("--"));
    match filter.as_deref() {
        Some("growth") => growth(),
        Some("charts") => atlas_over_xatlas(),
        Some(_) => divan::main(),
        None => {
            growth();
            atlas_over_xatlas();
            divan::main();
        }
    }
}

/// Processor time of all threads so far, s; nothing where the system does not say.
fn processor_s() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    let fields: Vec<&str> = stat.rsplit(')').next()?.split_whitespace().collect();
    let ticks = |i: usize| fields.get(i)?.parse::<f64>().ok();
    // utime and stime are the 14th and 15th field, in hundredths of a second.
    Some((ticks(11)? + ticks(12)?) / 100.0)
}

/// Wall and processor time of `work`, s, each the least of the runs so far.
fn best(so_far: &mut [f64; 2], work: impl FnOnce()) {
    let (start, processor) = (Instant::now(), processor_s());
    work();
    let spent = processor_s().zip(processor).map_or(f64::INFINITY, |(after, before)| after - before);
    *so_far = [so_far[0].min(start.elapsed().as_secs_f64()), so_far[1].min(spent)];
}

/// Lapped patches on spheres of 5,000 to a million triangles and on the bunnies.
fn growth() {
    let mut spheres = Vec::new();
    for n in [25, 100, 353] {
        let mesh = meshes::sphere(n, 0.1);
        spheres.push((format!("sphere of {}", mesh.triangles.len()), meshes::tangent(&mesh, |_| Vec3::NEG_Y), mesh));
    }
    for name in ["bunny_5k", "bunny_69k"] {
        let Some(mesh) = real_mesh(name) else { continue };
        let comb = directions(&mesh, &[FieldSource::Tailward { sag: 0.3 }]).expect("a comb").direction;
        spheres.push((name.to_owned(), comb, mesh));
    }
    let mut times = vec![[f64::INFINITY; 2]; spheres.len()];
    for _ in 0..3 {
        for ((_, comb, mesh), times) in spheres.iter().zip(&mut times) {
            let edge_m = mesh.diagonal_m() / 20.0;
            best(times, || drop(parameterise(mesh, comb, edge_m, Parameterisation::Lapped { seed: 1 })));
        }
    }
    for ((name, ..), [wall, processor]) in spheres.iter().zip(&times) {
        println!("lapped, {name}: {wall:.3} s, {processor:.2} s of processor time");
    }
    let decades = (spheres[2].2.triangles.len() as f64 / spheres[0].2.triangles.len() as f64).ln();
    let exponent = |what: usize| (times[2][what] / times[0][what]).ln() / decades;
    println!("that is n^{:.3}, n^{:.3} of processor time", exponent(0), exponent(1));
}

/// An atlas over xatlas alone.
fn atlas_over_xatlas() {
    for name in ["bunny_5k", "spot", "bunny_closed_6k6"] {
        let Some(mesh) = real_mesh(name) else { continue };
        let comb = directions(&mesh, &[FieldSource::Tailward { sag: 0.3 }]).expect("a comb").direction;
        let method = Parameterisation::Atlas { texels_per_tile: 128, padding_texels: 4 };
        let (mut ours, mut alone) = ([f64::INFINITY; 2], [f64::INFINITY; 2]);
        for _ in 0..15 {
            best(&mut alone, || drop(xatlas_alone(&mesh)));
            best(&mut ours, || drop(parameterise(&mesh, &comb, mesh.diagonal_m() / 20.0, method)));
        }
        println!(
            "atlas over xatlas, {name}: {:.3} s of {:.3} s, {:.3}; processor time {:.3}",
            ours[0],
            alone[0],
            ours[0] / alone[0],
            ours[1] / alone[1]
        );
    }
}

fn lapped(bencher: divan::Bencher, mesh: &Mesh, comb: &[Vec3]) {
    let tile_edge_m = mesh.diagonal_m() / 20.0;
    bencher.bench_local(|| parameterise(mesh, comb, tile_edge_m, Parameterisation::Lapped { seed: 1 }));
}

#[divan::bench(args = [25, 50, 100, 200, 353], sample_count = 3, sample_size = 1)]
fn sphere(bencher: divan::Bencher, n: u32) {
    let mesh = meshes::sphere(n, 0.1);
    let comb = meshes::tangent(&mesh, |_| Vec3::NEG_Y);
    lapped(bencher, &mesh, &comb);
}

#[divan::bench(args = ["bunny_5k", "spot", "cat_16k", "bunny_69k"], sample_count = 3, sample_size = 1)]
fn real(bencher: divan::Bencher, name: &str) {
    let Some(mesh) = real_mesh(name) else { return };
    let comb = directions(&mesh, &[FieldSource::Tailward { sag: 0.3 }]).expect("a comb").direction;
    lapped(bencher, &mesh, &comb);
}

#[divan::bench(args = ["bunny_5k", "bunny_69k"], sample_count = 3, sample_size = 1)]
fn comb(bencher: divan::Bencher, name: &str) {
    let Some(mesh) = real_mesh(name) else { return };
    bencher.bench_local(|| directions(&mesh, &[FieldSource::Tailward { sag: 0.3 }]));
}

#[divan::bench(args = ["bunny_5k", "spot"], sample_count = 5, sample_size = 1)]
fn atlas(bencher: divan::Bencher, name: &str) {
    let Some(mesh) = real_mesh(name) else { return };
    let comb = directions(&mesh, &[FieldSource::Tailward { sag: 0.3 }]).expect("a comb").direction;
    let method = Parameterisation::Atlas { texels_per_tile: 128, padding_texels: 4 };
    bencher.bench_local(|| parameterise(&mesh, &comb, mesh.diagonal_m() / 20.0, method));
}

#[divan::bench(args = ["bunny_5k", "spot"], sample_count = 5, sample_size = 1)]
fn plain_xatlas(bencher: divan::Bencher, name: &str) {
    let Some(mesh) = real_mesh(name) else { return };
    bencher.bench_local(|| xatlas_alone(&mesh));
}
