//! What partings do to the density of a coat: bare strips, with their hair beside them.

use crate::data::fields::Fields;
use crate::data::mesh::Mesh;
use crate::data::parting::Parting;
use crate::math::{Vec3, sampling};
use std::sync::Arc;

/// Places looked at in a triangle that a parting reaches.
const PLACES: u64 = 256;
/// How much of its lean hair has at the line.
const LEAST_LEAN: f32 = 0.25;
/// Hair that each corner of a triangle stands for where no parting is, over the triangle's.
const THIRD: f32 = 1.0 / 3.0;

/// Enters `partings` into the fields of `mesh` in its rest pose. The density at a vertex is the mean around it, each place
/// counted as much as the vertex counts there: a strip narrower than triangles thins the vertices beside it, and as much
/// hair stays in all. Leans grow from the line outwards over `height_m`, the hair's height.
pub fn part(mesh: &Mesh, partings: Vec<Parting>, height_m: f32, fields: &mut Fields) {
    raise(mesh, &partings, height_m, fields);
    if partings.iter().any(|parting| parting.width_m > 0.0) {
        let factors = factors(mesh, &partings);
        fields.density.iter_mut().zip(&mesh.position_class).for_each(|(d, &class)| *d *= factors[class as usize]);
        if let Some(paint) = fields.paint.as_mut().map(Arc::make_mut) {
            paint.density.iter_mut().zip(&mesh.position_class).for_each(|(d, &class)| *d *= factors[class as usize]);
        }
    }
    fields.partings = partings;
}

/// Turns leans at the line up to the normal: hair on both sides would leave a ditch as wide as it leans.
fn raise(mesh: &Mesh, partings: &[Parting], height_m: f32, fields: &mut Fields) {
    if partings.is_empty() {
        return;
    }
    for (v, normal) in mesh.smooth_normals().into_iter().enumerate() {
        let asides = partings.iter().filter_map(|parting| parting.aside(mesh.positions_m[v], normal));
        let off_m = asides.map(|aside| aside.off_m.length()).fold(f32::INFINITY, f32::min);
        if off_m < height_m {
            let share = LEAST_LEAN + (1.0 - LEAST_LEAN) * off_m / height_m;
            fields.lean[v] = normal.lerp(fields.lean[v], share).normalize_or(normal);
        }
    }
}

/// Factor on density per place.
fn factors(mesh: &Mesh, partings: &[Parting]) -> Vec<f32> {
    let normals = mesh.smooth_normals();
    let mut sums = vec![(0.0, 0.0); mesh.positions_m.len()];
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        let corners_m = mesh.corners_m(t);
        let area_m2 = mesh.area_m2(t);
        let near: Vec<&Parting> = partings.iter().filter(|parting| reaches(parting, corners_m)).collect();
        let share = if near.is_empty() {
            Vec3::splat(THIRD)
        } else {
            share(&near, corners_m, triangle.map(|v| normals[v as usize]))
        };
        for (&v, share) in triangle.iter().zip(share.to_array()) {
            let sum = &mut sums[mesh.position_class[v as usize] as usize];
            sum.0 += area_m2 * share;
            sum.1 += area_m2 * THIRD;
        }
    }
    sums.into_iter().map(|(parted, all)| if all > 0.0 { parted / all } else { 1.0 }).collect()
}

/// Hair that each corner of a triangle stands for, over all that the triangle has without partings.
fn share(partings: &[&Parting], corners_m: [Vec3; 3], normals: [Vec3; 3]) -> Vec3 {
    let at = |i: u64| {
        let b = sampling::square_to_triangle(sampling::r2(i, 0));
        let mix = |of: [Vec3; 3]| of[0] * b.x + of[1] * b.y + of[2] * b.z;
        let (p_m, normal) = (mix(corners_m), mix(normals).normalize_or_zero());
        b * partings.iter().map(|parting| parting.density(p_m, normal)).product::<f32>()
    };
    // Over the mean of the places' own coordinates, which is nearly a third each.
    let mean = (0..PLACES).map(|i| sampling::square_to_triangle(sampling::r2(i, 0))).sum::<Vec3>();
    (0..PLACES).map(at).sum::<Vec3>() / (3.0 * mean)
}

/// Whether a parting may reach into a triangle.
fn reaches(parting: &Parting, corners_m: [Vec3; 3]) -> bool {
    let [p, q, r] = corners_m;
    let longest_m = p.distance(q).max(q.distance(r)).max(r.distance(p));
    let reach_m = parting.reach_m + longest_m;
    let low = parting.line_m.iter().fold(Vec3::INFINITY, |low, &at| low.min(at)) - reach_m;
    let high = parting.line_m.iter().fold(Vec3::NEG_INFINITY, |high, &at| high.max(at)) + reach_m;
    p.cmpge(low).all() && p.cmple(high).all()
}
