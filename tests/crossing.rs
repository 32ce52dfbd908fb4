//! Hair in creases: combed apart where it would cross, left alone elsewhere.

use crate::scenes;
use furrier::data::mesh::Mesh;
use furrier::fur::groom::lean::Standing;
use furrier::fur::groom::unfold::unfold;
use furrier::math::Vec3;
use furrier::volume::shell::prism::{Prism, ShellPoint};

const HEIGHT_M: f32 = 0.012;

/// Prisms that are turned inside out somewhere.
fn turned(mesh: &Mesh, lean: &[Vec3], length: &[f32]) -> usize {
    let points = |t: f32| [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|b| ShellPoint { b, t });
    mesh.triangles
        .iter()
        .filter(|corners| {
            let corners = corners.map(|v| v as usize);
            let prism = Prism {
                foot_m: corners.map(|v| mesh.positions_m[v]),
                offset_m: corners.map(|v| lean[v] * (HEIGHT_M * length[v])),
            };
            [0.0, 0.25, 0.5, 0.75, 1.0].into_iter().flat_map(points).any(|at| prism.jacobian(&at).determinant <= 0.0)
        })
        .count()
}

/// A sheet bent upwards along its middle by a corner whose sides make `degrees` with each other.
fn valley(degrees: f32) -> Mesh {
    let (sin, cos) = (0.5 * degrees.to_radians()).sin_cos();
    scenes::grid(40, 8, |u, v| {
        let across = (u - 0.5) * 0.1;
        Vec3::new(across * sin, across.abs() * cos, (0.5 - v) * 0.02)
    })
}

#[test]
fn hair_in_a_crease_is_combed_apart() {
    for (degrees, least) in [(150.0, 0.5), (90.0, 0.5), (60.0, 0.15)] {
        let mesh = valley(degrees);
        let normals = mesh.smooth_normals();
        let (mut lean, mut length) = (normals.clone(), vec![1.0; normals.len()]);
        assert!(turned(&mesh, &lean, &length) > 10, "{degrees}: nothing to comb");
        unfold(&mesh, &Standing::new(&mesh), HEIGHT_M, &mut lean, &mut length);
        assert_eq!(turned(&mesh, &lean, &length), 0, "{degrees}");
        let shortest = length.iter().copied().fold(1.0, f32::min);
        assert!(shortest > least, "{degrees}: {shortest}");
        for (v, p) in mesh.positions_m.iter().enumerate() {
            assert!((lean[v].length() - 1.0).abs() < 1e-5 && lean[v].dot(normals[v]) > 0.16, "{degrees}: {}", lean[v]);
            assert!(p.x.abs() < 2.5 * HEIGHT_M || lean[v] == normals[v], "{degrees}: far from the crease, {p}");
        }
    }
}

#[test]
fn hair_that_does_not_cross_is_left_alone() {
    let mesh = scenes::bent_skin(1);
    let normals = mesh.smooth_normals();
    let (mut lean, mut length) = (normals.clone(), vec![1.0; normals.len()]);
    unfold(&mesh, &Standing::new(&mesh), HEIGHT_M, &mut lean, &mut length);
    assert!(lean == normals && length.iter().all(|&l| l == 1.0));
}

#[test]
fn rays_over_a_border_start_on_the_prisms_curved_side() {
    // Hair turns aside along the edge from corner 1 to corner 2, as on the rim of a brim.
    let prism = Prism {
        foot_m: [Vec3::ZERO, Vec3::new(0.005, 0.0, -0.002), Vec3::new(0.005, 0.0, 0.003)],
        offset_m: [Vec3::Y, Vec3::new(0.1, 0.9, 0.4), Vec3::new(-0.2, 0.8, 0.5)].map(|o| o * HEIGHT_M),
    };
    let middle = ShellPoint { b: [0.5, 0.5], t: 0.5 };
    // Half-way from the foot of one corner to the tip of the other: on both flat halves of the wall.
    let flat_m = (prism.foot_m[1] + prism.foot_m[2] + prism.offset_m[2]) * 0.5;
    let off = prism.locate(flat_m, middle).unwrap().barycentric()[0];
    assert!(off.abs() > 0.05, "the wall is flat: {off}");
    for direction in [Vec3::NEG_X, Vec3::new(-1.0, -0.5, 0.2), Vec3::new(0.6, 0.1, 0.3)].map(Vec3::normalize) {
        let on_m = prism.to_side_m(0, flat_m, direction, middle);
        let off = prism.locate(flat_m + direction * on_m, middle).unwrap().barycentric()[0];
        assert!(off.abs() < 1e-4, "along {direction}: {off}");
    }
    // A ray that only grazes the side goes no farther than there is hair.
    assert!(prism.to_side_m(0, flat_m, Vec3::Z, middle).abs() < HEIGHT_M);
}
