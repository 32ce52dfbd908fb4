// Rays through the undercoat, one thread per pixel, and the virtual fragments they find.
#import furrier::constants::{MOST_STEPS, MOST_STEP_GROWTH, MOST_STEP_LENGTHENING, OVERFLOW, STEPS, VIRTUAL_FRAGMENTS}
#import furrier::scene::scene
#import furrier::prism::{ShellPoint, barycentric}
#import furrier::camera::{view, totals, pixel_count, pixel_of, direction_through, ray_through, meet, skin_z, spans, cursors,
    opaque_m, heads, NO_SKIN}
#import furrier::faces::{faces, place_on, face_shape}
#import furrier::march::{advance, walk_from, Stepping}
#import furrier::virtual_fragment::{NO_VIRTUAL_FRAGMENT, VirtualFragment, pack_faces}
#import furrier::undercoat_light::undercoat_light

// Some drivers end loops that run longer.
const MOST_ROUNDS: u32 = 60000u;

struct Inside {
    b: vec2<f32>,
    t: f32,
    triangle: u32,
}

@group(3) @binding(1) var<storage, read_write> starts: array<vec2<u32>>;
// Prisms that hold the eye.
@group(3) @binding(2) var<storage, read> inside: array<Inside>;
@group(3) @binding(3) var<storage, read_write> virtual_fragments: array<VirtualFragment>;

// A start: distance along the ray, its rank among equals, and where it is found.
struct Entry {
    at_m: f32,
    triangle: u32,
    // Index into the starts, or past them into the prisms around the eye.
    index: u32,
}

fn before(a: Entry, b: Entry) -> bool {
    return a.at_m < b.at_m || (a.at_m == b.at_m && (a.triangle < b.triangle || (a.triangle == b.triangle && a.index < b.index)));
}

fn entry(index: u32, begin: u32, count: u32) -> Entry {
    if index < count {
        let start = starts[begin + index];
        return Entry(bitcast<f32>(start.x), faces[start.y] >> 4u, index);
    }
    return Entry(0.0, inside[index - count].triangle, index);
}

// Where an entry lies in its prism.
fn place_of(entry: Entry, begin: u32, count: u32, ray: vec3<f32>) -> ShellPoint {
    if entry.index >= count {
        let around = inside[entry.index - count];
        return ShellPoint(around.b, around.t);
    }
    let face = starts[begin + entry.index].y;
    return place_on(face, meet(face_shape(face), ray).barycentric);
}

// Steps of a march on their way to become one virtual_fragment.
struct Gathered {
    radiance: vec3<f32>,
    albedo: vec3<f32>,
    tangent: vec3<f32>,
    from_m: f32,
    to_m: f32,
    depth: f32,
    weight: f32,
}

// A pixel's list as it grows: its first and its last virtual_fragment.
struct Chain {
    head: u32,
    tail: u32,
}

// Puts a virtual fragment where its depth belongs, after those that begin where it does.
fn put(chain: ptr<function, Chain>, group: Gathered, z_per_m: f32) {
    let scale = 1.0 / group.weight;
    if !(group.depth > 0.0 && group.weight > 1e-37) {
        return;
    }
    let slot = atomicAdd(&totals[VIRTUAL_FRAGMENTS], 1u);
    if slot >= view.most_virtual_fragments {
        atomicMax(&totals[OVERFLOW], 1u);
        return;
    }
    let from_m = group.from_m * z_per_m;
    var previous = (*chain).tail;
    var next = NO_VIRTUAL_FRAGMENT;
    if previous != NO_VIRTUAL_FRAGMENT && virtual_fragments[previous].from_m > from_m {
        previous = NO_VIRTUAL_FRAGMENT;
        next = (*chain).head;
        while next != NO_VIRTUAL_FRAGMENT && virtual_fragments[next].from_m <= from_m {
            previous = next;
            next = virtual_fragments[next].next;
        }
    }
    let faces_packed = pack_faces(group.albedo * scale, group.tangent * scale);
    virtual_fragments[slot] = VirtualFragment(group.radiance * scale, from_m, group.to_m * z_per_m, group.depth, faces_packed, next);
    if previous == NO_VIRTUAL_FRAGMENT {
        (*chain).head = slot;
    } else {
        virtual_fragments[previous].next = slot;
    }
    if next == NO_VIRTUAL_FRAGMENT {
        (*chain).tail = slot;
    }
}

// Marches through one pixel; returns how many steps it took.
fn march_pixel(at: u32) -> u32 {
    let middle = vec2<f32>(pixel_of(at)) + 0.5;
    let through_m = direction_through(middle);
    let scale = length(through_m);
    let direction = through_m / scale;
    let z_per_m = 1.0 / scale;
    let ray = ray_through(middle);
    let far_m = skin_z(at) * scale;
    let begin = spans[at].begin;
    let count = min(atomicLoad(&cursors[at]), spans[at].end) - begin;
    let all = count + scene.inside_count;

    var chain = Chain(NO_VIRTUAL_FRAGMENT, NO_VIRTUAL_FRAGMENT);
    var opaque_here_m = NO_SKIN;
    var steps = 0u;
    var last = Entry(-1.0, 0u, 0u);
    var kept_m = -1.0;
    for (var i = 0u; i < all; i++) {
        // The next one by distance; lists are short.
        var nearest = Entry(NO_SKIN, 0xffffffffu, 0u);
        for (var k = 0u; k < all; k++) {
            let candidate = entry(k, begin, count);
            if before(last, candidate) && before(candidate, nearest) {
                nearest = candidate;
            }
        }
        last = nearest;
        // Faces that meet on a ray give one entrance each.
        if kept_m >= 0.0 && nearest.at_m - kept_m < 1e-6 * kept_m {
            continue;
        }
        kept_m = nearest.at_m;
        var walk = walk_from(nearest.at_m, nearest.triangle, place_of(nearest, begin, count, ray));
        var through = 1.0;
        var group = Gathered(vec3(0.0), vec3(0.0), vec3(0.0), 0.0, 0.0, 0.0, 0.0);
        var end_m = 0.0;
        for (var s = 0u; s < MOST_STEPS && walk.alive && through > scene.opaque; s++) {
            // A step's error grows as the square of its depth, and counts as what is left of the ray.
            let scale = min(inverseSqrt(through), MOST_STEP_GROWTH);
            let stepping = Stepping(scene.step_depth * scale, scene.step_layers * min(scale, MOST_STEP_LENGTHENING));
            let taken = advance(&walk, view.eye_m, direction, far_m, stepping);
            if taken.depth <= 0.0 {
                continue;
            }
            steps++;
            let left = through * exp(-taken.depth);
            let weight = through - left;
            let appearance = undercoat_light(taken, view.eye_m, direction);
            if group.depth == 0.0 {
                group.from_m = taken.from_m;
            }
            end_m = taken.from_m + taken.length_m;
            group.to_m = end_m;
            group.depth += taken.depth;
            group.weight += weight;
            group.radiance += weight * appearance.radiance;
            group.albedo += weight * appearance.albedo;
            group.tangent += weight * taken.hair;
            // A new virtual fragment at equal parts of what the march hides in the end.
            if floor((1.0 - left) * scene.groups) > floor((1.0 - through) * scene.groups) {
                put(&chain, group, z_per_m);
                group = Gathered(vec3(0.0), vec3(0.0), vec3(0.0), 0.0, 0.0, 0.0, 0.0);
            }
            through = left;
        }
        put(&chain, group, z_per_m);
        if through <= scene.opaque {
            opaque_here_m = min(opaque_here_m, end_m * z_per_m);
        }
    }
    if steps * (2u + scene.undercoat_light_count) > MOST_ROUNDS {
        atomicMax(&totals[OVERFLOW], 1u);
    }
    opaque_m[at] = opaque_here_m;
    heads[at] = chain.head;
    return steps;
}

var<workgroup> group_steps: atomic<u32>;

@compute @workgroup_size(64)
fn march(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let at = (group.y * groups.x + group.x) * 64u + local;
    if at < pixel_count() {
        atomicAdd(&group_steps, march_pixel(at));
    }
    workgroupBarrier();
    if local == 0u {
        atomicAdd(&totals[STEPS], atomicLoad(&group_steps));
    }
}
