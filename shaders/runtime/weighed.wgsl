// Weighted sums of a coat over the skin, which the coat's colours filter.
#import furrier::whole::whole_target

@group(0) @binding(0) var sums: texture_2d<f32>;
@group(0) @binding(1) var passed: texture_2d<f32>;
@group(0) @binding(2) var skin: texture_2d<f32>;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return whole_target(index);
}

@fragment
fn fragment(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    let pixel = vec2<u32>(at.xy);
    let sum = textureLoad(sums, pixel, 0);
    let through = textureLoad(passed, pixel, 0);
    let behind = textureLoad(skin, pixel, 0);
    let covered = 1.0 - through.a;
    let mean = sum.rgb / max(sum.a, 1e-7);
    return vec4(mean * covered + behind.rgb * through.rgb * through.a, covered + behind.a * through.a);
}
