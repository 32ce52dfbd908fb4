//! Constants that shaders of the runtime share with Rust.

use crate::data::coat::GAIN_ANGLES_DEG;
use crate::data::light::NEAREST_M;
use crate::data::shell::MOST_ABOVE;
use crate::data::shell::guards::{
    APART, FADE_BELOW, INVISIBLE, LEAST_AXIS, LEAST_BULK, LEAST_CLEAR, LEAST_COSINE, LEAST_DIRECTION, LEAST_EXTINCTION,
    LEAST_RISE, LEAST_UV_AREA, LEAST_VOLUME, MOST_SPREAD, MOST_TAPS,
};
use crate::gpu::Constant::{self, F32, F32s, U32};
use crate::runtime::draw_list::MAX_LIGHTS;
use crate::runtime::order::FULL;
use crate::runtime::sight::{OUTLINE, TOLD_APART};
use crate::volume::scene::{DEEPEST_HAIR, HORIZON};

/// The module `furrier::constants` of the runtime's shaders.
pub const CONSTANTS: [Constant; 24] = [
    F32("APART", APART),
    F32("PI", std::f32::consts::PI),
    F32("NEAREST_M", NEAREST_M),
    U32("MAX_LIGHTS", MAX_LIGHTS as u32),
    F32s("GAIN_ANGLES_DEG", &GAIN_ANGLES_DEG),
    F32("LEAST_VOLUME", LEAST_VOLUME),
    F32("LEAST_BULK", LEAST_BULK),
    F32("LEAST_COSINE", LEAST_COSINE),
    F32("LEAST_RISE", LEAST_RISE),
    F32("LEAST_CLEAR", LEAST_CLEAR),
    F32("MOST_ABOVE", MOST_ABOVE),
    F32("LEAST_EXTINCTION", LEAST_EXTINCTION),
    F32("LEAST_DIRECTION", LEAST_DIRECTION),
    F32("LEAST_AXIS", LEAST_AXIS),
    F32("LEAST_UV_AREA", LEAST_UV_AREA),
    F32("MOST_SPREAD", MOST_SPREAD),
    F32("FADE_BELOW", FADE_BELOW),
    F32("INVISIBLE", INVISIBLE),
    F32("FULL", FULL),
    F32("MOST_TAPS", MOST_TAPS),
    F32("DEEPEST_HAIR", DEEPEST_HAIR),
    F32("HORIZON", HORIZON),
    F32s("OUTLINE", &OUTLINE),
    F32("TOLD_APART", TOLD_APART),
];
