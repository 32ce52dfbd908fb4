//! Partings: hair falls away on both sides, none grows in the strip between, and none is lost.

use crate::meshes;
use furrier::data::fields::Fields;
use furrier::data::mesh::Mesh;
use furrier::data::parting::Parting;
use furrier::data::strands::Strands;
use furrier::fur::field::{FieldSource, directions};
use furrier::fur::groom::fibre::Fibre;
use furrier::fur::groom::{Colour, Guard, parted};
use furrier::fur::grow::skin::grow;
use furrier::math::Vec3;

const EDGE_M: f32 = 0.1;

/// Along the middle of the square, off the mesh's own lines and a little above it.
fn parting(width_m: f32) -> Parting {
    let line_m = [0.13, 0.5, 0.87].map(|y| Vec3::new(0.487, y, 0.02) * EDGE_M).to_vec();
    Parting { line_m, reach_m: 0.03, width_m, angle_rad: 0.0 }
}

/// A square of upright hair combed by `partings`.
fn square(cells: u32, partings: Vec<Parting>) -> (Mesh, Fields) {
    let mesh = meshes::plane(cells, EDGE_M);
    let comb = directions(&mesh, &[FieldSource::Partings(partings.clone()), FieldSource::Gravity]).unwrap();
    let n = mesh.positions_m.len();
    let mut fields = Fields {
        length: vec![1.0; n],
        density: vec![1.0; n],
        lean: comb.direction.iter().map(|d| (*d + Vec3::Z).normalize()).collect(),
        direction: comb.direction,
        clump: vec![0.0; n],
        tint: vec![Vec3::ONE; n],
        paint: None,
        partings: Vec::new(),
    };
    parted::part(&mesh, partings, 0.0, &mut fields);
    (mesh, fields)
}

fn hair(mesh: &Mesh, fields: &Fields) -> Strands {
    let guard = Guard { density_per_cm2: 200.0, ..Guard::default() };
    grow(&Fibre::guard(&guard, &Colour::default(), 1.0), mesh, fields, 7)
}

/// Roots whose distance from the line is in a range, beside it and away from its ends.
fn count(strands: &Strands, range_m: std::ops::Range<f32>) -> usize {
    let beside = |root: Vec3| (0.02..0.08).contains(&root.y) && range_m.contains(&(root.x - 0.487 * EDGE_M).abs());
    (0..strands.len()).filter(|&i| beside(strands.points_of_m(i)[0])).count()
}

#[test]
fn hair_falls_away_on_both_sides() {
    let (mesh, fields) = square(20, vec![parting(0.004)]);
    let mut sides = [0, 0];
    for (p, d) in mesh.positions_m.iter().zip(&fields.direction) {
        let off = p.x - 0.487 * EDGE_M;
        if off.abs() < 0.029 && (0.014..0.086).contains(&p.y) {
            assert!(d.x * off.signum() > 0.999, "at {p}: {d}");
            sides[usize::from(off > 0.0)] += 1;
        }
        // Beyond its ends a parting says nothing.
        if p.y < 0.012 || p.y > 0.088 {
            assert!(d.y < -0.5, "at {p}: {d}");
        }
    }
    assert!(sides.iter().all(|&n| n > 50), "{sides:?}");
    // Half turned to the line, it lies between both.
    let turned = Parting { angle_rad: std::f32::consts::FRAC_PI_4, ..parting(0.004) };
    let (mesh, fields) = square(20, vec![turned]);
    let beside = mesh.positions_m.iter().position(|p| p.distance(Vec3::new(0.06, 0.05, 0.0)) < 1e-4).unwrap();
    assert!(fields.direction[beside].distance(Vec3::new(0.5, 0.5, 0.0).normalize()) < 1e-3);
}

#[test]
fn hair_at_the_line_stands_up() {
    let (mesh, flat) = square(20, vec![parting(0.0)]);
    let mut fields = flat.clone();
    parted::part(&mesh, vec![parting(0.0)], 0.01, &mut fields);
    for (v, p) in mesh.positions_m.iter().enumerate().filter(|(_, p)| (0.014..0.086).contains(&p.y)) {
        let off = (p.x - 0.487 * EDGE_M).abs();
        match off {
            0.0..0.004 => assert!(fields.lean[v].z > 0.85, "{p}: {}", fields.lean[v]),
            0.011.. => assert_eq!(fields.lean[v], flat.lean[v]),
            _ => {}
        }
    }
}

#[test]
fn strips_are_bare_and_their_hair_stands_beside_them() {
    let width_m = 0.004;
    // Triangles from a sixth of the strip's width to three times as wide.
    for cells in [8, 25, 160] {
        let (mesh, fields) = square(cells, vec![parting(width_m)]);
        let (plain_mesh, plain_fields) = square(cells, Vec::new());
        let (parted, plain) = (hair(&mesh, &fields), hair(&plain_mesh, &plain_fields));
        let off = parted.len() as f32 / plain.len() as f32 - 1.0;
        assert!(off.abs() < 0.01, "{cells} cells: {off} of all hair more");
        assert_eq!(count(&parted, 0.0..0.499 * width_m), 0, "{cells} cells");
        let wide = 4.0 * EDGE_M / cells as f32 + width_m;
        let off = count(&parted, 0.0..wide) as f32 / count(&plain, 0.0..wide) as f32 - 1.0;
        assert!(off.abs() < 0.05, "{cells} cells: {off} of the hair near the strip more");
        assert!(parted.roots.is_sorted_by_key(|root| root.triangle), "{cells} cells");
    }
}

#[test]
fn coats_are_as_dense_in_all() {
    let mean = |cells: u32, width_m: f32| {
        let (mesh, fields) = square(cells, vec![parting(width_m)]);
        let on = |t: usize| mesh.triangles[t].map(|v| fields.density[v as usize]).iter().sum::<f32>() / 3.0;
        let all: f32 = (0..mesh.triangles.len()).map(|t| on(t) * mesh.area_m2(t)).sum();
        (all / (EDGE_M * EDGE_M), fields.density.iter().copied().fold(1.0, f32::min))
    };
    for (cells, bare) in [(8, 0.97), (40, 0.5), (200, 0.02)] {
        let (all, least) = mean(cells, 0.004);
        println!("{cells} cells: {all:.4} of the hair, {least:.3} at the line");
        assert!((all - 1.0).abs() < 0.01, "{cells} cells: {all} of the hair");
        assert!(least <= bare, "{cells} cells: {least} at the line");
    }
    assert!(square(40, vec![parting(0.0)]).1.density.iter().all(|d| *d == 1.0), "no strip, no change");
}

#[test]
fn roots_stay_where_they_are_when_the_skin_is_posed() {
    let (mesh, fields) = square(25, vec![parting(0.004)]);
    let rest = hair(&mesh, &fields);
    let mut posed = mesh.clone();
    posed.rest_m = Some(mesh.positions_m.clone());
    posed.positions_m.iter_mut().for_each(|p| *p = Vec3::new(p.z, 2.0 * p.x, p.y));
    assert_eq!(rest.roots, hair(&posed, &fields).roots);
}
