// The key light's shadow between limbs: a map of the far sides of all that hides it (docs/steps/runtime.md, "Shadow map").
#define_import_path furrier::shadow_map

#import furrier::view::view

@group(0) @binding(1) var key_sampler: sampler_comparison;
@group(0) @binding(2) var key_map: texture_depth_2d;

// Samples of the map on skin and on hair.
const SKIN_TAPS: u32 = 4u;
const HAIR_TAPS: u32 = 1u;
// Cosine between normal and light from which on hair is compared where it is; at a right angle and beyond, at its root.
const LIT: f32 = 0.5;
// The same from which on what is compared is moved by all of the bias.
const MOVED: f32 = 0.0625;

// Share of light number `i` that arrives at hair that is at `position_m` and has its root at `root_m`: 1 for all but the key light.
// Whatever lies on a convex body is moved before its far side, so the coat's own shadow is not counted twice. `taps` of two by two texels
// each: SKIN_TAPS are a tent over three by three; of hair many layers add up, so HAIR_TAPS do.
fn key_share(i: u32, root_m: vec3<f32>, position_m: vec3<f32>, normal: vec3<f32>, to_light: vec3<f32>, taps: u32) -> f32 {
    if i > 0u || view.shadow_bias_m == 0.0 {
        return 1.0;
    }
    let cosine = dot(normal, to_light);
    let place_m = mix(root_m, position_m, clamp(cosine / LIT, 0.0, 1.0));
    let bias_m = view.shadow_bias_m * (view.shadow_from_world * vec4(place_m, 1.0)).w;
    let at = view.shadow_from_world * vec4(place_m + normal * (bias_m * clamp(cosine / MOVED, -1.0, 1.0)), 1.0);
    if at.w <= 0.0 || any(abs(at.xy) >= vec2(at.w)) {
        return 1.0;
    }
    let uv = 0.5 + vec2(0.5, -0.5) * at.xy / at.w;
    let depth = clamp(at.z / at.w, 0.0, 1.0);
    let half_texel = select(0.0, 0.5, taps > 1u) / vec2<f32>(textureDimensions(key_map));
    var share = 0.0;
    for (var tap = 0u; tap < taps; tap++) {
        let corner = 2.0 * vec2(f32(tap & 1u), f32(tap >> 1u)) - 1.0;
        share += textureSampleCompareLevel(key_map, key_sampler, uv + half_texel * corner, depth) / f32(taps);
    }
    // Past the terminator the body's own shadow is the coat's matter: what little is lit there stands high over the edge.
    return mix(share, 1.0, 1.0 - smoothstep(-0.2, 0.0, cosine));
}
