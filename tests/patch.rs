//! Parameterisation: every triangle once, along the comb, true to scale.

use crate::common::shared;
use crate::meshes;
use furrier::data::mesh::Mesh;
use furrier::data::patches::Patches;
use furrier::fur::field::{FieldSource, directions};
use furrier::fur::patch::{Parameterisation, parameterise};
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
    let comb = meshes::tangent(&mesh, |_| Vec3::X);
    assert!(parameterise(&mesh, &comb, 0.1, UV).is_ok());
    let error = parameterise(&mesh, &comb, 0.1, Parameterisation::Uv { set: 1 }).expect_err("no such set");
    assert_eq!(error.field.as_deref(), Some("TEXCOORD_1"));
    mesh.uv_sets[0].fill(Vec2::ZERO);
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

/// A part of a shared file: file, material, mesh with its bounding diagonal at 1 m.
type SharedPart = (std::path::PathBuf, String, Mesh);

/// The parts of every shared file that can be read, in the order of their names. Files of `hard` that must bake must
/// also be read.
fn shared_parts(shared: &std::path::Path) -> impl Iterator<Item = SharedPart> {
    let files = |folder| std::fs::read_dir(shared.join(folder)).expect("readable").map(|e| e.expect("entry").path());
    let mut paths: Vec<_> = ["real", "hard"].into_iter().flat_map(files).collect();
    paths.sort();
    paths.retain(|path| path.extension().is_some_and(|e| e == "glb" || e == "gltf" || e == "obj"));
    let list = std::fs::read_to_string(shared.join("hard/README.md")).expect("a list of hard cases");
    let must_read = move |path: &std::path::Path| {
        let name = path.file_name().and_then(|n| n.to_str()).expect("a name");
        let row = list.lines().find(|line| line.starts_with(&format!("| {name} |")));
        row.is_none_or(|row| row.split('|').nth(3).is_some_and(|expected| expected.trim().starts_with("bake")))
    };
    paths.into_iter().flat_map(move |path| {
        let asset = match furrier::asset::load(&path.to_string_lossy()) {
            Ok(asset) => asset,
            Err(error) if must_read(&path) => panic!("{}: {error}", path.display()),
            Err(_) => return Vec::new(),
        };
        let part = |part: &furrier::asset::Part| {
            let mesh = part.mesh(1.0 / asset.diagonal_units).expect("a sound part");
            (path.clone(), part.material_name.clone(), mesh)
        };
        asset.parts.iter().map(part).collect()
    })
}

#[test]
fn every_shared_mesh_is_covered_by_its_atlas_and_its_own_coordinates() {
    let Some(shared) = shared() else { return };
    for (path, material, mesh) in shared_parts(&shared) {
        let comb = meshes::tangent(&mesh, |_| Vec3::new(0.0, -1.0, -0.3));
        let mut methods = vec![];
        if mesh.triangles.len() < 3_000 {
            methods.push(ATLAS); // xatlas needs seconds for larger ones.
        }
        match parameterise(&mesh, &comb, 0.05, UV) {
            Ok(_) => methods.push(UV),
            Err(error) => assert_eq!(error.field.as_deref(), Some("TEXCOORD_0"), "{} {material}", path.display()),
        }
        for method in methods {
            let patches = parameterise(&mesh, &comb, 0.05, method)
                .unwrap_or_else(|e| panic!("{} {material}: {e}", path.display()));
            covers(&mesh, &patches).unwrap_or_else(|e| panic!("{} {material}: {e}", path.display()));
        }
    }
}

const LAPPED: Parameterisation = Parameterisation::Lapped { seed: 1 };

#[test]
fn lapped_patches_cover_every_shared_mesh_and_lie_flat() {
    let Some(shared) = shared() else { return };
    let mut files = std::collections::BTreeSet::new();
    for (path, material, mesh) in shared_parts(&shared) {
        let comb = directions(&mesh, &[FieldSource::Tailward { sag: 0.3 }]).expect("a comb").direction;
        let patches = parameterise(&mesh, &comb, 0.05, LAPPED).expect("patches");
        covers(&mesh, &patches).unwrap_or_else(|e| panic!("{} {material}: {e}", path.display()));
        let s = &patches.stats;
        assert_eq!(s.mirrored_m2, 0.0, "{} {material}", path.display());
        assert!(s.within > 0.95 && s.field_angle_rad < 10_f64.to_radians(), "{} {material}: {s:?}", path.display());
        if path.ends_with("bunny_5k.glb") {
            assert!(s.patches <= 300, "{s:?}");
        }
        files.insert(path);
    }
    assert!(files.iter().any(|path| path.ends_with("spot_control_quads.obj")), "{files:?}");
    assert!(files.iter().any(|path| path.ends_with("negative_indices.obj")), "{files:?}");
}

/// Tests of growth on meshes without shared files: what must hold on any of them.
fn grows_well(mesh: &Mesh, comb: &[Vec3]) -> Patches {
    let patches = parameterise(mesh, comb, mesh.diagonal_m().max(1e-30) / 20.0, LAPPED).expect("patches");
    covers(mesh, &patches).expect("covered");
    assert_eq!(patches.stats.mirrored_m2, 0.0, "{:?}", patches.stats);
    patches
}

#[test]
fn lapped_patches_grow_on_any_surface() {
    let one = meshes::mesh(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
    assert_eq!(grows_well(&one, &[Vec3::X; 3]).stats.patches, 1);
    // Combed along +y: u is y, and v is −x.
    let combed = grows_well(&one, &[Vec3::Y; 3]);
    let [a, b, c] = combed.triangles[0].map(|v| combed.uv[v as usize]);
    let tiles = 20.0 / one.diagonal_m();
    assert!((c - a - Vec2::new(tiles, 0.0)).length() < 1e-4 && (b - a - Vec2::new(0.0, -tiles)).length() < 1e-4);

    for mesh in [meshes::sphere(12, 0.1), meshes::torus(12, [1.0, 0.4]), meshes::moebius(60), meshes::plane(20, 3.0)] {
        let comb = directions(&mesh, &[FieldSource::Tailward { sag: 0.3 }]).expect("a comb").direction;
        let stats = grows_well(&mesh, &comb).stats;
        assert!(stats.within > 0.95 && stats.field_angle_rad < 0.17, "{stats:?}");
    }
    // Without any comb patches still lie flat.
    let sphere = meshes::sphere(12, 0.1);
    let stats = grows_well(&sphere, &vec![Vec3::ZERO; sphere.positions_m.len()]).stats;
    assert!(stats.within > 0.95 && stats.patches < 60, "{stats:?}");

    let parts: Vec<Mesh> = (0..500).map(|_| meshes::sphere(2, 0.1)).collect();
    let mut all = Mesh::default();
    for (i, part) in parts.iter().enumerate() {
        let base = all.positions_m.len() as u32;
        all.positions_m.extend(part.positions_m.iter().map(|&p| p + Vec3::new((i % 25) as f32, (i / 25) as f32, 0.0)));
        all.triangles.extend(part.triangles.iter().map(|t| t.map(|v| v + base)));
    }
    let all = meshes::mesh(all.positions_m, all.triangles);
    assert!(grows_well(&all, &meshes::tangent(&all, |_| Vec3::Z)).stats.patches >= 500);

    // A fan of slivers, three triangles on one edge, and triangles without area.
    let fan = (0..40).map(|i| Vec3::new(1.0, i as f32 * 1e-6, 0.0));
    let slivers =
        meshes::mesh(std::iter::once(Vec3::ZERO).chain(fan).collect(), (1..40).map(|i| [0, i, i + 1]).collect());
    grows_well(&slivers, &vec![Vec3::X; slivers.positions_m.len()]);
    let book = meshes::mesh(
        vec![Vec3::ZERO, Vec3::Y, Vec3::X, Vec3::Z, Vec3::NEG_X],
        vec![[0, 1, 2], [0, 1, 3], [0, 1, 4], [0, 0, 1], [0, 1, 0], [2, 2, 2]],
    );
    assert_eq!(grows_well(&book, &meshes::tangent(&book, |_| Vec3::Y)).triangles.len(), 6);
    let nothing = meshes::mesh(vec![Vec3::ZERO], vec![]);
    assert_eq!(grows_well(&nothing, &[Vec3::ZERO]).stats.patches, 0);
}

#[test]
fn scale_rotation_and_place_change_nothing_that_counts() {
    let mesh = meshes::torus(14, [1.0, 0.4]);
    let comb = directions(&mesh, &[FieldSource::Tailward { sag: 0.3 }]).expect("a comb").direction;
    let patches = parameterise(&mesh, &comb, 0.125, LAPPED).expect("patches");
    for power in [-20, 7] {
        let mut scaled = mesh.clone();
        let scale = 2.0_f32.powi(power);
        scaled.positions_m.iter_mut().for_each(|p| *p *= scale);
        let again = parameterise(&scaled, &comb, 0.125 * scale, LAPPED).expect("patches");
        assert_eq!((&again.uv, &again.patch), (&patches.uv, &patches.patch), "scaled by 2^{power}");
    }
    let turn = furrier::math::Quat::from_rotation_x(0.3) * furrier::math::Quat::from_rotation_y(1.1);
    let mut moved = mesh.clone();
    moved.positions_m.iter_mut().for_each(|p| *p = turn * *p + Vec3::new(3.0, -1.0, 2.0));
    moved.normals.iter_mut().for_each(|n| *n = turn * *n);
    let turned: Vec<Vec3> = comb.iter().map(|&d| turn * d).collect();
    let again = parameterise(&moved, &turned, 0.125, LAPPED).expect("patches");
    let measures = |p: &Patches| {
        let s = &p.stats;
        [s.singular_values.mean, s.singular_values.p5, s.singular_values.p95, s.within, s.seams_m, s.tiles_per_m.mean]
    };
    for (a, b) in measures(&patches).into_iter().zip(measures(&again)) {
        assert!((a - b).abs() <= 0.01 * a.abs(), "{:?} {:?}", patches.stats, again.stats);
    }
    assert!((patches.stats.field_angle_rad - again.stats.field_angle_rad).abs() < 0.01 * patches.stats.field_angle_rad);
}

#[test]
fn threads_do_not_matter() {
    // Large enough that every step takes all the threads it is given.
    let mesh = meshes::sphere(50, 0.1);
    let comb = meshes::tangent(&mesh, |_| Vec3::NEG_Y);
    let patches = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| parameterise(&mesh, &comb, 0.01, LAPPED)).expect("patches")
    };
    assert_eq!(patches(1), patches(4));
}

#[test]
fn planted_faults_in_patches_are_found() {
    let mesh = meshes::sphere(6, 0.1);
    let comb = meshes::tangent(&mesh, |_| Vec3::NEG_Y);
    let sound = parameterise(&mesh, &comb, 0.02, LAPPED).expect("patches");
    covers(&mesh, &sound).expect("sound");
    let faults: [fn(&mut Patches); 5] = [
        |p| p.triangles.swap(0, 9),
        |p| p.triangles.truncate(8),
        |p| p.uv[3].x = f32::NAN,
        |p| p.patch[p.triangles[4][0] as usize] += 1,
        |p| p.triangles[7].rotate_left(1),
    ];
    for (i, fault) in faults.iter().enumerate() {
        let mut broken = sound.clone();
        fault(&mut broken);
        assert!(covers(&mesh, &broken).is_err(), "fault {i} went unseen");
    }
}

proptest::proptest! {
    #![proptest_config(proptest::prelude::ProptestConfig::with_cases(64))]

    /// Soups of triangles over few points: non-manifold, degenerate, one-sided, flipped.
    #[test]
    fn random_meshes_are_covered(
        points in proptest::collection::vec((-1.0_f32..1.0, -1.0_f32..1.0, -1.0_f32..1.0), 3..30),
        corners in proptest::collection::vec((0_usize..1000, 0_usize..1000, 0_usize..1000), 1..80),
        combs in proptest::collection::vec((-1.0_f32..1.0, -1.0_f32..1.0, -1.0_f32..1.0), 30),
    ) {
        let n = points.len();
        let triangles = corners.iter().map(|&(a, b, c)| [a, b, c].map(|v| (v % n) as u32)).collect();
        let mesh = meshes::mesh(points.into_iter().map(Vec3::from).collect(), triangles);
        let combs: Vec<Vec3> = combs.into_iter().map(|c| Vec3::from(c).normalize_or_zero()).collect();
        for method in [LAPPED, ATLAS] {
            let patches = parameterise(&mesh, &combs[..n], 0.1, method).expect("patches");
            proptest::prop_assert_eq!(covers(&mesh, &patches), Ok(()));
        }
        let field = directions(&mesh, &[FieldSource::Gravity]).expect("a comb");
        for &v in mesh.triangles.iter().flatten() {
            proptest::prop_assert!((field.direction[v as usize].length() - 1.0).abs() < 1e-3);
        }
    }
}
