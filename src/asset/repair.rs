//! Faults of vertex data that can be mended or lived with, each said once with its count.

use super::document::Document;
use super::encode::{Use, numbers};
use super::json::At;
use super::stored::Primitive;
use crate::error::Result;
use crate::math::{DVec3, Vec3};
use serde_json::json;
use std::collections::{HashMap, HashSet};

/// What was found while reading, for people and for the output.
#[derive(Clone, Debug, Default)]
pub struct Notes {
    /// One sentence each.
    pub warnings: Vec<String>,
    /// What was decided, one sentence each.
    pub told: Vec<String>,
    /// Accessors whose stored values no reader could use, with values that can be: they go into the output.
    pub mended: Vec<Mended>,
}

/// New values for an accessor.
#[derive(Clone, Debug)]
pub struct Mended {
    /// The accessor.
    pub accessor: usize,
    /// Components of an element.
    pub width: usize,
    /// All components, element by element.
    pub values: Vec<f32>,
}

impl Notes {
    /// Adds a warning.
    pub fn warn(&mut self, text: String) {
        self.warnings.push(text);
    }

    /// Replaces numbers that are not finite by zero, in the output too.
    pub fn mend(&mut self, values: &mut [f32], width: usize, at: &At<'_>) -> Result<()> {
        let mut count = 0;
        for element in values.chunks_exact_mut(width).filter(|element| element.iter().any(|c| !c.is_finite())) {
            element.fill(0.0);
            count += 1;
        }
        if count > 0 {
            self.warn(format!("{}: {count} entries are not finite numbers; taken as 0", at.path));
            self.mended.push(Mended { accessor: at.size()?, width, values: values.to_vec() });
        }
        Ok(())
    }
}

/// Writes mended accessors, and position bounds that do not hold their positions, into the document.
///
/// # Errors
/// When a field of an accessor cannot be read.
pub fn apply(document: &mut Document, notes: &mut Notes) -> Result<()> {
    for Mended { accessor, width, values } in notes.mended.drain(..) {
        let replacement = document.push_floats(&values, width, Use::Vertices);
        let view = document.json["accessors"][replacement]["bufferView"].clone();
        if let Some(list) = document.json["accessors"].as_array_mut() {
            list.pop();
            if let Some(object) = list[accessor].as_object_mut() {
                ["byteOffset", "sparse", "normalized"].iter().for_each(|key| drop(object.shift_remove(*key)));
                object.insert("bufferView".into(), view);
                object.insert("componentType".into(), json!(5126));
            }
        }
    }
    let mut wrong = Vec::new();
    for mesh in document.root().list("meshes")? {
        for primitive in mesh.list("primitives")? {
            let Some(at) = primitive.need("attributes")?.get("POSITION") else { continue };
            wrong.extend(true_bounds(document, at.size()?)?);
        }
    }
    wrong.dedup_by_key(|(accessor, _)| *accessor);
    for (accessor, [low, high]) in wrong {
        notes.warn(format!("accessors[{accessor}]: min and max do not hold its values; corrected"));
        document.json["accessors"][accessor]["min"] = numbers(&low.to_array());
        document.json["accessors"][accessor]["max"] = numbers(&high.to_array());
    }
    Ok(())
}

/// The bounds of a float position accessor whose stated ones are more than rounding too small.
fn true_bounds(document: &Document, accessor: usize) -> Result<Option<(usize, [Vec3; 2])>> {
    let at = document.root().entry("accessors", accessor)?;
    let (Some(min), Some(max)) = (at.get("min"), at.get("max")) else { return Ok(None) };
    if at.need("componentType")?.size()? != 5126 {
        return Ok(None);
    }
    let stated = [min.numbers::<3>()?, max.numbers::<3>()?].map(|n| DVec3::from_array(n).as_vec3());
    let values = document.floats(accessor, 3)?;
    let points = || values.chunks_exact(3).map(Vec3::from_slice);
    let found = [points().fold(Vec3::INFINITY, Vec3::min), points().fold(Vec3::NEG_INFINITY, Vec3::max)];
    let slack = Vec3::splat(1e-5 * (found[1] - found[0]).length());
    let holds = (stated[0] - slack).cmple(found[0]).all() && (stated[1] + slack).cmpge(found[1]).all();
    Ok((!holds && !values.is_empty()).then_some((accessor, found)))
}

/// Drops triangles without area: hair cannot grow on them and they have no side that faces out.
pub fn drop_degenerate(primitive: &mut Primitive, path: &str, notes: &mut Notes) {
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
        notes.warn(format!("{path}: {dropped} of {before} triangles have no area; they get no fur"));
    }
}

/// Makes normals unit; computes missing ones from the triangles around a point; turns parts of the surface that face
/// against their normals.
pub fn normals(primitive: &mut Primitive, accessor: Option<usize>, path: &str, notes: &mut Notes) {
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
        notes.warn(format!("{path}: {scaled} normals are not of unit length; scaled"));
    }
    if !bad.is_empty() {
        let used: HashSet<u32> = primitive.triangles.iter().flatten().copied().collect();
        let seen = bad.iter().filter(|&&v| used.contains(&(v as u32))).count();
        if seen > 0 {
            notes.warn(format!("{path}: {seen} normals are zero or not finite; computed from the triangles"));
        }
        let computed = smooth(primitive);
        let broken = primitive.normals.iter().any(|n| !n.is_finite());
        bad.into_iter().for_each(|v| primitive.normals[v] = computed[v]);
        if let (true, Some(accessor)) = (broken, accessor) {
            let values = bytemuck::cast_slice(&primitive.normals).to_vec();
            notes.mended.push(Mended { accessor, width: 3, values });
        }
    }
    turn_reversed(primitive, path, notes);
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
fn turn_reversed(primitive: &mut Primitive, path: &str, notes: &mut Notes) {
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
        notes.warn(format!("{path}: {count} triangles wind against their normals; their fur grows along the normals"));
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
pub fn report_topology(primitive: &Primitive, path: &str, notes: &mut Notes) {
    let mut uses: HashMap<(u32, u32), u32> = HashMap::new();
    for t in &primitive.triangles {
        let [a, b, c] = t.map(|v| primitive.position_class[v as usize]);
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *uses.entry((from.min(to), from.max(to))).or_default() += 1;
        }
    }
    let shared = uses.values().filter(|&&count| count > 2).count();
    if shared > 0 {
        notes.warn(format!("{path}: {shared} edges are shared by more than two triangles"));
    }
}
