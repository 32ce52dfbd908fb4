//! Hair in creases: combed apart where it would cross, left alone elsewhere.

use crate::pelts;
use furrier::data::mesh::Mesh;
use furrier::fur::groom::unfold::unfold;
use furrier::math::Vec3;
use furrier::render::shell::prism::{Place, Prism};

const HEIGHT_M: f32 = 0.012;

/// Prisms that are turned inside out somewhere.
fn turned(mesh: &Mesh, lean: &[Vec3], length: &[f32]) -> usize {
    let places = |t: f32| [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|b| Place { b, t });
    mesh.triangles
        .iter()
        .filter(|corners| {
            let corners = corners.map(|v| v as usize);
            let prism = Prism {
                foot_m: corners.map(|v| mesh.positions_m[v]),
                offset_m: corners.map(|v| lean[v] * (HEIGHT_M * length[v])),
            };
            [0.0, 0.25, 0.5, 0.75, 1.0].into_iter().flat_map(places).any(|at| prism.jacobian(&at).determinant <= 0.0)
        })
        .count()
}

/// A sheet bent upwards along its middle by a corner whose sides make `degrees` with each other.
fn valley(degrees: f32) -> Mesh {
    let (sin, cos) = (0.5 * degrees.to_radians()).sin_cos();
    pelts::grid(40, 8, |u, v| {
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
        unfold(&mesh, &normals, HEIGHT_M, &mut lean, &mut length);
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
    let mesh = pelts::bent_pelt(1);
    let normals = mesh.smooth_normals();
    let (mut lean, mut length) = (normals.clone(), vec![1.0; normals.len()]);
    unfold(&mesh, &normals, HEIGHT_M, &mut lean, &mut length);
    assert!(lean == normals && length.iter().all(|&l| l == 1.0));
}
