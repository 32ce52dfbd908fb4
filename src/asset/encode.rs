//! Appends accessors to a document.

use super::document::Document;
use crate::math::{Vec2, Vec3, Vec4};
use serde_json::{Value, json};

/// What a GPU will use a buffer view as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Use {
    /// Vertex attribute of a primitive.
    Vertices,
    /// Indices of a primitive.
    Indices,
    /// Neither.
    Other,
}

impl Use {
    fn target(self) -> Option<u32> {
        match self {
            Self::Vertices => Some(34962),
            Self::Indices => Some(34963),
            Self::Other => None,
        }
    }
}

impl Document {
    /// Appends raw elements as an accessor in a buffer view of its own and gives its index.
    pub fn push_accessor(&mut self, bytes: &[u8], kind: &str, component_type: u32, count: usize, usage: Use) -> usize {
        let view = self.push_view(bytes, usage.target());
        self.push(
            "accessors",
            json!({"bufferView": view, "componentType": component_type, "count": count, "type": kind}),
        )
    }

    /// Appends unsigned integers of `width` components each: in 16 bits where all fit, else in 32.
    pub fn push_integers(&mut self, values: &[u32], width: usize, usage: Use) -> usize {
        let kind = ["", "SCALAR", "VEC2", "VEC3", "VEC4"][width];
        // 65535 is no index of a primitive: it restarts strips.
        let short: Option<Vec<u16>> =
            values.iter().map(|&v| u16::try_from(v).ok().filter(|&short| short < u16::MAX)).collect();
        let (bytes, component): (Vec<u8>, u32) = match short {
            Some(short) => (short.iter().flat_map(|v| v.to_le_bytes()).collect(), 5123),
            None => (values.iter().flat_map(|v| v.to_le_bytes()).collect(), 5125),
        };
        self.push_accessor(&bytes, kind, component, values.len() / width, usage)
    }

    /// Appends quadruples in [0, 1], in 16 bits each.
    pub fn push_unorm16(&mut self, values: &[Vec4], usage: Use) -> usize {
        let coded = |v: f32| (v.clamp(0.0, 1.0) * f32::from(u16::MAX)).round() as u16;
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_array()).flat_map(|v| coded(v).to_le_bytes()).collect();
        let index = self.push_accessor(&bytes, "VEC4", 5123, values.len(), usage);
        self.json["accessors"][index]["normalized"] = json!(true);
        index
    }

    /// Appends floats of `width` components each.
    pub fn push_floats(&mut self, values: &[f32], width: usize, usage: Use) -> usize {
        let kind = match width {
            16 => "MAT4",
            _ => ["", "SCALAR", "VEC2", "VEC3", "VEC4"][width],
        };
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.push_accessor(&bytes, kind, 5126, values.len() / width, usage)
    }

    /// Appends pairs.
    pub fn push_vec2(&mut self, values: &[Vec2], usage: Use) -> usize {
        self.push_floats(bytemuck::cast_slice(values), 2, usage)
    }

    /// Appends triples.
    pub fn push_vec3(&mut self, values: &[Vec3], usage: Use) -> usize {
        self.push_floats(bytemuck::cast_slice(values), 3, usage)
    }

    /// Appends quadruples.
    pub fn push_vec4(&mut self, values: &[Vec4], usage: Use) -> usize {
        let floats: Vec<f32> = values.iter().flat_map(|v| v.to_array()).collect();
        self.push_floats(&floats, 4, usage)
    }

    /// Appends positions, with the bounds that the format wants of them.
    pub fn push_positions(&mut self, values: &[Vec3], usage: Use) -> usize {
        let index = self.push_vec3(values, usage);
        let low = values.iter().fold(Vec3::INFINITY, |a, &p| a.min(p));
        let high = values.iter().fold(Vec3::NEG_INFINITY, |a, &p| a.max(p));
        if !values.is_empty() {
            self.json["accessors"][index]["min"] = numbers(&low.to_array());
            self.json["accessors"][index]["max"] = numbers(&high.to_array());
        }
        index
    }

    /// Appends key times, with their bounds.
    pub fn push_times(&mut self, seconds: &[f32]) -> usize {
        let index = self.push_floats(seconds, 1, Use::Other);
        let (low, high) = (seconds.first().copied().unwrap_or(0.0), seconds.last().copied().unwrap_or(0.0));
        self.json["accessors"][index]["min"] = numbers(&[low]);
        self.json["accessors"][index]["max"] = numbers(&[high]);
        index
    }
}

/// f32 numbers in JSON, exact.
pub fn numbers(values: &[f32]) -> Value {
    Value::Array(values.iter().map(|&v| json!(f64::from(v))).collect())
}
