// Leaves out fragments that lie behind an opaque front of others: one thread per pixel. What is left out could not be seen
// whatever else comes in front, so this changes how long sorting takes, never the picture.
#import furrier::scene::scene
#import furrier::camera::{view, pixel_count, spans, cursors}
#import furrier::guard::{opacity_at, along_hair}

@group(3) @binding(0) var<storage, read_write> fragment_z: array<f32>;
@group(3) @binding(1) var<storage, read_write> fragment_point: array<u32>;
@group(3) @binding(2) var<storage, read_write> fragment_share: array<u32>;

// Lists no longer than this are sorted as they are.
const SHORT: u32 = 48u;
// Slices of depth.
const SLICES: u32 = 32u;

@compute @workgroup_size(64)
fn trim(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let at = (group.y * groups.x + group.x) * 64u + local;
    if at >= pixel_count() {
        return;
    }
    let begin = spans[at].begin;
    let end = min(atomicLoad(&cursors[at]), spans[at].end);
    if end - begin <= SHORT {
        return;
    }
    var nearest = fragment_z[begin];
    var farthest = nearest;
    for (var slot = begin + 1u; slot < end; slot++) {
        nearest = min(nearest, fragment_z[slot]);
        farthest = max(farthest, fragment_z[slot]);
    }
    let per_m = f32(SLICES) / max(farthest - nearest, 1e-30);
    var depths: array<f32, SLICES>;
    for (var slot = begin; slot < end; slot++) {
        let share = unpack2x16float(fragment_share[slot]);
        let opacity = share.x * opacity_at(along_hair(fragment_point[slot], share.y));
        let slice = min(u32((fragment_z[slot] - nearest) * per_m), SLICES - 1u);
        depths[slice] -= log(max(1.0 - opacity, 1e-6));
    }
    // Optical depth behind which nothing is seen: of a tenth of what compositing takes for opaque.
    let hidden = -log(0.1 * scene.opaque);
    var sum = 0.0;
    var last = 0u;
    while last < SLICES - 1u && sum + depths[last] < hidden {
        sum += depths[last];
        last++;
    }
    var kept = begin;
    for (var slot = begin; slot < end; slot++) {
        let z_m = fragment_z[slot];
        if min(u32((z_m - nearest) * per_m), SLICES - 1u) <= last {
            fragment_z[kept] = z_m;
            fragment_point[kept] = fragment_point[slot];
            fragment_share[kept] = fragment_share[slot];
            kept++;
        }
    }
    atomicStore(&cursors[at], kept);
}
