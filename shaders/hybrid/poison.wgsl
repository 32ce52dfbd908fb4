// What a film holds before it is drawn: not a number, so that a pixel that is never written shows.
#import furrier::camera::pixel_count

// A number with all bits set; a shader cannot write down one that is not a number.
@group(3) @binding(0) var<storage, read_write> film: array<vec4<u32>>;

@compute @workgroup_size(64)
fn poison(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let at = (group.y * groups.x + group.x) * 64u + local;
    if at < 4u * pixel_count() {
        film[at] = vec4(0xffffffffu);
    }
}
