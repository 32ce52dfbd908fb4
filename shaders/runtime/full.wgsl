// Where what is drawn lets next to nothing through: what lies behind is not drawn any more. Writes the nearest depth there.
#import furrier::whole::whole_target
#import furrier::constants::FULL

@group(0) @binding(0) var samples: texture_2d<f32>;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return whole_target(index);
}

@fragment
fn fragment(@builtin(position) at: vec4<f32>) {
    if textureLoad(samples, vec2<u32>(at.xy), 0).a < FULL {
        discard;
    }
}
