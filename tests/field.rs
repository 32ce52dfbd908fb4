//! The comb: what is said is kept, what is not is smooth, and its singular points add up.

use crate::meshes;
use furrier::data::mesh::Mesh;
use furrier::fur::field::{DirectionField, FieldSource, Whorl, directions};
use furrier::math::Vec3;

fn index_sum(field: &DirectionField) -> i32 {
    field.singularities.iter().map(|s| s.index).sum()
}

fn sound(mesh: &Mesh, field: &DirectionField) {
    for (v, (d, n)) in field.direction.iter().zip(mesh.smooth_normals()).enumerate() {
        assert!((d.length() - 1.0).abs() < 1e-4, "vertex {v}: {d}");
        assert!(d.dot(n).abs() < 1e-3, "vertex {v}: {d} is not tangent");
    }
}

#[test]
fn indices_add_up_to_the_euler_characteristic() {
    for (mesh, euler) in [(meshes::sphere(12, 1.0), 2), (meshes::torus(16, [1.0, 0.4]), 0)] {
        for sources in [vec![], vec![FieldSource::Gravity], vec![FieldSource::Tailward { sag: 0.3 }]] {
            let field = directions(&mesh, &sources).expect("a field");
            sound(&mesh, &field);
            assert_eq!(index_sum(&field), euler, "{sources:?}: {:?}", field.singularities);
        }
    }
}

#[test]
fn gravity_on_a_sphere_is_singular_at_its_poles_only() {
    let mesh = meshes::sphere(16, 1.0);
    let field = directions(&mesh, &[FieldSource::Gravity]).expect("a field");
    assert_eq!(field.singularities.len(), 2, "{:?}", field.singularities);
    for singularity in &field.singularities {
        assert!(singularity.position_m.y.abs() > 0.95, "{singularity:?}");
    }
    let wrong = mesh.positions_m.iter().zip(&field.direction).filter(|(p, d)| p.y.abs() < 0.8 && d.y > -0.5).count();
    assert_eq!(wrong, 0);
}

#[test]
fn unknown_parts_continue_the_known_ones() {
    // A cylinder combed along its axis at one end and around it at the other: in between the field turns evenly.
    let mesh = meshes::grid(32, 40, [true, false], |u, v| {
        let a = u * std::f32::consts::TAU;
        Vec3::new(a.cos(), 4.0 * v, -a.sin())
    });
    let known = mesh.positions_m.iter().map(|p| {
        if p.y < 0.01 {
            Vec3::Y
        } else if p.y > 3.99 {
            Vec3::Y.cross(Vec3::new(p.x, 0.0, p.z))
        } else {
            Vec3::ZERO
        }
    });
    let field = directions(&mesh, &[FieldSource::Vertices(known.collect())]).expect("a field");
    sound(&mesh, &field);
    assert!(field.singularities.is_empty(), "{:?}", field.singularities);
    assert_eq!(field.filled, 39 * 32);
    for (p, d) in mesh.positions_m.iter().zip(&field.direction) {
        let expected = p.y / 4.0 * std::f32::consts::FRAC_PI_2;
        let found = d.dot(Vec3::Y).acos();
        // Between two unit vectors the smooth solution runs along their chord, at most 4.1° off an even turn.
        assert!((found - expected).abs() < 0.08, "at {p}: {found} for {expected}");
    }
}

#[test]
fn whorls_turn_and_strokes_comb() {
    let mesh = meshes::plane(40, 1.0);
    let whorl = Whorl { centre_m: Vec3::new(0.26, 0.51, 0.0), reach_m: 0.15, spin_rad: std::f32::consts::FRAC_PI_2 };
    let stroke = vec![Vec3::new(0.7, 0.1, 0.0), Vec3::new(0.7, 0.9, 0.0)];
    let sources = [FieldSource::Whorls(vec![whorl]), FieldSource::Strokes { lines_m: vec![stroke], reach_m: 0.1 }];
    let field = directions(&mesh, &sources).expect("a field");
    sound(&mesh, &field);
    for (p, d) in mesh.positions_m.iter().zip(&field.direction) {
        let out = *p - whorl.centre_m;
        if out.length() < 0.14 {
            assert!((d.cross(out.normalize()).z + 1.0).abs() < 1e-3, "a ring, counter-clockwise: {p} {d}");
        }
        if (p.x - 0.7).abs() < 0.09 && (0.1..0.9).contains(&p.y) {
            assert!(d.y > 0.999, "along the stroke: {p} {d}");
        }
    }
    assert!(field.singularities.iter().any(|s| s.index == 1 && s.position_m.distance(whorl.centre_m) < 0.03));
}

#[test]
fn one_sided_surfaces_and_lone_parts_have_a_comb() {
    let band = meshes::moebius(60);
    let field = directions(&band, &[FieldSource::Gravity]).expect("a field");
    assert!(field.direction.iter().all(|d| (d.length() - 1.0).abs() < 1e-4));
    let flat = meshes::grid(3, 3, [false; 2], |u, v| Vec3::new(u, 0.0, -v));
    let field = directions(&flat, &[]).expect("a field");
    assert!(field.direction.iter().all(|d| d.z < -0.99), "a level part is combed to the tail: {:?}", field.direction);
}

#[test]
fn broken_sources_are_named() {
    let mesh = meshes::plane(2, 1.0);
    for source in [
        FieldSource::Vertices(vec![Vec3::X]),
        FieldSource::Vertices(vec![Vec3::NAN; 9]),
        FieldSource::Tailward { sag: f32::INFINITY },
        FieldSource::Strokes { lines_m: vec![], reach_m: 0.0 },
    ] {
        let error = directions(&mesh, &[FieldSource::Gravity, source]).expect_err("nonsense");
        assert_eq!(error.field.as_deref(), Some("field[1]"));
    }
}
