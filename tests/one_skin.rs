//! All parts of an asset are one skin: cuts, order, seams and hard edges in a file change no hair, and hair leaves every face.

use crate::common::shared;
use furrier::asset::{self, Asset, Document, Fallback};
use furrier::bake::picture::{Grown, Only, PictureRequest};
use furrier::bake::units::Units;
use furrier::bake::{Method, Request, bake};
use furrier::data::coat::Coat;
use furrier::math::Vec3;
use furrier::preset::Preset;
use serde_json::json;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The fox with little hair and small textures.
pub fn thin(settings: &[&str]) -> Preset {
    let small = [
        "guard.density_per_cm2=20",
        "undercoat.density_per_cm2=1000",
        "shells.layers=4",
        "shells.texture_size=32",
        "fins.texture_width=16",
        "fins.texture_height=16",
    ];
    let all: Vec<String> = small.iter().chain(settings).map(|&s| s.to_owned()).collect();
    Preset::load("fox").unwrap().with_settings(&all).unwrap()
}

pub fn baked(input: &Path, out: &Path, preset: &Preset, method: Method) -> (Asset, Coat) {
    let request = Request {
        input: input.to_string_lossy().into_owned(),
        reading: Default::default(),
        out: out.to_owned(),
        preset: preset.clone(),
        presets: vec![],
        materials: vec![],
        units: Units::Metres,
        method,
        seed: 1,
        fallback: Fallback::Shells(2),
        judge: false,
        cache: None,
        draft: false,
    };
    bake(&request, &mut |_| ()).unwrap_or_else(|e| panic!("{}: {e}", input.display()));
    asset::read_coat(out).unwrap()
}

pub fn grown(input: &Path, preset: &Preset) -> Grown {
    Grown::new(&PictureRequest {
        input: input.to_string_lossy().into_owned(),
        reading: Default::default(),
        preset: preset.clone(),
        materials: vec![],
        units: Units::Metres,
        seed: 1,
        only: Only::Hybrid,
        pose: None,
    })
    .unwrap()
}

pub fn write(document: &Document, folder: &Path, name: &str) -> PathBuf {
    let path = folder.join(name);
    std::fs::write(&path, document.to_glb().unwrap()).unwrap();
    path
}

/// A sample whose one primitive is cut into `pieces`, triangle by triangle in turns, each with a material of its own, backwards.
fn cut(name: &str, pieces: usize) -> Document {
    let mut document = asset::load(&format!("sample:{name}")).unwrap().document;
    let whole = document.json["meshes"][0]["primitives"][0].clone();
    let indices = document.integers(whole["indices"].as_u64().unwrap() as usize, 1).unwrap();
    let mut primitives = Vec::new();
    for piece in 0..pieces {
        let material = document.json["materials"][0].clone();
        let material = document.push("materials", material);
        let own = indices.chunks(3).rev().enumerate().filter(|(t, _)| t % pieces == piece);
        let bytes: Vec<u8> = own.flat_map(|(_, t)| [t[1], t[2], t[0]]).flat_map(u32::to_le_bytes).collect();
        let count = bytes.len() / 4;
        let view = document.push_view(&bytes, Some(34963));
        let accessor = json!({"bufferView": view, "componentType": 5125, "count": count, "type": "SCALAR"});
        let mut primitive = whole.clone();
        primitive["indices"] = document.push("accessors", accessor).into();
        primitive["material"] = material.into();
        primitives.push(primitive);
    }
    document.json["meshes"][0]["primitives"] = json!(primitives);
    document
}

/// Hairs, each as the bits of its points, in an order of their own.
fn hairs(grown: &Grown) -> Vec<Vec<[u32; 3]>> {
    let scene = grown.scene();
    let strands = scene.guard.unwrap().0;
    let bits = |p: &Vec3| p.to_array().map(|x| (x + 0.0).to_bits());
    let mut all: Vec<_> = (0..strands.len()).map(|i| strands.points_of_m(i).iter().map(bits).collect()).collect();
    all.sort_unstable();
    all
}

#[test]
fn cutting_a_mesh_into_primitives_changes_no_hair() {
    let folder = tempfile::tempdir().unwrap();
    let preset = thin(&[]);
    let whole = write(&asset::load("sample:torus").unwrap().document, folder.path(), "one.glb");
    let pieces = write(&cut("torus", 3), folder.path(), "three.glb");
    let (one, three) = (hairs(&grown(&whole, &preset)), hairs(&grown(&pieces, &preset)));
    assert!(one.len() > 1000, "{}", one.len());
    assert!(one == three, "{} hairs in one, {} in three, and they differ", one.len(), three.len());
    // A planted fault: another seed of chance is seen.
    let other = write(&asset::load("sample:sphere").unwrap().document, folder.path(), "other.glb");
    assert!(hairs(&grown(&other, &preset)) != one);

    let (_, one) = baked(&whole, &folder.path().join("a.glb"), &preset, Method::Lapped);
    let (asset, three) = baked(&pieces, &folder.path().join("b.glb"), &preset, Method::Lapped);
    assert_eq!((one.primitives.len(), three.primitives.len()), (1, 3));
    // By place: offset, axis, normal and texture coordinates of corners.
    let corners = |coat: &Coat| {
        let mut all: Vec<[u32; 11]> = Vec::new();
        for primitive in &coat.primitives {
            for &v in primitive.triangles.iter().flatten() {
                let v = v as usize;
                let values = [
                    primitive.offset[v].to_array(),
                    primitive.axis[v].to_array(),
                    primitive.normal[v].to_array(),
                    [primitive.uv[v].x, primitive.uv[v].y, 0.0],
                ];
                all.push(std::array::from_fn(|i| (values.as_flattened()[i] + 0.0).to_bits()));
            }
        }
        all.sort_unstable();
        all
    };
    let (one_corners, three_corners) = (corners(&one), corners(&three));
    let differ = |of: std::ops::Range<usize>| {
        let part = |all: &[[u32; 11]]| {
            let mut part: Vec<Vec<u32>> = all.iter().map(|c| c[of.clone()].to_vec()).collect();
            part.sort_unstable();
            part
        };
        part(&one_corners) != part(&three_corners)
    };
    let differing = [differ(0..3), differ(3..6), differ(6..9), differ(9..11)];
    assert_eq!(differing, [false; 4], "offsets, axes, normals, texture coordinates");
    // One pool: the attributes are written once.
    let written = &asset.document.json["meshes"][0]["primitives"];
    let attributes = |i: usize| written[i]["extensions"]["FURRIER_mesh_fur"]["attributes"].clone();
    assert_eq!(attributes(0), attributes(1));
    assert_eq!(attributes(0), attributes(2));
}

#[test]
fn primitives_of_a_large_pool_cost_what_they_use() {
    let folder = tempfile::tempdir().unwrap();
    let mut document = asset::load("sample:sphere").unwrap().document;
    // Vertices that nobody uses, and many primitives over the pool.
    let many = cut("sphere", 40);
    document.clone_from(&many);
    let path = write(&document, folder.path(), "many.glb");
    let asset = asset::load(&path.to_string_lossy()).unwrap();
    let (kept, pool): (usize, usize) = (
        asset.parts.iter().map(|part| part.vertices()).sum(),
        asset.document.json["accessors"][0]["count"].as_u64().unwrap() as usize,
    );
    assert_eq!(asset.parts.len(), 40);
    assert!(kept < 8 * pool, "{kept} vertices are kept of a pool of {pool} by 40 primitives");
    let (again, coat) = baked(&path, &folder.path().join("fur.glb"), &thin(&[]), Method::Lapped);
    let triangles: usize = coat.primitives.iter().map(|p| p.triangles.len()).sum();
    assert_eq!(triangles, asset.parts.iter().map(|part| part.stored.triangles.len()).sum::<usize>());
    let of = |i: usize| {
        again.document.json["meshes"][0]["primitives"][i]["extensions"]["FURRIER_mesh_fur"]["attributes"].clone()
    };
    assert!((1..40).all(|i| of(i) == of(0)));
}

/// How far offsets leave the faces around them: the least sine of any.
fn least_rise(asset: &Asset, coat: &Coat) -> f32 {
    let mut least = f32::INFINITY;
    for primitive in &coat.primitives {
        let is_of = |part: &&asset::Part| (part.mesh, part.primitive) == (primitive.mesh, primitive.primitive);
        let part = asset.parts.iter().find(is_of).unwrap();
        for &triangle in &primitive.triangles {
            // In the rest pose: skins may scale and turn what is stored.
            let base = |v: u32| primitive.base_vertex[v as usize] as usize;
            let [p, q, r] = triangle.map(|v| part.world_units(base(v)));
            let face = (q - p).cross(r - p).normalize();
            for v in triangle {
                let offset = part.world_from_local(base(v)) * primitive.offset[v as usize].as_dvec3();
                least = least.min(face.dot(offset.normalize()) as f32);
            }
        }
    }
    least
}

#[test]
fn hair_leaves_every_face() {
    let folder = tempfile::tempdir().unwrap();
    let Some(shared) = shared() else { return };
    for name in ["wild/cube_12_triangles.glb", "real/quaternius_Deer.glb"] {
        let combed = thin(&["groom.lean_deg=60"]);
        let (asset, coat) = baked(&shared.join(name), &folder.path().join("out.glb"), &combed, Method::Lapped);
        let least = least_rise(&asset, &coat);
        assert!(least > 0.16, "{name}: an offset leaves a face by a sine of {least}");
        // A planted fault: one offset behind its face.
        let mut bent = coat.clone();
        let first = bent.primitives[0].triangles[0][0] as usize;
        bent.primitives[0].offset[first] *= -1.0;
        assert!(least_rise(&asset, &bent) < 0.0);
    }
}

/// A blade: a wedge with an edge of 8°.
fn blade(folder: &Path) -> PathBuf {
    let path = folder.join("blade.obj");
    let text = "v 0 0 0\nv 0 0 1\nv 1 0.07 0\nv 1 0.07 1\nv 1 -0.07 0\nv 1 -0.07 1\nf 1 2 4 3\nf 2 1 5 6\n";
    std::fs::write(&path, text).unwrap();
    path
}

#[test]
fn a_blade_has_hair_of_its_own_on_either_side() {
    let folder = tempfile::tempdir().unwrap();
    let upright = thin(&["groom.comb=upright", "groom.lean_deg=0", "groom.gravity=0"]);
    let (asset, coat) = baked(&blade(folder.path()), &folder.path().join("out.glb"), &upright, Method::Lapped);
    // Over the edge it fans out, half way towards the other side's.
    let least = least_rise(&asset, &coat);
    assert!(least > 0.6 && least < 0.8, "{least}");
    let up = coat.primitives[0].offset.iter().filter(|o| o.y > 0.0).count();
    assert_eq!(coat.primitives[0].offset.len(), 2 * up, "as many corners on each side");
}

/// The plane, its material shown from both sides or one.
fn plane(folder: &Path, double_sided: bool) -> PathBuf {
    let mut document = asset::load("sample:plane").unwrap().document;
    document.json["materials"][0]["doubleSided"] = json!(double_sided);
    write(&document, folder, "plane.glb")
}

#[test]
fn a_thin_double_sided_part_is_furred_on_both_sides() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out.glb");
    let (_, single) = baked(&plane(folder.path(), false), &out, &thin(&[]), Method::Lapped);
    let (_, double) = baked(&plane(folder.path(), true), &out, &thin(&[]), Method::Lapped);
    let sides = |coat: &Coat| {
        let offsets = || coat.primitives[0].triangles.iter().flatten().map(|&v| coat.primitives[0].offset[v as usize]);
        [offsets().filter(|o| o.y > 0.0).count(), offsets().filter(|o| o.y < 0.0).count()]
    };
    let corners = 3 * single.primitives[0].triangles.len();
    assert_eq!(sides(&single), [corners, 0]);
    assert_eq!(sides(&double), [corners, corners]);
    // Half of it is one too, as long as the other half holds no more of its edge than is free.
    let mut document = cut("plane", 1);
    let whole = document.json["meshes"][0]["primitives"][0].clone();
    let indices = document.integers(whole["indices"].as_u64().unwrap() as usize, 1).unwrap();
    let accessor = whole["attributes"]["POSITION"].as_u64().unwrap() as usize;
    let x: Vec<f32> = document.floats(accessor, 3).unwrap().chunks(3).map(|p| p[0]).collect();
    let middle = |t: &[u32]| t.iter().map(|&v| x[v as usize]).sum::<f32>() > 0.0;
    let primitives: Vec<_> = [true, false]
        .map(|double_sided| {
            let own = indices.chunks(3).filter(|t| middle(t) == double_sided).flatten().copied();
            let bytes: Vec<u8> = own.flat_map(u32::to_le_bytes).collect();
            let view = document.push_view(&bytes, Some(34963));
            let accessor =
                json!({"bufferView": view, "componentType": 5125, "count": bytes.len() / 4, "type": "SCALAR"});
            let mut primitive = whole.clone();
            primitive["indices"] = document.push("accessors", accessor).into();
            let material = json!({"name": format!("fur {double_sided}"), "doubleSided": double_sided});
            primitive["material"] = document.push("materials", material).into();
            primitive
        })
        .to_vec();
    document.json["meshes"][0]["primitives"] = json!(primitives);
    let path = write(&document, folder.path(), "half.glb");
    let (_, half) = baked(&path, &out, &thin(&[]), Method::Lapped);
    let counts: Vec<usize> = half.primitives.iter().map(|p| p.triangles.len()).collect();
    assert_eq!(counts[0], 2 * counts[1], "the double-sided half has twice the triangles");
    // A body is no sheet, whatever its material says.
    let mut document = asset::load("sample:sphere").unwrap().document;
    document.json["materials"][0]["doubleSided"] = json!(true);
    let path = write(&document, folder.path(), "sphere.glb");
    let (asset, sphere) = baked(&path, &out, &thin(&[]), Method::Lapped);
    assert_eq!(sphere.primitives[0].triangles.len(), asset.parts[0].stored.triangles.len());
}

#[test]
fn meshes_of_one_skeleton_that_touch_are_one_skin() {
    let folder = tempfile::tempdir().unwrap();
    // The plane's right half as a mesh of its own, on the same joint; and on none.
    let split = |skeleton: bool, gap: f32| {
        let mut document = cut("plane", 1);
        let primitive = document.json["meshes"][0]["primitives"][0].clone();
        let indices = document.integers(primitive["indices"].as_u64().unwrap() as usize, 1).unwrap();
        let accessor = primitive["attributes"]["POSITION"].as_u64().unwrap() as usize;
        let points: Vec<Vec3> = document.floats(accessor, 3).unwrap().chunks(3).map(Vec3::from_slice).collect();
        let joint = document.push("nodes", json!({"name": "joint"}));
        let skin = document.push("skins", json!({"joints": [joint]}));
        let mut nodes = vec![json!(joint)];
        for side in 0..2 {
            let middle = |t: &[u32]| t.iter().map(|&v| points[v as usize].x).sum::<f32>() > 0.0;
            let own: Vec<u32> =
                indices.chunks(3).filter(|t| usize::from(middle(t)) == side).flatten().copied().collect();
            let moved: Vec<u8> = points
                .iter()
                .flat_map(|p| (*p + Vec3::X * gap * side as f32).to_array())
                .flat_map(f32::to_le_bytes)
                .collect();
            let view = document.push_view(&moved, Some(34962));
            let n = points.len();
            let low = points.iter().copied().reduce(Vec3::min).unwrap().to_array();
            let high = (points.iter().copied().reduce(Vec3::max).unwrap() + Vec3::X * gap).to_array();
            let position = document.push(
                "accessors",
                json!({"bufferView": view, "componentType": 5126, "count": n, "type": "VEC3", "min": low, "max": high}),
            );
            let bytes: Vec<u8> = own.iter().copied().flat_map(u32::to_le_bytes).collect();
            let view = document.push_view(&bytes, Some(34963));
            let indices = document.push(
                "accessors",
                json!({"bufferView": view, "componentType": 5125, "count": own.len(), "type": "SCALAR"}),
            );
            let view = document.push_view(&vec![0; 4 * n], Some(34962));
            let joints = document
                .push("accessors", json!({"bufferView": view, "componentType": 5121, "count": n, "type": "VEC4"}));
            let weights: Vec<u8> = [1.0_f32, 0.0, 0.0, 0.0].repeat(n).into_iter().flat_map(f32::to_le_bytes).collect();
            let view = document.push_view(&weights, Some(34962));
            let weights = document
                .push("accessors", json!({"bufferView": view, "componentType": 5126, "count": n, "type": "VEC4"}));
            let attributes = json!({"POSITION": position, "JOINTS_0": joints, "WEIGHTS_0": weights});
            let mesh = json!({"primitives": [{"attributes": attributes, "indices": indices, "material": 0}]});
            let mesh = document.push("meshes", mesh);
            let node = if skeleton { json!({"mesh": mesh, "skin": skin}) } else { json!({"mesh": mesh}) };
            nodes.push(document.push("nodes", node).into());
        }
        document.json["scenes"][0]["nodes"] = json!(nodes);
        let path = write(&document, folder.path(), "halves.glb");
        let grown = grown(&path, &thin(&[]));
        let mesh = grown.scene().skin;
        let mut parts_at: BTreeMap<u32, usize> = BTreeMap::new();
        mesh.position_class.iter().for_each(|&class| *parts_at.entry(class).or_default() += 1);
        parts_at.values().filter(|&&n| n > 1).count()
    };
    let joined = split(true, 0.0);
    assert!(joined > 3, "{joined} places are shared");
    assert_eq!(split(true, 2e-6), joined, "they touch within a thousandth of the hair");
    assert_eq!(split(true, 1e-2), 0, "a centimetre apart");
    assert_eq!(split(false, 0.0), 0, "what may move apart stays apart");
}

#[test]
fn every_node_of_a_mesh_shows_its_fur() {
    let folder = tempfile::tempdir().unwrap();
    let Some(shared) = shared() else { return };
    for name in ["one_mesh_two_skins.glb", "mesh_skinned_and_static.glb"] {
        let path = shared.join("wild").join(name);
        let preset = thin(&[]);
        let (asset, coat) = baked(&path, &folder.path().join("out.glb"), &preset, Method::Lapped);
        let textures = furrier::viewer::stage::textures(&asset, &coat).unwrap();
        let list = furrier::viewer::stage::scene(&asset, &coat, &textures, &asset.rest_pose().unwrap());
        assert_eq!(list.furs.len(), 2, "{name}");
        // The second stands 1.2 m beside the first.
        let beside = |fur: &furrier::runtime::CoatMesh<'_>| {
            fur.positions_m.iter().map(|p| p.x).sum::<f32>() / fur.positions_m.len() as f32
        };
        let apart = (beside(&list.furs[0]) - beside(&list.furs[1])).abs();
        assert!((apart - 1.2).abs() < 1e-3, "{name}: {apart}");
        let grown = grown(&path, &preset);
        let strands = grown.scene().guard.unwrap().0;
        let sides = [false, true].map(|right| strands.points_m.iter().filter(|p| (p.x.abs() > 0.6) == right).count());
        assert_eq!(sides[0], sides[1], "{name}: as many hairs on both");
        assert!(sides[0] > 1000, "{name}");
    }
}
