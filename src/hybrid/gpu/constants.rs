//! Constants that kernels share with Rust.

use super::items::{AT_BORDER, LINEAR, NOTHING};
use super::layout::Totals;
use crate::data::light::NEAREST_M;
use crate::gpu::Constant::{self, F32, U32};
use crate::hybrid::strands::{LEAST_SHARE, LIT_POINTS, MOST_BEND};
use crate::math::table::Table;
use crate::volume::march::content::TABLES;
use crate::volume::march::shadows::{DARK, DARK_AT_BORDERS, STEP_GROWTH, TOWARDS_LIGHT};
use crate::volume::march::{MOST_STEP_GROWTH, MOST_STEP_LENGTHENING, MOST_STEPS, ON_SIDE};
use crate::volume::mean;
use crate::volume::scene::{DEEPEST_HAIR, HORIZON};
use crate::volume::shell::block::LARGEST;
use std::mem::offset_of;

/// Where a number stands among those that a band came to.
const fn slot(offset: usize) -> u32 {
    (offset / size_of::<u32>()) as u32
}

/// The module `furrier::constants` of the kernels.
pub const CONSTANTS: [Constant; 28] = [
    F32("PI", std::f32::consts::PI),
    F32("NEAREST_M", NEAREST_M),
    U32("NOTHING", NOTHING),
    U32("AT_BORDER", AT_BORDER),
    U32("LINEAR", LINEAR),
    U32("STARTS", slot(offset_of!(Totals, starts))),
    U32("FRAGMENTS", slot(offset_of!(Totals, fragments))),
    U32("VIRTUAL_FRAGMENTS", slot(offset_of!(Totals, virtual_fragments))),
    U32("STEPS", slot(offset_of!(Totals, steps))),
    U32("OVERFLOW", slot(offset_of!(Totals, overflow))),
    U32("TABLE_VALUES", Table::VALUES as u32),
    U32("TABLES", TABLES as u32 + 1),
    U32("MEAN_LAYERS", mean::LAYERS as u32),
    U32("LIT_POINTS", LIT_POINTS as u32),
    U32("MOST_STEPS", MOST_STEPS),
    F32("MOST_STEP_GROWTH", MOST_STEP_GROWTH),
    F32("MOST_STEP_LENGTHENING", MOST_STEP_LENGTHENING),
    F32("ON_SIDE", ON_SIDE),
    F32("DARK", DARK),
    F32("DARK_AT_BORDERS", DARK_AT_BORDERS),
    F32("STEP_GROWTH", STEP_GROWTH),
    F32("SHADOW_STEP_DEPTH", TOWARDS_LIGHT.depth),
    F32("SHADOW_STEP_LAYERS", TOWARDS_LIGHT.layers),
    F32("LARGEST", LARGEST),
    F32("DEEPEST_HAIR", DEEPEST_HAIR),
    F32("HORIZON", HORIZON),
    F32("MOST_BEND", MOST_BEND),
    F32("LEAST_SHARE", LEAST_SHARE),
];
