//! Faults of vertex data that can be mended or lived with, each said once with its count.

use super::primitive::Primitive;
use crate::math::{DVec3, Vec3};
use std::collections::HashMap;

/// Replaces entries that are not finite by zero.
pub fn zero_unless_finite<T: Default>(
    list: &mut [T],
    finite: impl Fn(&T) -> bool,
    path: &str,
    warnings: &mut Vec<String>,
) {
    let mut count = 0;
    for entry in list.iter_mut().filter(|entry| !finite(entry)) {
        *entry = T::default();
        count += 1;
    }
    if count > 0 {
        warnings.push(format!("{path}: {count} entries are not finite numbers; taken as 0"));
    }
}

/// Drops triangles without area: hair cannot grow on them and they have no side that faces out.
pub fn drop_degenerate(primitive: &mut Primitive, path: &str, warnings: &mut Vec<String>) {
    let before = primitive.triangles.len();
    let positions = &primitive.positions;
    primitive.triangles.retain(|&t| {
        let [a, b, c] = t.map(|v| positions[v as usize].as_dvec3());
        let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
        // Height over longest edge: 10⁻⁷ is what rounding of f32 coordinates leaves of collinear points.
        (b - a).cross(c - a).length() > 1e-7 * longest && longest > 0.0
    });
    let dropped = before - primitive.triangles.len();
    if dropped > 0 {
        warnings.push(format!("{path}: {dropped} of {before} triangles have no area; they get no fur"));
    }
}

/// Makes normals unit; computes missing ones from the triangles around a point; turns parts of the surface that face
/// against their normals.
pub fn normals(primitive: &mut Primitive, path: &str, warnings: &mut Vec<String>) {
    if primitive.normals.is_empty() {
        primitive.normals = smooth(primitive);
        return;
    }
    let (mut scaled, mut bad) = (0, Vec::new());
    for (v, normal) in primitive.normals.iter_mut().enumerate() {
        // In f64, because f32 squares under- and overflow.
        let (wide, length) = (normal.as_dvec3(), normal.as_dvec3().length());
        if !length.is_finite() || length < 1e-6 {
            bad.push(v);
            continue;
        }
        scaled += usize::from((length - 1.0).abs() > 0.05);
        *normal = (wide / length).as_vec3();
    }
    if scaled > 0 {
        warnings.push(format!("{path}: {scaled} normals are not of unit length; scaled"));
    }
    if !bad.is_empty() {
        let used: std::collections::HashSet<u32> = primitive.triangles.iter().flatten().copied().collect();
        let seen = bad.iter().filter(|&&v| used.contains(&(v as u32))).count();
        if seen > 0 {
            warnings.push(format!("{path}: {seen} normals are zero or not finite; computed from the triangles"));
        }
        let computed = smooth(primitive);
        bad.into_iter().for_each(|v| primitive.normals[v] = computed[v]);
    }
    turn_reversed(primitive, path, warnings);
}

/// Normals summed over the triangles around a point, weighted by area (in f64: areas of tiny meshes underflow in f32).
fn smooth(primitive: &Primitive) -> Vec<Vec3> {
    let mut sums = vec![DVec3::ZERO; primitive.positions.len()];
    for triangle in &primitive.triangles {
        let area = area_vector(primitive, triangle);
        for &v in triangle {
            sums[primitive.position_class[v as usize] as usize] += area;
        }
    }
    let of = |class: &u32| sums[*class as usize].try_normalize().unwrap_or(DVec3::Y).as_vec3();
    primitive.position_class.iter().map(of).collect()
}

fn area_vector(primitive: &Primitive, triangle: &[u32; 3]) -> DVec3 {
    let [a, b, c] = triangle.map(|v| primitive.positions[v as usize].as_dvec3());
    (b - a).cross(c - a)
}

/// Connected parts whose stored normals mostly point into the surface are turned, so that hair grows outwards.
fn turn_reversed(primitive: &mut Primitive, path: &str, warnings: &mut Vec<String>) {
    let mut owner: Vec<u32> = (0..primitive.positions.len() as u32).collect();
    for triangle in &primitive.triangles {
        let roots = triangle.map(|v| find(&mut owner, primitive.position_class[v as usize]));
        owner[roots[1] as usize] = roots[0];
        let last = find(&mut owner, roots[2]);
        owner[last as usize] = roots[0];
    }
    let part = |owner: &mut Vec<u32>, t: &[u32; 3]| find(owner, primitive.position_class[t[0] as usize]);
    let mut agreement: HashMap<u32, f64> = HashMap::new();
    for triangle in &primitive.triangles {
        let normal: DVec3 = triangle.iter().map(|&v| primitive.normals[v as usize].as_dvec3()).sum();
        *agreement.entry(part(&mut owner, triangle)).or_default() += normal.dot(area_vector(primitive, triangle));
    }
    let mut turned = primitive.triangles.clone();
    let mut count = 0;
    for triangle in &mut turned {
        if agreement[&part(&mut owner, triangle)] < 0.0 {
            triangle.swap(1, 2);
            count += 1;
        }
    }
    if count > 0 {
        warnings
            .push(format!("{path}: {count} triangles wind against their normals; their fur grows along the normals"));
    }
    primitive.triangles = turned;
}

fn find(owner: &mut [u32], start: u32) -> u32 {
    let mut at = start;
    while owner[at as usize] != at {
        owner[at as usize] = owner[owner[at as usize] as usize];
        at = owner[at as usize];
    }
    at
}

/// Says how many edges more than two triangles share: there is no single fin or neighbour across them.
pub fn report_topology(primitive: &Primitive, path: &str, warnings: &mut Vec<String>) {
    let mut uses: HashMap<(u32, u32), u32> = HashMap::new();
    for t in &primitive.triangles {
        let [a, b, c] = t.map(|v| primitive.position_class[v as usize]);
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *uses.entry((from.min(to), from.max(to))).or_default() += 1;
        }
    }
    let shared = uses.values().filter(|&&count| count > 2).count();
    if shared > 0 {
        warnings.push(format!("{path}: {shared} edges are shared by more than two triangles"));
    }
}
