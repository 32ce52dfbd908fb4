// One triangle over a whole target.
#define_import_path furrier::whole

fn whole_target(index: u32) -> vec4<f32> {
    let corner = vec2(f32(index & 1u), f32(index >> 1u));
    return vec4(corner * 4.0 - 1.0, 0.0, 1.0);
}
