// Brings every pixel's fragments into the order of (depth, id, point): one thread per fragment counts those of its pixel that
// come before it. However many there are, none is dropped.
#import furrier::constants::FRAGMENTS
#import furrier::scene::{scene, strands}
#import furrier::camera::{view, totals, spans, cursors}

@group(3) @binding(0) var<storage, read> fragment_z: array<f32>;
@group(3) @binding(1) var<storage, read> fragment_point: array<u32>;
@group(3) @binding(2) var<storage, read> fragment_pixel: array<u32>;
@group(3) @binding(3) var<storage, read_write> fragment_order: array<u32>;

fn hair_of(point: u32) -> u32 {
    return strands[point / scene.points_per_strand].id;
}

@compute @workgroup_size(64)
fn order(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let slot = (group.y * groups.x + group.x) * 64u + local;
    if slot >= min(atomicLoad(&totals[FRAGMENTS]), view.most_fragments) {
        return;
    }
    let at = fragment_pixel[slot];
    let begin = spans[at].begin;
    let end = min(atomicLoad(&cursors[at]), spans[at].end);
    // A slot that was counted and not filled.
    if slot < begin || slot >= end {
        return;
    }
    let z_m = fragment_z[slot];
    let point = fragment_point[slot];
    var rank = 0u;
    for (var other = begin; other < end; other++) {
        let other_z = fragment_z[other];
        if other_z < z_m {
            rank++;
        } else if other_z == z_m {
            let other_point = fragment_point[other];
            let id = hair_of(point);
            let other_id = hair_of(other_point);
            rank += u32(other_id < id || (other_id == id && other_point < point));
        }
    }
    fragment_order[begin + rank] = slot;
}
