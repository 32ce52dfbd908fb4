//! Wavefront OBJ: read into a glTF document, one primitive per material.
//!
//! A reader of our own because files in the wild have relative indices, continued lines, concave polygons and numbers
//! that are none, and each fault should be named by its line.

use super::document::Document;
use super::encode::Use;
use super::uri;
use crate::error::{Error, Result};
use crate::math::{DVec3, Vec2, Vec3};
use serde_json::json;
use std::collections::HashMap;
use std::path::Path;

/// A corner: position, texture coordinate, normal.
type Corner = (u32, Option<u32>, Option<u32>);

/// Faces of one material.
#[derive(Default)]
struct Group {
    material: String,
    vertices: Vec<Corner>,
    known: HashMap<Corner, u32>,
    indices: Vec<u32>,
}

#[derive(Default)]
struct Reader {
    positions: Vec<Vec3>,
    uvs: Vec<Vec2>,
    normals: Vec<Vec3>,
    groups: Vec<Group>,
    current: String,
    libraries: Vec<String>,
}

/// Reads an OBJ file's bytes; `path` names it and tells where its material files lie.
///
/// # Errors
/// Names the line that cannot be read.
pub fn read(bytes: &[u8], path: &Path, warnings: &mut Vec<String>) -> Result<Document> {
    let text = String::from_utf8_lossy(bytes);
    let mut reader = Reader { current: "default".into(), ..Reader::default() };
    let mut lines = text.lines().enumerate();
    while let Some((number, line)) = lines.next() {
        let mut line = line.to_owned();
        while line.trim_end().ends_with('\\') {
            line.truncate(line.trim_end().len() - 1);
            match lines.next() {
                Some((_, more)) => line.push_str(more),
                None => break,
            }
        }
        let line = line.split('#').next().unwrap_or_default();
        reader.line(line).map_err(|error| Error { field: Some(format!("line {}", number + 1)), ..error })?;
    }
    if reader.groups.is_empty() {
        return Err(Error::input("the OBJ has no faces")
            .with_field("f")
            .with_found("no face")
            .with_expected("at least one line that starts with `f`")
            .with_hint("inputs are .glb, .gltf and .obj meshes"));
    }
    reader.document(path, warnings)
}

impl Reader {
    fn line(&mut self, line: &str) -> Result<()> {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => self.positions.push(Vec3::from_array(numbers(words)?)),
            Some("vt") => {
                let [u, v] = match words.clone().count() {
                    1 => [numbers::<1>(words)?[0], 0.0],
                    _ => numbers(words)?,
                };
                // OBJ counts v from below, glTF from above.
                self.uvs.push(Vec2::new(u, 1.0 - v));
            }
            Some("vn") => self.normals.push(Vec3::from_array(numbers(words)?)),
            Some("f") => self.face(words)?,
            Some("usemtl") => self.current = line.trim_start()["usemtl".len()..].trim().to_owned(),
            Some("mtllib") => self.libraries.push(line.trim_start()["mtllib".len()..].trim().to_owned()),
            _ => {}
        }
        Ok(())
    }

    fn face<'a>(&mut self, words: impl Iterator<Item = &'a str>) -> Result<()> {
        let corners = words.map(|word| self.corner(word)).collect::<Result<Vec<_>>>()?;
        if corners.len() < 3 {
            return Err(Error::input("a face has fewer than three corners")
                .with_found(corners.len())
                .with_expected("3 or more"));
        }
        let points: Vec<Vec3> = corners.iter().map(|c| self.positions[c.0 as usize]).collect();
        let current = &self.current;
        let at = match self.groups.iter().position(|group| group.material == *current) {
            Some(at) => at,
            None => {
                self.groups.push(Group { material: current.clone(), ..Group::default() });
                self.groups.len() - 1
            }
        };
        let group = &mut self.groups[at];
        let mapped: Vec<u32> = corners
            .into_iter()
            .map(|corner| {
                *group.known.entry(corner).or_insert_with(|| {
                    group.vertices.push(corner);
                    group.vertices.len() as u32 - 1
                })
            })
            .collect();
        group.indices.extend(fill(&points).into_iter().map(|i| mapped[i]));
        Ok(())
    }

    /// `7`, `7/2`, `7//3` or `7/2/3`, counted from 1, or from the end where negative.
    fn corner(&self, word: &str) -> Result<Corner> {
        let mut parts = word.split('/');
        let mut index = |length: usize, what: &str| -> Result<Option<u32>> {
            let Some(text) = parts.next().filter(|text| !text.is_empty()) else { return Ok(None) };
            let number: i64 = text.parse().unwrap_or(0);
            let from_start = if number < 0 { length as i64 + number } else { number - 1 };
            match usize::try_from(from_start) {
                Ok(found) if found < length => Ok(Some(found as u32)),
                _ => Err(Error::input(format!("a face names a {what} that is not there"))
                    .with_found(format!("`{word}`"))
                    .with_expected(format!("1 to {length}, or -1 to -{length}"))
                    .with_hint("the file was cut or written by a faulty exporter; export it again")),
            }
        };
        let position = index(self.positions.len(), "vertex")?;
        let uv = index(self.uvs.len(), "texture coordinate")?;
        let normal = index(self.normals.len(), "normal")?;
        match position {
            Some(position) => Ok((position, uv, normal)),
            None => Err(Error::input("a face corner has no vertex")
                .with_found(format!("`{word}`"))
                .with_expected("a number")),
        }
    }

    fn document(self, path: &Path, warnings: &mut Vec<String>) -> Result<Document> {
        let name = path.to_string_lossy();
        let mut document = Document::made(&name);
        document.folder = path.parent().map(|p| if p.as_os_str().is_empty() { ".".into() } else { p.to_owned() });
        document.files.push(path.to_owned());
        let textures = self.textures(&mut document, warnings);
        let mut primitives = Vec::new();
        for group in &self.groups {
            let positions: Vec<Vec3> = group.vertices.iter().map(|c| self.positions[c.0 as usize]).collect();
            let mut attributes = json!({"POSITION": document.push_positions(&positions, Use::Vertices)});
            let normals: Option<Vec<Vec3>> =
                group.vertices.iter().map(|c| self.normals[c.2? as usize].try_normalize()).collect();
            if let Some(normals) = normals {
                attributes["NORMAL"] = json!(document.push_vec3(&normals, Use::Vertices));
            }
            let uvs: Option<Vec<Vec2>> = group.vertices.iter().map(|c| Some(self.uvs[c.1? as usize])).collect();
            if let Some(uvs) = uvs {
                attributes["TEXCOORD_0"] = json!(document.push_vec2(&uvs, Use::Vertices));
            }
            let mut pbr = json!({"metallicFactor": 0.0, "roughnessFactor": 0.9});
            if let Some(image) = textures.get(&group.material) {
                let texture = document.push("textures", json!({"source": image}));
                pbr["baseColorTexture"] = json!({"index": texture});
            }
            let material = document.push("materials", json!({"name": group.material, "pbrMetallicRoughness": pbr}));
            let indices = document.push_integers(&group.indices, 1, Use::Indices);
            primitives.push(json!({"attributes": attributes, "indices": indices, "material": material}));
        }
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let mesh = document.push("meshes", json!({"name": stem, "primitives": primitives}));
        let node = document.push("nodes", json!({"name": stem, "mesh": mesh}));
        document.push("scenes", json!({"nodes": [node]}));
        document.json["scene"] = json!(0);
        Ok(document)
    }

    /// Images named by `map_Kd` in the material files, by material.
    fn textures(&self, document: &mut Document, warnings: &mut Vec<String>) -> HashMap<String, usize> {
        let mut found = HashMap::new();
        for library in &self.libraries {
            let text = match uri::resolve(library, document.folder.as_deref(), "mtllib") {
                Ok(uri::Target::File(path)) => uri::read_file(&path).map(|bytes| {
                    document.files.push(path);
                    String::from_utf8_lossy(&bytes).into_owned()
                }),
                _ => Err(Error::input("it lies outside the input's folder")),
            };
            let text = match text {
                Ok(text) => text,
                Err(error) => {
                    warnings.push(format!("material file {library} passed over: {}", error.what));
                    continue;
                }
            };
            let mut material = String::new();
            for line in text.lines().map(str::trim) {
                if let Some(name) = line.strip_prefix("newmtl ") {
                    material = name.trim().to_owned();
                } else if let Some(file) = line.strip_prefix("map_Kd ") {
                    // Options such as -s 1 1 1 come before the name; names with spaces are then cut, and warned about.
                    let file = file.trim();
                    let file = if file.starts_with('-') { file.rsplit(' ').next().unwrap_or(file) } else { file };
                    match uri::resolve(file, document.folder.as_deref(), "map_Kd") {
                        Ok(_) => {
                            let image = document.push("images", json!({"uri": file}));
                            found.insert(std::mem::take(&mut material), image);
                        }
                        Err(error) => warnings.push(format!("texture {file} passed over: {}", error.what)),
                    }
                }
            }
        }
        found
    }
}

/// The first `N` numbers of a line.
fn numbers<'a, const N: usize>(mut words: impl Iterator<Item = &'a str>) -> Result<[f32; N]> {
    let mut list = [0.0; N];
    for (i, number) in list.iter_mut().enumerate() {
        let word = words.next().unwrap_or_default();
        *number = word.parse().ok().filter(|n: &f32| n.is_finite()).ok_or_else(|| {
            Error::input("a coordinate is not a finite number")
                .with_found(if word.is_empty() { format!("{i} numbers") } else { format!("`{word}`") })
                .with_expected(format!("{N} finite numbers"))
                .with_hint("mend the line, or export the file again")
        })?;
    }
    Ok(list)
}

/// Triangles that fill a polygon, as corner indices: by ears in the plane of its area, which concave ones need.
fn fill(points: &[Vec3]) -> Vec<usize> {
    let n = points.len();
    let wide: Vec<DVec3> = points.iter().map(|p| p.as_dvec3()).collect();
    let normal: DVec3 = (0..n).map(|i| (wide[i] - wide[0]).cross(wide[(i + 1) % n] - wide[0])).sum();
    let Some(normal) = normal.try_normalize().filter(|_| n > 3) else {
        return (1..n - 1).flat_map(|i| [0, i, i + 1]).collect();
    };
    let (x, y) = normal.any_orthonormal_pair();
    let flat: Vec<[f64; 2]> = wide.iter().map(|p| [(*p - wide[0]).dot(x), (*p - wide[0]).dot(y)]).collect();
    let mut indices: Vec<usize> = Vec::new();
    earcut::Earcut::new().earcut(flat.iter().copied(), &[], &mut indices);
    // Earcut leaves the orientation of its triangles open; all must wind as the polygon does.
    for t in indices.chunks_exact_mut(3) {
        let [a, b, c] = [wide[t[0]], wide[t[1]], wide[t[2]]];
        if (b - a).cross(c - a).dot(normal) < 0.0 {
            t.swap(1, 2);
        }
    }
    indices
}
