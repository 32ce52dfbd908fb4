//! Meshes made in code: what the README shows and the tests use everywhere. In metres, at the size of real things.

mod creature;
mod shapes;

use super::document::Document;
use super::encode::Use;
use crate::error::{Error, Result};
use crate::math::{Vec2, Vec3};
use serde_json::{Value, json};

/// Names that follow `sample:`.
pub const NAMES: [&str; 6] = ["cylinder", "hat", "sphere", "torus", "plane", "creature"];

/// The sample `name` as a document.
///
/// # Errors
/// Lists the samples there are.
pub fn document(name: &str) -> Result<Document> {
    let grid = match name {
        "cylinder" => shapes::cylinder(),
        "hat" => shapes::hat(),
        "sphere" => shapes::sphere(),
        "torus" => shapes::torus(),
        "plane" => shapes::plane(),
        "creature" => return Ok(creature::document()),
        _ => {
            return Err(Error::usage("there is no such sample")
                .with_field("input")
                .with_found(format!("sample:{name}"))
                .with_expected(format!("sample: and one of {}", NAMES.join(", "))));
        }
    };
    let mut document = Document::made(&format!("sample:{name}"));
    let material = document.push(
        "materials",
        json!({"name": "fur", "pbrMetallicRoughness": {"baseColorFactor": [0.55, 0.38, 0.24, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.9}}),
    );
    let primitive = grid.push(&mut document, material);
    let mesh = document.push("meshes", json!({"name": name, "primitives": [primitive]}));
    let node = document.push("nodes", json!({"name": name, "mesh": mesh}));
    document.push("scenes", json!({"nodes": [node]}));
    document.json["scene"] = json!(0);
    Ok(document)
}

/// A triangle mesh in the making.
#[derive(Clone, Debug, Default)]
struct Shape {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    uvs: Vec<Vec2>,
    triangles: Vec<[u32; 3]>,
}

impl Shape {
    /// A grid of `columns` × `rows` quads over the unit square; `at(u, v)` gives position and normal. Triangles without
    /// area (at poles) are left out. Counter-clockwise where ∂u × ∂v points along the normal.
    fn grid(columns: u32, rows: u32, at: impl Fn(f32, f32) -> (Vec3, Vec3)) -> Self {
        let mut shape = Self::default();
        for row in 0..=rows {
            for column in 0..=columns {
                let (u, v) = (column as f32 / columns as f32, row as f32 / rows as f32);
                let (position, normal) = at(u, v);
                shape.positions.push(position);
                shape.normals.push(normal.normalize_or_zero());
                // glTF's v runs downwards.
                shape.uvs.push(Vec2::new(u, 1.0 - v));
            }
        }
        let index = |column: u32, row: u32| row * (columns + 1) + column;
        for row in 0..rows {
            for column in 0..columns {
                let (a, b) = (index(column, row), index(column + 1, row));
                let (c, d) = (index(column + 1, row + 1), index(column, row + 1));
                shape.add_triangle([a, b, c]);
                shape.add_triangle([a, c, d]);
            }
        }
        shape
    }

    fn add_triangle(&mut self, triangle: [u32; 3]) {
        let [a, b, c] = triangle.map(|v| self.positions[v as usize]);
        let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
        if (b - a).cross(c - a).length() > 1e-4 * longest {
            self.triangles.push(triangle);
        }
    }

    /// Appends the shape to a document and gives its primitive.
    fn push(&self, document: &mut Document, material: usize) -> Value {
        let attributes = json!({
            "POSITION": document.push_positions(&self.positions, Use::Vertices),
            "NORMAL": document.push_vec3(&self.normals, Use::Vertices),
            "TEXCOORD_0": document.push_vec2(&self.uvs, Use::Vertices),
        });
        let indices: Vec<u32> = self.triangles.iter().flatten().copied().collect();
        json!({"attributes": attributes, "indices": document.push_integers(&indices, 1, Use::Indices), "material": material})
    }
}
