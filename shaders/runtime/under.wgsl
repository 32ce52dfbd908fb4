// The skin, behind all that is drawn before it.
#import furrier::whole::whole_target

@group(0) @binding(0) var skin: texture_2d<f32>;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return whole_target(index);
}

@fragment
fn fragment(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    return textureLoad(skin, vec2<u32>(at.xy), 0);
}
