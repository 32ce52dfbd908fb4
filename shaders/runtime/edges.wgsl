// The skin's edges: sampled finer than hair is shaded. Hair behind an edge takes its share of the pixel.
#import furrier::whole::whole_target

@group(0) @binding(0) var depths: texture_depth_multisampled_2d;

struct Pixel {
    // The nearest depth, and the share of the pixel that lies behind an edge.
    @location(0) edge: vec2<f32>,
    // The furthest: what lies behind it is hidden.
    @builtin(frag_depth) depth: f32,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return whole_target(index);
}

@fragment
fn fragment(@builtin(position) at: vec4<f32>) -> Pixel {
    let pixel = vec2<u32>(at.xy);
    let samples = textureNumSamples(depths);
    var nearest = 1.0;
    var furthest = 0.0;
    for (var i = 0u; i < samples; i++) {
        let depth = textureLoad(depths, pixel, i);
        nearest = min(nearest, depth);
        furthest = max(furthest, depth);
    }
    var behind = 0.0;
    for (var i = 0u; i < samples; i++) {
        behind += select(0.0, 1.0, textureLoad(depths, pixel, i) > 0.5 * (nearest + furthest));
    }
    return Pixel(vec2(nearest, behind / f32(samples)), furthest);
}
