//! Wavefront OBJ: read into a glTF document, one primitive per material.
//!
//! A reader of our own because files in the wild have relative indices, continued lines, concave polygons and numbers
//! that are none, and each fault should be named by its line.

mod fill;
mod lines;
mod mtl;

use super::document::Document;
use super::encode::Use;
use super::text;
use crate::data::image::linear_from_srgb;
use crate::error::{Error, Result};
use crate::math::{Vec2, Vec3};
use fill::fill;
use mtl::Materials;
use serde_json::json;
use std::borrow::Cow;
use std::collections::HashMap;
use std::path::Path;

/// A corner: position, texture coordinate, normal.
type Corner = (u32, Option<u32>, Option<u32>);

/// Faces of one material.
#[derive(Clone, Default)]
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
    /// Colours that stand behind positions, per position, as written.
    colours: HashMap<u32, Vec3>,
    /// Points and lines.
    passed_over: usize,
    groups: Vec<Group>,
    current: String,
    libraries: Vec<String>,
}

/// Reads an OBJ file's bytes; `path` names it and tells where its material files lie.
///
/// # Errors
/// Names the line that cannot be read.
pub fn read(bytes: &[u8], path: &Path, warnings: &mut Vec<String>) -> Result<Document> {
    let (text, odd) = text::decode(bytes);
    if !odd.is_empty() {
        warnings.push(format!("{} bytes are not UTF-8; read as Latin-1", odd.len()));
    }
    let mut reader = Reader { current: "default".into(), ..Reader::default() };
    lines::each(&text, |keyword, rest| reader.line(keyword, rest))?;
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
    fn line(&mut self, keyword: &str, rest: &str) -> Result<()> {
        let words = rest.split_whitespace();
        match keyword {
            "v" => {
                // As scanners write it: x y z, then red, green and blue.
                if words.clone().count() >= 6
                    && let Ok(colour) = numbers(words.clone().skip(3))
                {
                    self.colours.insert(self.positions.len() as u32, Vec3::from_array(colour));
                }
                self.positions.push(Vec3::from_array(numbers(words)?));
            }
            "vt" => {
                let [u, v] = match words.clone().count() {
                    1 => [numbers::<1>(words)?[0], 0.0],
                    _ => numbers(words)?,
                };
                // OBJ counts v from below, glTF from above.
                self.uvs.push(Vec2::new(u, 1.0 - v));
            }
            "vn" => self.normals.push(Vec3::from_array(numbers(words)?)),
            "f" => self.face(words)?,
            "p" | "l" => self.passed_over += 1,
            "usemtl" => self.current = rest.to_owned(),
            "mtllib" => self.libraries.push(rest.to_owned()),
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
        let mapped: Vec<u32> = corners.into_iter().map(|corner| group.index_of(corner)).collect();
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
        if self.passed_over > 0 {
            warnings.push(format!("{} lines of points or curves passed over", self.passed_over));
        }
        let materials = mtl::read(&self.libraries, &mut document, warnings);
        // Colours of 8 bits are told by their size.
        let top = self.colours.values().fold(1.0_f32, |top, colour| top.max(colour.max_element()));
        let mut primitives = Vec::new();
        for group in &self.groups {
            let group = group.with_uvs(warnings);
            let positions: Vec<Vec3> = group.vertices.iter().map(|c| self.positions[c.0 as usize]).collect();
            let mut attributes = json!({"POSITION": document.push_positions(&positions, Use::Vertices)});
            let normals: Option<Vec<Vec3>> =
                group.vertices.iter().map(|c| self.normals[c.2? as usize].try_normalize()).collect();
            if let Some(normals) = normals {
                attributes["NORMAL"] = json!(document.push_vec3(&normals, Use::Vertices));
            }
            let uvs: Option<Vec<Vec2>> = group.vertices.iter().map(|c| Some(self.uvs[c.1? as usize])).collect();
            let has_uvs = uvs.is_some();
            if let Some(uvs) = uvs {
                attributes["TEXCOORD_0"] = json!(document.push_vec2(&uvs, Use::Vertices));
            }
            let described = self.material(&group.material, &materials, has_uvs, warnings);
            if group.vertices.iter().any(|c| self.colours.contains_key(&c.0)) {
                if described.is_textured() {
                    let name = &group.material;
                    warnings.push(format!(
                        "material {name:?} has a texture; colours that stand behind its vertices are left out"
                    ));
                } else {
                    let linear = |c: f32| linear_from_srgb((c / if top > 1.0 { 255.0 } else { 1.0 }).clamp(0.0, 1.0));
                    let colour = |c: &Corner| self.colours.get(&c.0).map_or(Vec3::ONE, |colour| colour.map(linear));
                    let colours: Vec<Vec3> = group.vertices.iter().map(colour).collect();
                    attributes["COLOR_0"] = json!(document.push_vec3(&colours, Use::Vertices));
                }
            }
            let described = described.to_gltf(&group.material, &mut document);
            let material = document.push("materials", described);
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

    /// What is known of a material; what cannot be used of it is said.
    fn material(&self, name: &str, materials: &Materials, has_uvs: bool, warnings: &mut Vec<String>) -> mtl::Material {
        let found = materials.get(name);
        if found.is_none() && !materials.is_empty() && name != "default" {
            warnings.push(format!("material {name:?} is in none of the material files; taken as white"));
        }
        let found = found.cloned().unwrap_or_default();
        if found.is_textured() && !has_uvs {
            warnings.push(format!(
                "material {name:?} has a texture, but its faces have no texture coordinates; its Kd is used alone"
            ));
            return found.without_texture();
        }
        found
    }
}

impl Group {
    /// The same with texture coordinates at every corner, where some have them and others not: a face that lacks them takes one
    /// of its own, or one that is known at a place of it, or the group's first, so that it shows one colour of its surroundings.
    fn with_uvs(&self, warnings: &mut Vec<String>) -> Cow<'_, Self> {
        let Some(first) = self.vertices.iter().find_map(|c| c.1) else { return Cow::Borrowed(self) };
        let lacking = self.vertices.iter().filter(|c| c.1.is_none()).count();
        if lacking == 0 {
            return Cow::Borrowed(self);
        }
        warnings.push(format!(
            "material {:?}: {lacking} of {} vertices have no texture coordinate; their faces take the colour beside them",
            self.material,
            self.vertices.len()
        ));
        let mut at: HashMap<u32, u32> = HashMap::new();
        self.vertices.iter().filter_map(|c| Some((c.0, c.1?))).for_each(|(p, uv)| {
            at.entry(p).or_insert(uv);
        });
        let mut whole = Self { material: self.material.clone(), ..Self::default() };
        for triangle in self.indices.as_chunks::<3>().0 {
            let corners = triangle.map(|v| self.vertices[v as usize]);
            let own = corners.iter().find_map(|c| c.1).or_else(|| corners.iter().find_map(|c| at.get(&c.0).copied()));
            for (p, uv, n) in corners {
                let index = whole.index_of((p, uv.or(own).or(Some(first)), n));
                whole.indices.push(index);
            }
        }
        Cow::Owned(whole)
    }

    /// The number of a corner among its vertices.
    fn index_of(&mut self, corner: Corner) -> u32 {
        *self.known.entry(corner).or_insert_with(|| {
            self.vertices.push(corner);
            self.vertices.len() as u32 - 1
        })
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
