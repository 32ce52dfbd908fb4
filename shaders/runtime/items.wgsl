// What of a coat a picture draws, in its order, and which samples of a pixel the skin leaves to it.
#define_import_path furrier::items

#import furrier::view::view

// Reads of an anisotropic sampler of what is painted, at the most.
const PAINTED_READS: f32 = 4.0;

// A triangle of a shell, or a fin.
struct Item {
    index: u32,
    // Layer in the lower half, 1 above it where it is seen from inside.
    layer: u32,
}

@group(0) @binding(3) var<storage, read> items: array<Item>;
// Of the skin in each pixel: its nearest depth; the share of the pixel that lies behind an edge.
@group(0) @binding(4) var edges: texture_2d<f32>;

// Share of a pixel in which the skin does not hide what is at a place, as the rasteriser gives it.
fn uncovered(clip: vec4<f32>) -> f32 {
    let edge = textureLoad(edges, vec2<u32>(clip.xy), 0).xy;
    return select(1.0, edge.y, clip.z > edge.x);
}

// Reads of the key light's shadow map by what it lights with so many taps.
fn shadow_reads(taps: u32) -> f32 {
    return select(0.0, f32(taps), view.light_count > 0u && view.shadow_bias_m > 0.0);
}
