// Many samples to one pixel: a box filter in linear light, and the nearest depth.
#import furrier::whole::whole_target
#import furrier::constants::FULL

@group(0) @binding(0) var samples: texture_2d<f32>;
@group(0) @binding(1) var depths: texture_depth_2d;
// The skin's edges, nearest depth first.
@group(0) @binding(2) var edges: texture_2d<f32>;

// Samples along a pixel's edge.
override SAMPLES: u32 = 2u;

struct Pixel {
    @location(0) light: vec4<f32>,
    @location(1) depth: f32,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return whole_target(index);
}

@fragment
fn fragment(@builtin(position) at: vec4<f32>) -> Pixel {
    let first = vec2<u32>(at.xy) * SAMPLES;
    var sum = vec4(0.0);
    var nearest = 1.0;
    for (var y = 0u; y < SAMPLES; y++) {
        for (var x = 0u; x < SAMPLES; x++) {
            let at_sample = first + vec2(x, y);
            let light = textureLoad(samples, at_sample, 0);
            // What was left out behind it looks like what lies before.
            sum += select(light, light / light.a, light.a >= FULL);
            nearest = min(nearest, min(textureLoad(depths, at_sample, 0), textureLoad(edges, at_sample, 0).x));
        }
    }
    return Pixel(sum / f32(SAMPLES * SAMPLES), nearest);
}
