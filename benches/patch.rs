//! How long lapped patches take, and how that grows with the mesh: `cargo bench --bench patch`.
//!
//! An atlas is timed beside what xatlas alone takes with the same chart options.
//!
//! Spheres are combed by gravity; their triangle count is 8 n². The bunnies need `../shared` and are left out without.

#[path = "../tests/meshes.rs"]
#[allow(dead_code, reason = "tests use the rest")]
mod meshes;

use furrier::data::mesh::Mesh;
use furrier::fur::field::{FieldSource, directions};
use furrier::fur::patch::{Parameterisation, parameterise, xatlas_alone};
use furrier::math::Vec3;

/// A shared mesh of one part, 1 m across; `None` where it is missing.
fn real_mesh(name: &str) -> Option<Mesh> {
    let path = format!("{}/../shared/assets/real/{name}.glb", env!("CARGO_MANIFEST_DIR"));
    let asset = furrier::asset::load(&path).ok()?;
    asset.parts.first()?.mesh(1.0 / asset.diagonal_units).ok()
}

fn main() {
    divan::main();
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
