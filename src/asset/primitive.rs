//! Reads a triangle primitive: checked, and repaired where that harms nothing.

use super::document::Document;
use super::json::At;
use super::repair::{self, Mended, Notes};
use super::stored::{Influences, Morph, Primitive};
use crate::data::mesh::position_classes;
use crate::error::{Error, Result};
use crate::math::{DVec3, Vec2, Vec3, Vec4};

impl Primitive {
    /// Reads a primitive of mode 4, 5 or 6; `joints` is the length of its skin, if it has one.
    ///
    /// # Errors
    /// Names the accessor and the element that cannot be used.
    pub fn read(document: &Document, at: &At<'_>, joints: Option<usize>, notes: &mut Notes) -> Result<Self> {
        let attributes = at.need("attributes")?;
        let positions_at = attributes.need("POSITION")?;
        let positions = vectors(document, &positions_at)?;
        if let Some(i) = positions.iter().position(|p| !p.is_finite()) {
            return Err(Error::input("a vertex position is not a finite number")
                .with_field(format!("{} (vertex {i})", positions_at.path))
                .with_found(positions[i])
                .with_expected("finite numbers")
                .with_hint("delete or move the vertex in the modelling program"));
        }
        let mut primitive = Self { positions, ..Self::default() };
        primitive.triangles = triangles(document, at, primitive.positions.len(), notes)?;
        repair::drop_degenerate(&mut primitive, &at.path, notes);
        primitive.position_class = classes(&primitive.positions, &primitive.triangles);
        primitive.read_attributes(document, &attributes, notes)?;
        let normals = attributes.get("NORMAL");
        if let Some(normals) = &normals {
            primitive.normals = vectors(document, normals)?;
        }
        let accessor = normals.map(|at| at.size()).transpose()?;
        repair::normals(&mut primitive, accessor, &at.path, notes);
        repair::report_topology(&primitive, &at.path, notes);
        if let Some(joints) = joints {
            primitive.influences = influences(document, &attributes, primitive.positions.len(), joints, notes)?;
        }
        for target in at.list("targets")? {
            let read = |key: &str| target.get(key).map_or(Ok(Vec::new()), |at| vectors(document, &at));
            let morph = Morph { positions: read("POSITION")?, normals: read("NORMAL")? };
            if let Some(i) = morph.positions.iter().chain(&morph.normals).position(|p| !p.is_finite()) {
                return Err(target.fault(&format!("finite numbers (element {i} is not)")));
            }
            primitive.morphs.push(morph);
        }
        primitive.compact();
        Ok(primitive)
    }

    fn read_attributes(&mut self, document: &Document, attributes: &At<'_>, notes: &mut Notes) -> Result<()> {
        let mut read = |at: &At<'_>, width: usize| -> Result<Vec<f32>> {
            let mut values = document.floats(at.size()?, width)?;
            notes.mend(&mut values, width, at)?;
            Ok(values)
        };
        while let Some(at) = attributes.get(&format!("TEXCOORD_{}", self.uv_sets.len())) {
            self.uv_sets.push(read(&at, 2)?.chunks_exact(2).map(Vec2::from_slice).collect());
        }
        if let Some(at) = attributes.get("COLOR_0") {
            let width = if super::accessor::AccessorLayout::of(document, at.size()?)?.components == 3 { 3 } else { 4 };
            let colour = |c: &[f32]| Vec4::new(c[0], c[1], c[2], c.get(3).copied().unwrap_or(1.0));
            self.colour = Some(read(&at, width)?.chunks_exact(width).map(colour).collect());
        }
        if let Some(at) = attributes.get("_FUR_LENGTH") {
            self.fur_length = Some(read(&at, 1)?.into_iter().map(|length| length.max(0.0)).collect());
        }
        if let Some(at) = attributes.get("_FUR_REGION") {
            self.fur_region = Some(read(&at, 1)?.into_iter().map(|share| share.clamp(0.0, 1.0)).collect());
        }
        if let Some(at) = attributes.get("_FUR_DIRECTION") {
            self.fur_direction = Some(read(&at, 3)?.chunks_exact(3).map(Vec3::from_slice).collect());
        }
        for (i, _) in self.uv_sets.iter().enumerate().filter(|(_, set)| set.iter().all(|uv| *uv == Vec2::ZERO)) {
            notes.warn(format!("{}.TEXCOORD_{i}: every texture coordinate is (0, 0)", attributes.path));
        }
        Ok(())
    }
}

fn vectors(document: &Document, at: &At<'_>) -> Result<Vec<Vec3>> {
    Ok(document.floats(at.size()?, 3)?.chunks_exact(3).map(Vec3::from_slice).collect())
}

/// Corner indices of modes 4 (triangles), 5 (strip) and 6 (fan).
fn triangles(document: &Document, at: &At<'_>, vertices: usize, notes: &mut Notes) -> Result<Vec<[u32; 3]>> {
    let indices = match at.get("indices") {
        Some(indices_at) => {
            let indices = document.integers(indices_at.size()?, 1)?;
            if let Some(i) = indices.iter().position(|&v| v as usize >= vertices) {
                return Err(Error::input("an index points past the last vertex")
                    .with_field(format!("{} (index {i})", indices_at.path))
                    .with_found(indices[i])
                    .with_expected(format!("indices below {vertices}"))
                    .with_hint("the file was written by a faulty exporter; export it again"));
            }
            indices
        }
        None => (0..vertices as u32).collect(),
    };
    let windows = indices.windows(3);
    Ok(match at.size_or("mode", 4)? {
        5 => {
            windows.enumerate().map(|(i, w)| if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] }).collect()
        }
        6 => windows.map(|w| [w[1], w[2], indices[0]]).collect(),
        _ => {
            let (triangles, rest) = indices.as_chunks::<3>();
            if !rest.is_empty() {
                notes.warn(format!("{}: {} indices beyond the last whole triangle passed over", at.path, rest.len()));
            }
            triangles.to_vec()
        }
    })
}

/// Welds vertices closer than 2·10⁻⁶ of the size, but never the two ends of an edge.
fn classes(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<u32> {
    let points = |f: fn(DVec3, DVec3) -> DVec3, start| positions.iter().fold(start, |a, p| f(a, p.as_dvec3()));
    let (low, high) = (points(DVec3::min, DVec3::INFINITY), points(DVec3::max, DVec3::NEG_INFINITY));
    let diagonal = (high - low).length();
    if diagonal.partial_cmp(&0.0) != Some(std::cmp::Ordering::Greater) {
        return position_classes(positions, 0.0);
    }
    // Scaled to a unit diagonal, so that the file's own scale does not matter.
    let scaled: Vec<Vec3> = positions.iter().map(|p| ((p.as_dvec3() - low) / diagonal).as_vec3()).collect();
    let shortest = triangles
        .iter()
        .flat_map(|t| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])])
        .map(|(a, b)| scaled[a as usize].distance(scaled[b as usize]))
        .filter(|&length| length > 1e-7)
        .fold(f32::INFINITY, f32::min);
    position_classes(&scaled, (0.45 * shortest).min(2e-6))
}

/// `JOINTS_n` and `WEIGHTS_n` (n = 0, 1), weights scaled to sum to 1.
fn influences(
    document: &Document,
    attributes: &At<'_>,
    vertices: usize,
    skin_joints: usize,
    notes: &mut Notes,
) -> Result<Option<Vec<Influences>>> {
    let mut list = vec![Influences::default(); vertices];
    let mut weights_at = Vec::new();
    for set in 0..2 {
        let names = [format!("JOINTS_{set}"), format!("WEIGHTS_{set}")];
        let (Some(joints), Some(weights)) = (attributes.get(&names[0]), attributes.get(&names[1])) else { break };
        let joint_values = document.integers(joints.size()?, 4)?;
        let weight_values = document.floats(weights.size()?, 4)?;
        for (v, (j, w)) in joint_values.chunks_exact(4).zip(weight_values.chunks_exact(4)).enumerate() {
            for k in 0..4 {
                if j[k] as usize >= skin_joints {
                    return Err(Error::input("a vertex hangs on a joint that its skin does not have")
                        .with_field(format!("{} (vertex {v})", joints.path))
                        .with_found(j[k])
                        .with_expected(format!("joints 0 to {}", skin_joints - 1))
                        .with_hint("bind the mesh to its skeleton again and export it"));
                }
                list[v][set * 4 + k] = (j[k] as u16, if w[k].is_finite() { w[k].max(0.0) } else { 0.0 });
            }
        }
        weights_at.push(weights);
    }
    if weights_at.is_empty() {
        return Ok(None);
    }
    let (mut uneven, mut loose) = (0, 0);
    for entry in &mut list {
        join_duplicates(entry);
        let sum: f32 = entry.iter().map(|&(_, w)| w).sum();
        if sum > 0.0 && sum.is_finite() {
            uneven += usize::from((sum - 1.0).abs() > 0.02);
            entry.iter_mut().for_each(|(_, w)| *w /= sum);
        } else {
            loose += 1;
            *entry = Influences::default();
            entry[0].1 = 1.0;
        }
    }
    if uneven + loose > 0 {
        notes.warn(format!(
            "{}: the weights of {uneven} vertices do not sum to 1 and {loose} have none; scaled, or hung on the first joint",
            attributes.path
        ));
        for (set, at) in weights_at.iter().enumerate() {
            let values = list.iter().flat_map(|entry| &entry[set * 4..set * 4 + 4]).map(|&(_, w)| w).collect();
            notes.mended.push(Mended { accessor: at.size()?, width: 4, values });
        }
    }
    Ok(Some(list))
}

/// A joint named twice gets its weights in one place.
fn join_duplicates(entry: &mut Influences) {
    for later in 1..entry.len() {
        if let Some(first) = (0..later).find(|&i| entry[i].0 == entry[later].0 && entry[i].1 > 0.0) {
            entry[first].1 += std::mem::take(&mut entry[later].1);
        }
    }
}
