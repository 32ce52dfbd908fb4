// Many samples to one pixel: a box filter in linear light.

@group(0) @binding(0) var samples: texture_2d<f32>;

// Samples along a pixel's edge.
override SAMPLES: u32 = 2u;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    // One triangle over the whole target.
    let corner = vec2(f32(index & 1u), f32(index >> 1u));
    return vec4(corner * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn fragment(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    let first = vec2<u32>(at.xy) * SAMPLES;
    var sum = vec4(0.0);
    for (var y = 0u; y < SAMPLES; y++) {
        for (var x = 0u; x < SAMPLES; x++) {
            sum += textureLoad(samples, first + vec2(x, y), 0);
        }
    }
    return sum / f32(SAMPLES * SAMPLES);
}
