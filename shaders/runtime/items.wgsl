// What of a coat a picture draws, in its order, and which samples of a pixel the skin leaves to it.
#define_import_path furrier::items

#import furrier::view::view


// A triangle of a shell, or a fin.
struct Item {
    index: u32,
    // Layer in the lower half, 1 above it where it is seen from inside.
    layer: u32,
}

@group(0) @binding(3) var<storage, read> items: array<Item>;
// Of the skin in each pixel: its nearest depth; the share of the pixel that lies behind an edge.
@group(0) @binding(4) var edges: texture_2d<f32>;

// The level of a texture at which one read has the area of a pixel with these derivatives, in texels. Of a pixel that is more than four times
// as long as it is wide, a level has half the length: many layers lie over one another, each a little aside.
fn root_level(dx: vec2<f32>, dy: vec2<f32>) -> f32 {
    let major = max(dot(dx, dx), max(dot(dy, dy), 1e-12));
    return max(0.5 * log2(max(abs(dx.x * dy.y - dx.y * dy.x), 1e-12)), 0.5 * log2(major) - 1.0);
}

// What a texture of the root shows at a pixel.
fn read_root(texture: texture_2d_array<f32>, own: sampler, uv: vec2<f32>, uv_dx: vec2<f32>, uv_dy: vec2<f32>) -> vec4<f32> {
    let size = vec2<f32>(textureDimensions(texture));
    return textureSampleLevel(texture, own, uv, 0, root_level(uv_dx * size, uv_dy * size));
}

// Share of a pixel in which the skin does not hide what is at a place, as the rasteriser gives it.
fn uncovered(clip: vec4<f32>) -> f32 {
    let edge = textureLoad(edges, vec2<u32>(clip.xy), 0).xy;
    return select(1.0, edge.y, clip.z > edge.x);
}

// Reads of the key light's shadow map by what it lights with so many taps.
fn shadow_reads(taps: u32) -> f32 {
    return select(0.0, f32(taps), view.light_count > 0u && view.shadow_bias_m > 0.0);
}
