//! Strokes along the hair, the skin coloured by its length, balls where it has no direction.

use super::colours::{CROWN, LENGTHS, SADDLE};
use super::shapes::Shapes;
use super::{CoveredPart, stage};
use crate::data::mesh::Mesh;
use crate::fur::field::singularities;
use crate::math::Vec3;
use crate::math::hash::{combine, unit_f32};
use crate::runtime::{CoatMesh, SkinMesh};
use std::collections::HashMap;

/// Strokes over all of the skin, about.
const STROKES: f32 = 3000.0;
/// Hair that leans less than this share of its length has no direction to show.
const LEANS: f32 = 0.02;
/// Radius of a ball over the asset's size.
const BALL: f32 = 0.009;

/// See [`super::draw`].
pub(super) fn draw<'a>(all: &[CoveredPart<'_>]) -> (Vec<SkinMesh<'a>>, Vec<String>) {
    let furs: Vec<CoatMesh<'_>> = all.iter().map(|covered| stage::fur(covered.posed, covered.primitive)).collect();
    let used = || furs.iter().flat_map(|fur| fur.triangles.iter().flatten().map(move |&v| (fur, v as usize)));
    let lengths = || used().map(|(fur, v)| fur.offsets_m[v].length());
    let (least, most) = (lengths().fold(f32::INFINITY, f32::min), lengths().fold(0.0, f32::max));
    let area: f32 = furs.iter().flat_map(|fur| fur.triangles.iter().map(|t| area_m2(fur, *t))).sum();
    let spacing_m = (area / STROKES).sqrt();
    let low = used().map(|(fur, v)| fur.positions_m[v]).fold(Vec3::INFINITY, Vec3::min);
    let high = used().map(|(fur, v)| fur.positions_m[v]).fold(Vec3::NEG_INFINITY, Vec3::max);
    let radius_m = BALL * (high - low).max(Vec3::ZERO).length();

    let mut skins: Vec<SkinMesh<'a>> = Vec::new();
    let (mut crowns, mut saddles) = (0, 0);
    let mut signs = Shapes::default();
    for (covered, fur) in all.iter().zip(&furs) {
        let shade = |v: usize| {
            let share = (fur.offsets_m[v].length() - least) / (most - least);
            LENGTHS[0].lerp(LENGTHS[1], if most > least * 1.001 { share } else { 0.5 })
        };
        skins.push(SkinMesh {
            positions_m: fur.positions_m.clone(),
            normals: fur.normals.clone(),
            colour: (0..fur.positions_m.len()).map(shade).collect(),
            triangles: fur.triangles.to_vec(),
            ..SkinMesh::default()
        });
        strokes(fur, spacing_m, &mut signs);
        for (position_m, index) in turns(covered, fur) {
            let ball = if index > 0 { &mut crowns } else { &mut saddles };
            *ball += 1;
            signs.ball(position_m, radius_m, if index > 0 { CROWN } else { SADDLE });
        }
    }
    skins.push(signs.0);
    let legend = vec![
        format!("strokes point where the hair goes, wide at the root; {crowns} crowns (red), {saddles} saddles (blue)"),
        if most > least * 1.001 {
            format!("hair is {:.2} mm long on cream skin and {:.2} mm on teal", least * 1e3, most * 1e3)
        } else {
            format!("hair is {:.2} mm long everywhere", most.max(0.0) * 1e3)
        },
    ];
    (skins, legend)
}

fn area_m2(fur: &CoatMesh<'_>, triangle: [u32; 3]) -> f32 {
    let [a, b, c] = triangle.map(|v| fur.positions_m[v as usize]);
    0.5 * (b - a).cross(c - a).length()
}

/// Where the hair's direction along the skin turns round itself, and how often.
fn turns(covered: &CoveredPart<'_>, fur: &CoatMesh<'_>) -> Vec<(Vec3, i32)> {
    let base = |v: u32| covered.primitive.base_vertex[v as usize];
    let mesh = Mesh {
        positions_m: covered.posed.positions_m.clone(),
        normals: covered.posed.normals.clone(),
        triangles: fur.triangles.iter().map(|t| t.map(base)).collect(),
        position_class: covered.part.stored.position_class.clone(),
        ..Mesh::default()
    };
    let normals = mesh.smooth_normals();
    let mut direction = vec![Vec3::ZERO; normals.len()];
    for &v in fur.triangles.iter().flatten() {
        let (offset, class) = (fur.offsets_m[v as usize], mesh.position_class[base(v) as usize] as usize);
        let flat = offset.reject_from_normalized(normals[class]);
        if flat.length() > LEANS * offset.length() {
            direction[class] = flat.normalize();
        }
    }
    singularities(&mesh, &direction).into_iter().map(|s| (s.position_m, s.index)).collect()
}

/// Strokes at even distances: points thrown by chance, those too near an earlier one left out.
fn strokes(fur: &CoatMesh<'_>, spacing_m: f32, shapes: &mut Shapes) {
    let cell = |p: Vec3| (p / spacing_m).floor().as_ivec3().to_array();
    let mut taken: HashMap<[i32; 3], Vec<Vec3>> = HashMap::new();
    let mut throws = Vec::new();
    for (t, &triangle) in fur.triangles.iter().enumerate() {
        let wanted = 8.0 * area_m2(fur, triangle) / (spacing_m * spacing_m);
        let chance = combine(0xf1e1d, t as u64);
        let count = wanted as u64 + u64::from(unit_f32(combine(chance, 0)) < wanted.fract());
        throws.extend((1..=count).map(|i| (combine(chance, i), triangle)));
    }
    throws.sort_unstable();
    for (chance, triangle) in throws {
        let (mut a, mut b) = (unit_f32(combine(chance, 1)), unit_f32(combine(chance, 2)));
        if a + b > 1.0 {
            (a, b) = (1.0 - a, 1.0 - b);
        }
        let at = |list: &[Vec3]| {
            let [p, q, r] = triangle.map(|v| list[v as usize]);
            p + (q - p) * a + (r - p) * b
        };
        let (p, normal, offset) = (at(&fur.positions_m), at(&fur.normals).normalize_or(Vec3::Y), at(&fur.offsets_m));
        let flat = offset.reject_from_normalized(normal);
        let [x, y, z] = cell(p);
        let near = (0..27).any(|i| {
            let home = [x + i % 3 - 1, y + i / 3 % 3 - 1, z + i / 9 - 1];
            taken.get(&home).is_some_and(|all| all.iter().any(|q| q.distance(p) < 0.8 * spacing_m))
        });
        if near || flat.length() <= LEANS * offset.length() {
            continue;
        }
        taken.entry([x, y, z]).or_default().push(p);
        shapes.stroke(p, normal, flat.normalize(), spacing_m);
    }
}
