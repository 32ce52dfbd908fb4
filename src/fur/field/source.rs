//! What each source wishes at each vertex.

use super::smooth::{Hold, Wish};
use super::{FieldSource, Whorl};
use crate::data::mesh::Mesh;
use crate::data::parting::Parting;
use crate::math::Vec3;

/// A projected direction shorter than this share of its length says nothing about the tangent plane.
const FLAT: f32 = 1e-3;

/// The wish of the first source that has one, per vertex; all vertices of a place share the first one's.
pub(super) fn wishes(mesh: &Mesh, normals: &[Vec3], sources: &[FieldSource]) -> Vec<Wish> {
    let wish =
        |v: usize| sources.iter().map(|source| one(mesh, normals, source, v)).find(|w| !matches!(w.hold, Hold::Free));
    let mut all: Vec<Wish> = (0..normals.len()).map(|v| wish(v).unwrap_or_default()).collect();
    for v in 0..all.len() {
        let class = mesh.position_class[v] as usize;
        if matches!(all[class].hold, Hold::Free) {
            all[class] = all[v];
        }
    }
    mesh.position_class.iter().map(|&class| all[class as usize]).collect()
}

fn one(mesh: &Mesh, normals: &[Vec3], source: &FieldSource, v: usize) -> Wish {
    let (p, n) = (mesh.positions_m[v], normals[v]);
    match source {
        FieldSource::Vertices(directions) => kept(directions[v], n),
        FieldSource::Gravity => leaning(Vec3::NEG_Y, n),
        FieldSource::Tailward { sag } => leaning(Vec3::new(0.0, -sag, -1.0), n),
        FieldSource::Whorls(whorls) => {
            let nearest =
                whorls.iter().map(|w| (p.distance(w.centre_m) / w.reach_m, w)).min_by(|a, b| a.0.total_cmp(&b.0));
            match nearest {
                Some((share, whorl)) if share < 1.0 => turning(whorl, p, n),
                _ => Wish::default(),
            }
        }
        FieldSource::Strokes { lines_m, reach_m } => {
            let near = |ends: &&[Vec3]| distance(p, ends[0], ends[1]) < *reach_m;
            let segments = lines_m.iter().flat_map(|line| line.windows(2)).filter(near);
            match segments.min_by(|a, b| distance(p, a[0], a[1]).total_cmp(&distance(p, b[0], b[1]))) {
                Some(ends) => kept(ends[1] - ends[0], n),
                None => Wish::default(),
            }
        }
        FieldSource::Partings(partings) => {
            partings.iter().map(|parting| falling(parting, p, n)).find(|w| w.hold == Hold::Kept).unwrap_or_default()
        }
    }
}

/// `direction` turned into the tangent plane and kept, where that leaves anything of it.
fn kept(direction: Vec3, n: Vec3) -> Wish {
    let flat = direction - n * n.dot(direction);
    if flat.length() > FLAT * direction.length() {
        Wish { direction: flat.normalize(), hold: Hold::Kept }
    } else {
        Wish::default()
    }
}

/// `direction` as a leaning that counts the less the steeper it meets the skin: on top of a back, gravity has little
/// to say.
fn leaning(direction: Vec3, n: Vec3) -> Wish {
    let d = direction.normalize_or_zero();
    let flat = d - n * n.dot(d);
    let strength = flat.length_squared();
    if strength > FLAT * FLAT {
        Wish { direction: flat.normalize(), hold: Hold::Leaning(strength) }
    } else {
        Wish::default()
    }
}

fn turning(whorl: &Whorl, p: Vec3, n: Vec3) -> Wish {
    let out = p - whorl.centre_m;
    let (sin, cos) = (libm::sinf(whorl.spin_rad), libm::cosf(whorl.spin_rad));
    kept(out * cos + n.cross(out) * sin, n)
}

/// Away from the line, or by an angle along it; nothing on the line itself.
fn falling(parting: &Parting, p: Vec3, n: Vec3) -> Wish {
    let Some(aside) = parting.aside(p, n) else { return Wish::default() };
    let Some(off) = aside.off_m.try_normalize() else { return Wish::default() };
    let (sin, cos) = libm::sincosf(parting.angle_rad);
    kept(off * cos + aside.along * sin, n)
}

/// Distance of `p` to a polyline, or to its one point; infinite for none.
pub fn distance_to_line(p: Vec3, line: &[Vec3]) -> f32 {
    match line {
        [only] => p.distance(*only),
        _ => line.windows(2).map(|ends| distance(p, ends[0], ends[1])).fold(f32::INFINITY, f32::min),
    }
}

fn distance(p: Vec3, a: Vec3, b: Vec3) -> f32 {
    let along = b - a;
    let t = (p - a).dot(along) / along.length_squared().max(f32::MIN_POSITIVE);
    p.distance(a + along * t.clamp(0.0, 1.0))
}
