// Coats without an order: weighted sums (McGuire and Bavoil 2013, "Weighted Blended Order-Independent Transparency", with McGuire's
// coloured transmission, as Frantzen 2023 has them), and hashed alpha (Wyman and McGuire 2017, "Hashed Alpha Testing").
#define_import_path furrier::blending

#import furrier::view::view

// What a fragment of a coat shows.
struct Shaded {
    // Premultiplied.
    light: vec4<f32>,
    // Of the hair.
    colour: vec3<f32>,
    // Optical depth of the coat before it, as it is in the mean.
    before: f32,
}

fn plain(light: vec4<f32>) -> Shaded {
    return Shaded(light, vec3(0.0), 0.0);
}

struct Weighted {
    // Light and opacity times weight, to be added up.
    @location(0) sum: vec4<f32>,
    // What of each channel, and of all that lies behind, does not come through; its complements are multiplied.
    @location(1) kept: vec4<f32>,
}

// Weights of depth, as equation 10 of the paper bounds them: for halves of floats.
const LEAST_WEIGHT: f32 = 1e-3;
const MOST_WEIGHT: f32 = 10.0;
// Depth of the coat from which on it weighs no less.
const DEEPEST: f32 = 7.0;

// The paper's weight by depth in clip space (equation 10), times what the coat before it lets through in the mean: along a ray through one
// coat that is nearly what sorting gives.
fn weighted_of(found: Shaded, clip_z: f32) -> Weighted {
    let nearness = 1.0 - clip_z;
    let weight = clamp(3e3 * nearness * nearness * nearness, LEAST_WEIGHT, MOST_WEIGHT) * exp(-clamp(found.before, 0.0, DEEPEST));
    return Weighted(found.light * weight, vec4((1.0 - found.colour) * found.light.a, found.light.a));
}

// Bits by chance (Jarzynski and Olano 2020, "Hash functions for GPU rendering": pcg).
fn mixed(number: u32) -> u32 {
    let state = number * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

// A number in [0, 1) by chance.
fn chance(number: u32) -> f32 {
    return f32(mixed(number)) / 4294967296.0;
}

fn chance_in(cell: vec3<f32>) -> f32 {
    let number = vec3<u32>(vec3<i32>(cell));
    return chance(mixed(mixed(number.x) ^ number.y) ^ number.z);
}

// Edge of a pixel at a place, m.
fn finest_step(position_m: vec3<f32>) -> f32 {
    return max(max(length(dpdx(position_m)), length(dpdy(position_m))), 1e-9);
}

// Opacity from which on something is there: by chance, but the same wherever the camera goes, in cells about as large as a pixel. Between two
// sizes of cells both chances mix, and are spread evenly again (the paper's section 3).
fn threshold(position_m: vec3<f32>, step_m: f32) -> f32 {
    let scale = 1.0 / step_m;
    let sizes = vec2(exp2(floor(log2(scale))), exp2(ceil(log2(scale))));
    let chances = vec2(chance_in(floor(sizes.x * position_m)), chance_in(floor(sizes.y * position_m)));
    let mixing = fract(log2(scale));
    let x = mix(chances.x, chances.y, mixing);
    let a = min(mixing, 1.0 - mixing);
    let low = x * x / max(2.0 * a * (1.0 - a), 1e-6);
    let middle = (x - 0.5 * a) / (1.0 - a);
    let high = 1.0 - (1.0 - x) * (1.0 - x) / max(2.0 * a * (1.0 - a), 1e-6);
    let even = select(select(high, middle, x < 1.0 - a), low, x < a);
    return clamp(even, 1e-6, 1.0);
}

// Opaque where there is more of it than the threshold; else it is not there.
fn kept_or_not(light: vec4<f32>, threshold: f32) -> vec4<f32> {
    if light.a <= threshold {
        discard;
    }
    return vec4(light.rgb / light.a, 1.0);
}
