//! Where an animated, skinned or morphed part is, against plain formulas.

use furrier::asset::{self, Asset};
use furrier::math::{DMat4, DQuat, DVec3, Mat3, Vec3};
use serde_json::json;

fn plane() -> Asset {
    asset::load("sample:plane").expect("a sample")
}

/// `sample:plane` with one animation channel on its node.
pub fn animated(path: &str, width: usize, interpolation: &str, times: &[f32], values: &[f32]) -> Asset {
    let mut document = plane().document;
    let floats = |document: &mut asset::Document, values: &[f32], kind: &str| {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        let view = document.push_view(&bytes, None);
        let count = values.len() / if kind == "SCALAR" { 1 } else { width };
        document.push("accessors", json!({"bufferView": view, "componentType": 5126, "count": count, "type": kind}))
    };
    let input = floats(&mut document, times, "SCALAR");
    let kind = ["", "SCALAR", "", "VEC3", "VEC4"][width];
    let output = floats(&mut document, values, kind);
    let sampler = json!({"input": input, "output": output, "interpolation": interpolation});
    let channel = json!({"sampler": 0, "target": {"node": 0, "path": path}});
    document.push("animations", json!({"name": "move", "samplers": [sampler], "channels": [channel]}));
    Asset::new(document, Vec::new()).expect("a sound document")
}

fn translation(asset: &Asset, seconds: f64) -> DVec3 {
    let animation = asset.animation("move").expect("it is there");
    asset.pose(animation, seconds).expect("a pose").world[0].w_axis.truncate()
}

#[test]
fn keys_are_interpolated_as_the_format_says() {
    let (times, values) = ([1.0, 2.0, 4.0], [0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 5.0, 6.0, 7.0]);
    let linear = animated("translation", 3, "LINEAR", &times, &values);
    let step = animated("translation", 3, "STEP", &times, &values);
    for (seconds, at, stepped) in [
        (0.0, [0.0; 3], [0.0; 3]),
        (1.5, [0.5, 1.0, 1.5], [0.0; 3]),
        (2.0, [1.0, 2.0, 3.0], [1.0, 2.0, 3.0]),
        (3.0, [3.0, 4.0, 5.0], [1.0, 2.0, 3.0]),
        (9.0, [5.0, 6.0, 7.0], [5.0, 6.0, 7.0]),
    ] {
        assert!((translation(&linear, seconds) - DVec3::from_array(at)).length() < 1e-6, "linear at {seconds} s");
        assert!((translation(&step, seconds) - DVec3::from_array(stepped)).length() < 1e-6, "step at {seconds} s");
    }
    // x = t³ from its values and slopes at 0 and 2 is t³ in between too.
    let spline = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 12.0, 0.0, 0.0, 8.0, 0.0, 0.0, 12.0, 0.0, 0.0];
    let cubic = animated("translation", 3, "CUBICSPLINE", &[0.0, 2.0], &spline);
    for seconds in [0.0, 0.3, 1.0, 1.7, 2.0] {
        let x = translation(&cubic, seconds).x;
        assert!((x - seconds.powi(3)).abs() < 1e-6, "{x} at {seconds} s");
        assert!((x - seconds.powi(2)).abs() > 1e-3 || seconds < 0.1 || seconds == 1.0, "another power would show");
    }
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let turning = animated("rotation", 4, "LINEAR", &[0.0, 1.0], &[0.0, 0.0, 0.0, 1.0, 0.0, half, 0.0, half]);
    let matrix = turning.pose(0, 1.0 / 3.0).expect("a pose").world[0];
    let expected = DMat4::from_rotation_y(std::f64::consts::FRAC_PI_6);
    assert!(matrix.abs_diff_eq(expected, 1e-6), "a third of a quarter turn is 30°");
}

#[test]
fn animations_are_found_by_name_or_number() {
    let asset = asset::load("sample:creature").expect("a sample");
    assert_eq!(asset.animation("walk").expect("by name"), asset.animation("0").expect("by number"));
    let error = asset.animation("fly").expect_err("it does not fly");
    assert!(error.expected.is_some_and(|text| text.contains("walk")));
}

#[test]
fn the_rest_pose_is_the_mesh() {
    for name in ["creature", "torus"] {
        let asset = asset::load(&format!("sample:{name}")).expect("a sample");
        let pose = asset.rest_pose().expect("a pose");
        for part in &asset.parts {
            let (mesh, posed) = (part.mesh(0.5).expect("a mesh"), part.posed(&asset, &pose, part.nodes[0], 0.5));
            assert_eq!(mesh.positions_m, posed.positions_m);
            let apart = mesh.normals.iter().zip(&posed.normals).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
            assert!(apart < 1e-5, "{apart}");
        }
    }
}

#[test]
fn a_vertex_on_one_joint_goes_where_the_joint_takes_it() {
    let asset = asset::load("sample:creature").expect("a sample");
    let seconds = 0.25;
    let pose = asset.pose(0, seconds).expect("a pose");
    // The head's place by its own chain of parents, straight from the file.
    let nodes = asset.document.json["nodes"].as_array().expect("nodes");
    let number = |name: &str| nodes.iter().position(|n| n["name"] == name).expect("a joint");
    let rest = |name: &str| {
        let t: Vec<f64> =
            nodes[number(name)]["translation"].as_array().expect("three").iter().filter_map(|c| c.as_f64()).collect();
        DVec3::from_slice(&t)
    };
    // At a quarter second: sin(2π(0.25 − delay)) and, twice as fast, sin(2π(0.5 − delay)), as the walk is defined.
    let wave = |rate: f64, delay: f64| (std::f64::consts::TAU * (rate * seconds - delay)).sin();
    let turns = [
        ("hips", DQuat::from_rotation_z(0.05 * wave(1.0, 0.10)), rest("hips") + DVec3::Y * 0.005 * wave(2.0, 0.2)),
        ("chest", DQuat::from_rotation_y(0.06 * wave(1.0, 0.30)), rest("chest")),
        ("neck", DQuat::from_rotation_x(0.06 * wave(2.0, 0.10)), rest("neck")),
        ("head", DQuat::from_rotation_x(0.03 + 0.07 * wave(2.0, 0.55)), rest("head")),
    ];
    let (mut moved, mut bound) = (DMat4::IDENTITY, DMat4::IDENTITY);
    for (_, turn, place) in turns {
        moved *= DMat4::from_rotation_translation(turn, place);
    }
    for (name, _, _) in turns {
        bound *= DMat4::from_translation(rest(name));
    }
    let eyes = asset.parts.iter().find(|part| part.material_name == "eyes").expect("it has eyes");
    let posed = eyes.posed(&asset, &pose, eyes.nodes[0], 1.0);
    let mut farthest = 0.0_f64;
    for (local, found) in eyes.stored.positions.iter().zip(&posed.positions_m) {
        let expected = (moved * bound.inverse()).transform_point3(local.as_dvec3()) - eyes.centre_units;
        farthest = farthest.max((found.as_dvec3() - expected).length());
        assert!((local.as_dvec3() - eyes.centre_units - expected).length() > 1e-4, "the head does move");
    }
    assert!(farthest < 2e-5, "{farthest} m off");
}

#[test]
fn offsets_turn_with_morphed_normals() {
    let mut document = plane().document;
    let n = plane().parts[0].vertices();
    // Normals go from +Y to +X at weight 1, halfway between at one half.
    let change: Vec<u8> = (0..n).flat_map(|_| [1.0_f32, -1.0, 0.0]).flat_map(f32::to_le_bytes).collect();
    let view = document.push_view(&change, None);
    let accessor =
        document.push("accessors", json!({"bufferView": view, "componentType": 5126, "count": n, "type": "VEC3"}));
    document.json["meshes"][0]["primitives"][0]["targets"] = json!([{"NORMAL": accessor}]);
    for (weight, expected) in [(0.0, Vec3::Y), (0.5, Vec3::new(1.0, 1.0, 0.0).normalize()), (1.0, Vec3::X)] {
        document.json["meshes"][0]["weights"] = json!([weight]);
        let asset = Asset::new(document.clone(), Vec::new()).expect("a sound document");
        let part = &asset.parts[0];
        let posed = part.posed(&asset, &asset.rest_pose().expect("a pose"), 0, 1.0);
        assert!((posed.world_from_offset[7] * Vec3::Y - expected).length() < 1e-5, "weight {weight}");
        assert!((posed.normals[7] - expected).length() < 1e-5, "weight {weight}");
    }
}

#[test]
fn a_local_offset_is_the_world_offset_again() {
    for (scale, rotation) in [([2.0, 0.5, 3.0], [0.0, 0.0, 0.0, 1.0]), ([-1.0, 4.0, 1.0], [0.5, 0.5, 0.5, 0.5])] {
        let mut document = plane().document;
        document.json["nodes"][0]["scale"] = json!(scale);
        document.json["nodes"][0]["rotation"] = json!(rotation);
        // A rotated child of a stretched parent is sheared.
        let parent = document.push("nodes", json!({"scale": [1.0, 2.5, 0.7], "children": [0]}));
        document.json["scenes"][0]["nodes"] = json!([parent]);
        let asset = Asset::new(document, Vec::new()).expect("a sound document");
        let part = &asset.parts[0];
        let offset_m = Vec3::new(0.01, 0.02, -0.03);
        let local = part.local_offset(5, offset_m, 0.1);
        let back = part.world_from_local(5) * local.as_dvec3() * 0.1;
        assert!((back.as_vec3() - offset_m).length() < 1e-7, "{back}");
        let posed = part.posed(&asset, &asset.rest_pose().expect("a pose"), 0, 0.1);
        assert!((posed.world_from_offset[5] * local - offset_m).length() < 1e-7);
        assert!(posed.world_from_offset[5] != Mat3::IDENTITY);
        let mesh = part.mesh(1.0).expect("a mesh");
        let outwards = (0..mesh.triangles.len()).all(|t| mesh.area_vector_m2(t).dot(mesh.normals[0]) > 0.0);
        assert!(outwards, "triangles face where the normals point");
    }
}
