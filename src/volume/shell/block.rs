//! Density and shadow stored per sub-element of one prism.

use super::subelement;
use crate::math::lanes::{F32s, Isa, MOST, Row, U32s, Vec3s};

/// The largest value that a byte can hold; 1 is byte 64 exactly.
pub const LARGEST: f32 = (255.0 / 64.0) * (255.0 / 64.0);

/// Values by sub-element and layer: i·layers + i_l. Equation (3) has whole layers one after the other, but a ray goes from
/// layer to layer over neighbouring sub-elements: a column of 16 layers is a quarter of a cache line.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Block {
    d: u32,
    layers: u32,
    values: Box<[u8]>,
}

impl Block {
    /// Of `d` subdivisions and `layers`, from what [`codes`] gives by i·layers + i_l.
    pub fn of_codes(d: u32, layers: u32, codes: Vec<u8>) -> Self {
        debug_assert_eq!(codes.len(), (layers << (2 * d)) as usize, "one code per sub-element");
        Self { d, layers, values: codes.into() }
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.values.len()
    }
}

/// The blocks that marches side by side are in.
#[derive(Clone, Copy, Debug)]
pub struct Blocks<'a> {
    blocks: [&'a [u8]; MOST],
    /// 2^d.
    n: Row,
    layers: f32,
}

impl<'a> Blocks<'a> {
    /// No block yet, of a volume of so many layers.
    pub fn new(layers: u32) -> Self {
        Self { blocks: [&[]; MOST], n: Row([1.0; MOST]), layers: layers as f32 }
    }

    /// Puts lane `i` into a block.
    #[inline(always)]
    pub fn set(&mut self, i: usize, block: &'a Block) {
        self.blocks[i] = &block.values;
        self.n.0[i] = (1_u32 << block.d) as f32;
    }

    /// Values of the sub-elements that hold points; any value in lanes whose points lie in no prism.
    #[inline(always)]
    pub fn at<I: Isa>(&self, b: Vec3s<I>, t: F32s<I>) -> F32s<I> {
        let layer = (t * self.layers).floor().within(0.0, self.layers - 1.0);
        let i = subelement::indices(b, F32s::of(&self.n));
        let at = i.times(U32s::splat(self.layers as u32)).plus(layer.to_whole()).row();
        value(U32s::each(|lane| self.blocks[lane].get(at[lane] as usize).map_or(0, |&byte| u32::from(byte))))
    }
}

/// What bytes stand for.
#[inline(always)]
pub(super) fn value<I: Isa>(byte: U32s<I>) -> F32s<I> {
    let root = byte.signed_to_f32() * (1.0 / 255.0);
    root * root * LARGEST
}

/// Square-root coding: small values keep their relative precision.
pub fn code(value: f32) -> u8 {
    ((value / LARGEST).clamp(0.0, 1.0).sqrt() * 255.0 + 0.5) as u8
}

/// The bytes that stand for values.
#[inline(always)]
pub fn codes<I: Isa>(values: F32s<I>) -> U32s<I> {
    ((values / F32s::splat(LARGEST)).within(0.0, 1.0).sqrt() * 255.0 + 0.5).to_whole()
}
