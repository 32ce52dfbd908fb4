//! Density and shadow stored per sub-element of one prism.

use super::subelement;
use crate::math::Vec3;

/// The largest value that a byte can hold; 1 is byte 64 exactly.
const LARGEST: f32 = (255.0 / 64.0) * (255.0 / 64.0);

/// Values in layers of sub-elements: i_l·4^d + i, equation (3) within one voxel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Block {
    d: u32,
    layers: u32,
    values: Box<[u8]>,
}

impl Block {
    /// Fills a block; `column(barycentric)` is asked for every sub-element of a layer, and what it gives for every height.
    pub fn fill<F: FnMut(f32) -> f32>(d: u32, layers: u32, mut column: impl FnMut(Vec3) -> F) -> Self {
        let per_layer = 1_usize << (2 * d);
        let mut values = vec![0; per_layer * layers as usize];
        for i in 0..per_layer {
            let mut value = column(subelement::centre(i as u32, d));
            for layer in 0..layers as usize {
                values[layer * per_layer + i] = code(value((layer as f32 + 0.5) / layers as f32));
            }
        }
        Self { d, layers, values: values.into() }
    }

    /// The value of the sub-element that holds a place.
    pub fn at(&self, b: Vec3, t: f32) -> f32 {
        let layer = ((t * self.layers as f32) as u32).min(self.layers - 1);
        decode(self.values[((layer << (2 * self.d)) + subelement::index(b, self.d)) as usize])
    }

    /// The same, linear between the middles of layers.
    pub fn between_layers(&self, b: Vec3, t: f32) -> f32 {
        let at = (t * self.layers as f32 - 0.5).clamp(0.0, (self.layers - 1) as f32);
        let low = at as u32;
        let i = subelement::index(b, self.d);
        let value = |layer: u32| decode(self.values[((layer << (2 * self.d)) + i) as usize]);
        let (from, to) = (value(low), value((low + 1).min(self.layers - 1)));
        from + (at - low as f32) * (to - from)
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.values.len()
    }
}

/// Square-root coding: small values keep their relative precision.
fn code(value: f32) -> u8 {
    ((value / LARGEST).clamp(0.0, 1.0).sqrt() * 255.0 + 0.5) as u8
}

fn decode(byte: u8) -> f32 {
    let root = f32::from(byte) * (1.0 / 255.0);
    root * root * LARGEST
}
