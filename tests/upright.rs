//! Patches for hair that stands upright: bounded by stretch and by their share of the skin, turned by chance.

use crate::common::shared;
use crate::meshes;
use crate::patch::covers;
use furrier::data::mesh::Mesh;
use furrier::data::patches::Patches;
use furrier::fur::field::{FieldSource, directions};
use furrier::fur::patch::{Parameterisation, parameterise};
use furrier::math::Vec3;

fn lapped(mesh: &Mesh, comb: &[Vec3], seed: u64) -> Patches {
    let patches = parameterise(mesh, comb, mesh.diagonal_m() / 25.0, Parameterisation::Lapped { seed }).unwrap();
    covers(mesh, &patches).unwrap();
    assert_eq!(patches.stats.mirrored_m2, 0.0, "{:?}", patches.stats);
    patches
}

fn tailward(mesh: &Mesh) -> Vec<Vec3> {
    directions(mesh, &[FieldSource::Tailward { sag: 0.3 }]).unwrap().direction
}

fn upright(mesh: &Mesh) -> Vec<Vec3> {
    vec![Vec3::ZERO; mesh.positions_m.len()]
}

/// The direction of +u on a triangle.
fn along_u(mesh: &Mesh, patches: &Patches, t: usize) -> Vec3 {
    let [a, b, c] = mesh.corners_m(t);
    let [p, q, r] = patches.triangles[t].map(|v| patches.uv[v as usize]);
    ((b - a) * (r - p).y - (c - a) * (q - p).y).normalize_or_zero()
}

/// Mean over the skin of the direction that +u has there, and over several seeds.
fn mean_u(mesh: &Mesh, comb: &[Vec3], seeds: u64) -> f32 {
    let of = |seed: u64| {
        let patches = lapped(mesh, comb, seed);
        (0..mesh.triangles.len()).map(|t| along_u(mesh, &patches, t) * mesh.area_m2(t)).sum::<Vec3>()
    };
    let area_m2: f32 = (0..mesh.triangles.len()).map(|t| mesh.area_m2(t)).sum();
    (0..seeds).map(of).sum::<Vec3>().length() / (seeds as f32 * area_m2)
}

#[test]
fn upright_hair_needs_few_patches_and_stretches_less() {
    for mesh in [meshes::sphere(14, 0.1), meshes::torus(16, [1.0, 0.4])] {
        let combed = lapped(&mesh, &tailward(&mesh), 1).stats;
        let free = lapped(&mesh, &upright(&mesh), 1).stats;
        assert!((6..=combed.patches * 2 / 3).contains(&free.patches), "{} for {}", free.patches, combed.patches);
        assert!(free.seams_m < 1.25 * combed.seams_m, "{} m for {}", free.seams_m, combed.seams_m);
        assert!(free.within > 0.99 && free.within >= combed.within, "{} for {}", free.within, combed.within);
    }
}

#[test]
fn upright_hair_on_shared_meshes() {
    let Some(shared) = shared() else { return };
    for name in ["bunny_5k", "spot", "Fox"] {
        let asset = furrier::asset::load(&shared.join(format!("real/{name}.glb")).to_string_lossy()).unwrap();
        let mesh = asset.parts[0].mesh(1.0 / asset.diagonal_units).unwrap();
        let [combed, free] = [tailward(&mesh), upright(&mesh)].map(|comb| lapped(&mesh, &comb, 1).stats);
        for stats in [&combed, &free] {
            let seams = stats.seams_m / stats.area_m2.sqrt();
            println!("{name}: {} patches, {:.4} within, seams {seams:.1}", stats.patches, stats.within);
        }
        assert!(free.patches * 4 < combed.patches, "{name}: {} for {}", free.patches, combed.patches);
        assert!(free.seams_m < 1.1 * combed.seams_m, "{name}: {} m for {}", free.seams_m, combed.seams_m);
        assert!(free.within > 0.99 && free.within > combed.within, "{name}: {}", free.within);
    }
}

#[test]
fn upright_hair_has_no_direction_in_common() {
    // On level skin directions can be compared; with a comb they are one.
    let mesh = meshes::plane(16, 1.0);
    assert!(mean_u(&mesh, &tailward(&mesh), 1) > 0.99);
    let mean = mean_u(&mesh, &upright(&mesh), 16);
    println!("mean of +u over seeds: {mean:.3}");
    assert!(mean < 0.15, "{mean}");
    let again = lapped(&mesh, &upright(&mesh), 3);
    assert_eq!(again, lapped(&mesh, &upright(&mesh), 3), "the same bytes again");
}

#[test]
fn combed_skin_beside_upright_is_still_combed() {
    let mesh = meshes::sphere(16, 0.1);
    // Every vertex below a height keeps its comb, those above have none.
    let combed = |p: Vec3| p.y < 0.02;
    let comb: Vec<Vec3> =
        mesh.positions_m.iter().zip(tailward(&mesh)).map(|(p, d)| if combed(*p) { d } else { Vec3::ZERO }).collect();
    let patches = lapped(&mesh, &comb, 1);
    let stats = &patches.stats;
    assert!(stats.within > 0.98 && stats.field_angle_rad < 0.1, "{stats:?}");
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        let corners = triangle.map(|v| comb[v as usize]);
        if corners.iter().all(|d| *d != Vec3::ZERO) {
            let mean = corners.iter().sum::<Vec3>().normalize_or_zero();
            assert!(mean.dot(along_u(&mesh, &patches, t)) > 0.6, "triangle {t} lies across its comb");
        }
    }
    // Upright skin is not one patch with the combed around it.
    let of = |t: usize| patches.patch[patches.triangles[t][0] as usize];
    let above = |t: &usize| mesh.triangles[*t].iter().all(|&v| mesh.positions_m[v as usize].y > 0.05);
    let free: std::collections::BTreeSet<u32> = (0..mesh.triangles.len()).filter(above).map(of).collect();
    assert!(free.len() > 1, "{free:?}");
}
