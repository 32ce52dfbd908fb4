//! Parameterisation: every triangle once, along the comb, true to scale.

use crate::common::shared;
use crate::meshes;
use furrier::data::mesh::Mesh;
use furrier::data::patches::Patches;
use furrier::fur::field::{FieldSource, directions};
use furrier::fur::patch::{Parameterisation, parameterise, uv_usable};
use furrier::math::{Vec2, Vec3};

const ATLAS: Parameterisation = Parameterisation::Atlas { texels_per_tile: 128, padding_texels: 4 };
const UV: Parameterisation = Parameterisation::Uv { set: 0 };

/// Whether `patches` holds every triangle of `mesh` once, in order and in sound numbers.
pub fn covers(mesh: &Mesh, patches: &Patches) -> Result<(), String> {
    let n = patches.base_vertex.len();
    if patches.uv.len() != n || patches.patch.len() != n || patches.triangles.len() != mesh.triangles.len() {
        return Err("array lengths".into());
    }
    if let Some(i) = patches.uv.iter().position(|uv| !uv.is_finite()) {
        return Err(format!("uv[{i}] is {}", patches.uv[i]));
    }
    for (t, (coat, skin)) in patches.triangles.iter().zip(&mesh.triangles).enumerate() {
        if coat.map(|v| patches.base_vertex[v as usize]) != *skin {
            return Err(format!("triangle {t} lies on other vertices"));
        }
        if coat.iter().any(|&v| patches.patch[v as usize] != patches.patch[coat[0] as usize]) {
            return Err(format!("triangle {t} is in two patches"));
        }
    }
    Ok(())
}

#[test]
fn own_coordinates_are_turned_to_the_comb_and_scaled_to_the_tile() {
    let mut mesh = meshes::plane(8, 0.2);
    // Turn, squeeze and mirror the set; the comb runs along world y.
    for uv in &mut mesh.uv_sets[0] {
        *uv = Vec2::new(0.3 - 0.5 * uv.y - 0.1 * uv.x, 0.5 * uv.x - 0.1 * uv.y);
        uv.x = -uv.x;
    }
    let comb = meshes::tangent(&mesh, |_| Vec3::Y);
    let patches = parameterise(&mesh, &comb, 0.05, UV).expect("usable");
    covers(&mesh, &patches).expect("covered");
    assert_eq!(patches.stats.patches, 1);
    assert!(patches.stats.field_angle_rad < 1e-5, "{:?}", patches.stats);
    assert!((patches.stats.singular_values.p5 - 1.0).abs() < 1e-5, "{:?}", patches.stats);
    // A tile of 5 cm: 4 tiles along an edge of 20 cm; u along y, and v along −x so that u × v faces the reader.
    let at = |x: f32, y: f32| {
        let i = patches
            .base_vertex
            .iter()
            .position(|&v| (mesh.positions_m[v as usize] - Vec3::new(x, y, 0.0)).length() < 1e-6);
        patches.uv[i.expect("a grid point")]
    };
    assert!((at(0.0, 0.2) - at(0.0, 0.0) - Vec2::new(4.0, 0.0)).length() < 1e-4);
    assert!((at(0.2, 0.0) - at(0.0, 0.0) - Vec2::new(0.0, -4.0)).length() < 1e-4);
}

#[test]
fn unusable_coordinates_are_refused_by_name() {
    let mut mesh = meshes::plane(4, 1.0);
    assert!(uv_usable(&mesh, 0) && !uv_usable(&mesh, 1));
    let comb = meshes::tangent(&mesh, |_| Vec3::X);
    let error = parameterise(&mesh, &comb, 0.1, Parameterisation::Uv { set: 1 }).expect_err("no such set");
    assert_eq!(error.field.as_deref(), Some("TEXCOORD_1"));
    mesh.uv_sets[0].fill(Vec2::ZERO);
    assert!(!uv_usable(&mesh, 0));
    let error = parameterise(&mesh, &comb, 0.1, UV).expect_err("all zero");
    assert_eq!(error.field.as_deref(), Some("TEXCOORD_0"));
    assert!(parameterise(&mesh, &comb, f32::NAN, ATLAS).is_err());
    assert!(parameterise(&mesh, &comb[1..], 0.1, ATLAS).is_err());
}

#[test]
fn mirrored_and_shared_texels_are_measured() {
    // Two squares side by side; the second uses the first one's texels, mirrored.
    let mut mesh = meshes::grid(2, 1, [false; 2], |u, v| Vec3::new(2.0 * u, v, 0.0));
    mesh.uv_sets = vec![mesh.positions_m.iter().map(|p| Vec2::new(1.0 - (p.x - 1.0).abs(), p.y)).collect()];
    let comb = meshes::tangent(&mesh, |_| Vec3::X);
    let stats = parameterise(&mesh, &comb, 0.1, UV).expect("usable").stats;
    assert!((stats.mirrored_m2 - 1.0).abs() < 1e-6, "{stats:?}");
    assert!((stats.overlapped_m2 - 2.0).abs() < 1e-2, "{stats:?}");
    assert_eq!(stats.warnings.len(), 2, "{:?}", stats.warnings);
}

#[test]
fn atlas_charts_hold_the_sphere_without_overlap() {
    let mesh = meshes::sphere(16, 0.1);
    let comb = meshes::tangent(&mesh, |_| Vec3::NEG_Y);
    let patches = parameterise(&mesh, &comb, 0.02, ATLAS).expect("charted");
    covers(&mesh, &patches).expect("covered");
    assert!(patches.stats.within > 0.9, "{:?}", patches.stats);
    assert!(patches.extent.min_element() > 1.0);
    assert!(patches.uv.iter().all(|uv| uv.min_element() >= 0.0 && (patches.extent - *uv).min_element() >= 0.0));
    assert_eq!(patches, parameterise(&mesh, &comb, 0.02, ATLAS).expect("charted"), "the same bytes again");

    // Texel centres belong to one chart at most, its padding included.
    let texels = (patches.extent * 128.0).as_uvec2();
    let mut owner = vec![u32::MAX; (texels.x * texels.y) as usize];
    let mut bounds = std::collections::BTreeMap::new();
    for (&p, &uv) in patches.patch.iter().zip(&patches.uv) {
        let entry = bounds.entry(p).or_insert((uv, uv));
        *entry = (entry.0.min(uv), entry.1.max(uv));
    }
    for (p, (low, high)) in bounds {
        let (low, high) = ((low * 128.0 - 3.5).as_uvec2(), (high * 128.0 + 3.5).as_uvec2());
        for y in low.y..high.y {
            for x in low.x..high.x {
                let cell = &mut owner[(y * texels.x + x) as usize];
                assert!(*cell == u32::MAX, "charts {p} and {cell} meet at {x}, {y}");
                *cell = p;
            }
        }
    }
}

#[test]
fn every_shared_mesh_is_covered_by_its_atlas() {
    let Some(shared) = shared() else { return };
    for folder in ["assets/real", "assets/hard"] {
        let mut paths: Vec<_> =
            std::fs::read_dir(shared.join(folder)).expect("readable").map(|e| e.expect("entry").path()).collect();
        paths.sort();
        for path in paths.iter().filter(|p| p.extension().is_some_and(|e| e == "glb")) {
            let Some(mesh) = meshes::read_glb(path) else { continue };
            if mesh.triangles.len() > 20_000 {
                continue; // xatlas needs 10 s for these.
            }
            let comb = meshes::tangent(&mesh, |_| Vec3::new(0.0, -1.0, -0.3));
            let tile = mesh.diagonal_m() / 20.0;
            let patches = parameterise(&mesh, &comb, tile, ATLAS).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
            covers(&mesh, &patches).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        }
    }
}

const LAPPED: Parameterisation = Parameterisation::Lapped { seed: 1 };

#[test]
fn lapped_patches_cover_every_shared_mesh_and_lie_flat() {
    let Some(shared) = shared() else { return };
    for folder in ["assets/real", "assets/hard"] {
        let mut paths: Vec<_> =
            std::fs::read_dir(shared.join(folder)).expect("readable").map(|e| e.expect("entry").path()).collect();
        paths.sort();
        for path in paths.iter().filter(|p| p.extension().is_some_and(|e| e == "glb")) {
            let Some(mesh) = meshes::read_glb(path) else { continue };
            let comb = directions(&mesh, &[FieldSource::Tailward { sag: 0.3 }]).expect("a comb").direction;
            let patches = parameterise(&mesh, &comb, mesh.diagonal_m() / 20.0, LAPPED).expect("patches");
            covers(&mesh, &patches).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
            let s = &patches.stats;
            assert!(s.within > 0.95 && s.field_angle_rad < 10_f64.to_radians(), "{}: {s:?}", path.display());
            assert_eq!(s.mirrored_m2, 0.0, "{}", path.display());
            if path.ends_with("bunny_5k.glb") {
                assert!(s.patches <= 300, "{s:?}");
            }
        }
    }
}
