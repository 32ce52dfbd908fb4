// The nearest skin of every pixel: one workgroup per triangle, first for depths, then for who has them. Both sides are opaque.
#import furrier::scene::{triangles, vertices}
#import furrier::camera::{view, camera_from_world, ray_through, pixel_at, flat_of, meet, window_of, skin_depth, skin_triangle}
#import furrier::scene::scene

// The second pass: the lowest index among the triangles at the nearest depth.
override NAME: bool = false;

@compute @workgroup_size(64)
fn skin(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let triangle = group.y * groups.x + group.x;
    if triangle >= scene.triangle_count {
        return;
    }
    let corners = triangles[triangle].corners;
    let a = camera_from_world(vertices[corners.x].position_m);
    let b = camera_from_world(vertices[corners.y].position_m);
    let c = camera_from_world(vertices[corners.z].position_m);
    let window = window_of(a, b, c);
    let shape = flat_of(a, b, c);
    let width = window.z - window.x;
    let count = width * (window.w - window.y);
    for (var i = local; i < count; i += 64u) {
        let pixel = window.xy + vec2(i % width, i / width);
        let meeting = meet(shape, ray_through(vec2<f32>(pixel) + 0.5));
        if !meeting.met || meeting.z_m <= view.near_m {
            continue;
        }
        let at = pixel_at(pixel);
        let bits = ~bitcast<u32>(meeting.z_m);
        if NAME {
            // Two compilations of one formula may differ in the last bits.
            if atomicLoad(&skin_depth[at]) - bits < 8u {
                atomicMax(&skin_triangle[at], ~triangle);
            }
        } else {
            atomicMax(&skin_depth[at], bits);
        }
    }
}
