//! `sample:creature`: a made fox kit, one skinned surface with eyes and nose apart, and a walk.

mod body;
mod charts;
mod skeleton;
mod skin;
mod surface;

use super::Shape;
use crate::asset::document::Document;
use crate::asset::encode::Use;
use crate::math::{Vec3, Vec4};
use serde_json::{Value, json};

/// The creature as a document, in metres, standing on y = 0 and facing +Z.
pub fn document() -> Document {
    let mut document = Document::made("sample:creature");
    let fur = material(&mut document, "fur", [1.0, 1.0, 1.0], 0.9);
    let eyes = material(&mut document, "eyes", [0.018, 0.010, 0.006], 0.08);
    let nose = material(&mut document, "nose", [0.012, 0.010, 0.010], 0.35);
    let mut primitives = vec![coat_skin(&mut document, fur)];
    let mut balls = Shape::default();
    for side in [-1.0, 1.0] {
        balls.append(&ball(Vec3::new(0.0345 * side, 0.356, 0.2745), Vec3::new(0.0135, 0.0145, 0.0115)));
    }
    primitives.push(rigid(&mut document, &balls, eyes));
    let tip = ball(Vec3::new(0.0, 0.3265, 0.338), Vec3::new(0.0115, 0.0085, 0.0085));
    primitives.push(rigid(&mut document, &tip, nose));
    let mesh = document.push("meshes", json!({"name": "creature", "primitives": primitives}));
    let (root, skin) = skeleton::push(&mut document);
    let node = document.push("nodes", json!({"name": "creature", "mesh": mesh, "skin": skin}));
    document.push("scenes", json!({"nodes": [root, node]}));
    document.json["scene"] = json!(0);
    document
}

fn material(document: &mut Document, name: &str, colour: [f32; 3], roughness: f32) -> usize {
    let rounded = |value: f32| (f64::from(value) * 1000.0).round() / 1000.0;
    let [r, g, b] = colour.map(rounded);
    let pbr = json!({"baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.0, "roughnessFactor": rounded(roughness)});
    document.push("materials", json!({"name": name, "pbrMetallicRoughness": pbr}))
}

/// An ellipsoid.
fn ball(centre: Vec3, radii: Vec3) -> Shape {
    let mut shape = super::shapes::ball(20, 12);
    for (position, normal) in shape.positions.iter_mut().zip(&mut shape.normals) {
        *position = centre + radii * *normal;
        *normal = (*normal / radii).normalize_or_zero();
    }
    shape
}

/// A shape that hangs on the head alone.
fn rigid(document: &mut Document, shape: &Shape, material: usize) -> Value {
    let mut primitive = shape.push(document, material);
    let n = shape.positions.len();
    let joints = vec![[skeleton::HEAD as u8, 0, 0, 0]; n];
    let weights = vec![Vec4::X; n];
    skin_attributes(document, &mut primitive, &joints, &weights);
    primitive
}

fn skin_attributes(document: &mut Document, primitive: &mut Value, joints: &[[u8; 4]], weights: &[Vec4]) {
    let bytes = bytemuck::cast_slice(joints);
    primitive["attributes"]["JOINTS_0"] =
        json!(document.push_accessor(bytes, "VEC4", 5121, joints.len(), Use::Vertices));
    primitive["attributes"]["WEIGHTS_0"] = json!(document.push_vec4(weights, Use::Vertices));
}

/// The furry surface, with what a groom needs: colour, length and comb direction per vertex.
fn coat_skin(document: &mut Document, material: usize) -> Value {
    let surface = surface::extract(body::distance);
    let charted = charts::unwrap(&surface);
    let source = |list: &[Vec3]| -> Vec<Vec3> { charted.source.iter().map(|&v| list[v as usize]).collect() };
    let shape = Shape {
        positions: source(&surface.positions),
        normals: source(&surface.normals),
        uvs: charted.uvs,
        triangles: charted.triangles,
    };
    let mut primitive = shape.push(document, material);
    let holds: Vec<skin::Hold> = shape.positions.iter().map(|&p| body::weights(p)).collect();
    let vertices = || holds.iter().zip(&shape.positions).zip(&shape.normals);
    let colours: Vec<Vec4> = vertices().map(|((hold, &p), &n)| skin::colour(hold, p, n).extend(1.0)).collect();
    let lengths: Vec<f32> = vertices().map(|((hold, &p), _)| skin::length(hold, p)).collect();
    let directions: Vec<Vec3> = vertices().map(|((hold, &p), _)| skin::direction(hold, p)).collect();
    primitive["attributes"]["COLOR_0"] = json!(document.push_vec4(&colours, Use::Vertices));
    primitive["attributes"]["_FUR_LENGTH"] = json!(document.push_floats(&lengths, 1, Use::Vertices));
    primitive["attributes"]["_FUR_DIRECTION"] = json!(document.push_vec3(&directions, Use::Vertices));
    let (joints, weights): (Vec<_>, Vec<_>) = holds.into_iter().unzip();
    skin_attributes(document, &mut primitive, &joints, &weights);
    primitive
}

/// 0 below `low`, 1 above `high`, smooth in between.
fn smoothstep(low: f32, high: f32, value: f32) -> f32 {
    let t = ((value - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

impl Shape {
    fn append(&mut self, other: &Shape) {
        let start = self.positions.len() as u32;
        self.positions.extend(&other.positions);
        self.normals.extend(&other.normals);
        self.uvs.extend(&other.uvs);
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|v| v + start)));
    }
}
