// Where pixels' rays enter the shell, by its tops and at open borders its walls: one workgroup per face, first to count,
// then to fill the pixels' lists.
#import furrier::constants::OVERFLOW
#import furrier::camera::{view, totals, camera_from_world, ray_through, direction_through, pixel_at, faces_eye, meet, window_of, skin_z, spans, cursors}
#import furrier::faces::{face_corner, face_shape, start_m}
#import furrier::scene::scene

override FILL: bool = false;

// Distance along the ray, m, and face.
@group(3) @binding(1) var<storage, read_write> starts: array<vec2<u32>>;

@compute @workgroup_size(64)
fn entrances(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let face = group.y * groups.x + group.x;
    if face >= scene.face_count {
        return;
    }
    let shape = face_shape(face);
    if !faces_eye(shape) {
        return;
    }
    let window = window_of(
        camera_from_world(face_corner(face, 0u)),
        camera_from_world(face_corner(face, 1u)),
        camera_from_world(face_corner(face, 2u)),
    );
    let width = window.z - window.x;
    let count = width * (window.w - window.y);
    for (var i = local; i < count; i += 64u) {
        let pixel = window.xy + vec2(i % width, i / width);
        let middle = vec2<f32>(pixel) + 0.5;
        let ray = ray_through(middle);
        let meeting = meet(shape, ray);
        let at = pixel_at(pixel);
        if !meeting.met || meeting.z_m >= skin_z(at) {
            continue;
        }
        let slot = atomicAdd(&cursors[at], 1u);
        if FILL {
            if slot < spans[at].end {
                let direction = normalize(direction_through(middle));
                let at_m = start_m(face, meeting.barycentric, meeting.z_m * length(ray), view.eye_m, direction);
                starts[slot] = vec2(bitcast<u32>(at_m), face);
            } else {
                atomicMax(&totals[OVERFLOW], 1u);
            }
        }
    }
}
