// Guard hair, undercoat and skin of every pixel into one colour, front to back (Andersen et al. 2016 §3.3, docs/steps/blend.md).
#import furrier::constants::{LIT_POINTS, MOST_BEND}
#import furrier::scene::{scene, triangles, vertices, strands, point_of, unit_or}
#import furrier::camera::{view, pixel_count, pixel_of, direction_through, ray_through, camera_from_world, flat_of, meet,
    skin_triangle, heads}
#import furrier::guard::{guard_ramp, opacity_at, along_hair}
#import furrier::fragments::{Fragment, read_from, next_fragment}
#import furrier::virtual_fragment::{NO_VIRTUAL_FRAGMENT, VirtualFragment, unpack_albedo, unpack_tangent}
#import furrier::skin_light::skin_light

// Equation (4) in place of virtual fragments.
override SIMPLIFIED: bool = false;

@group(3) @binding(4) var<storage, read> virtual_fragments: array<VirtualFragment>;
@group(3) @binding(5) var<storage, read> log_radiance: array<f32>;
// Four planes of the band's pixels: radiance and alpha; albedo and distance; tangent and guard hair's part of alpha; normal and
// undercoat's.
@group(3) @binding(6) var<storage, read_write> film: array<vec4<f32>>;

// What lies in front, all premultiplied.
struct Front {
    radiance: vec3<f32>,
    through: f32,
    albedo: vec3<f32>,
    z_m: f32,
    tangent: vec3<f32>,
    guard: f32,
    normal: vec3<f32>,
    undercoat: f32,
}

// Logarithm of the opaque hair's radiance: shadow, and radiance with it, goes exponentially from lit point to lit point.
fn log_radiance_at(index: u32) -> vec3<f32> {
    return vec3(log_radiance[3u * index], log_radiance[3u * index + 1u], log_radiance[3u * index + 2u]);
}

fn bend_at(index: u32) -> vec3<f32> {
    return log_radiance_at(index - 1u) - 2.0 * log_radiance_at(index) + log_radiance_at(index + 1u);
}

// Radiance of a strand at s in [0, 1] along it: its logarithm is a curve through the lit points.
fn radiance_at(strand: u32, s: f32) -> vec3<f32> {
    let at = s * s * f32(LIT_POINTS - 1u);
    let low = min(u32(at), LIT_POINTS - 2u);
    let part = at - f32(low);
    let first = strand * LIT_POINTS;
    let line = mix(log_radiance_at(first + low), log_radiance_at(first + low + 1u), part);
    // From the middle of three lit points; at the ends the nearest three.
    let bend = bend_at(first + max(low, 1u)) + bend_at(first + min(low + 1u, LIT_POINTS - 2u));
    return exp(line - clamp(bend, vec3(-2.0 * MOST_BEND), vec3(2.0 * MOST_BEND)) * (part - part * part) * 0.25);
}

fn opacity_of(fragment: Fragment) -> f32 {
    return fragment.coverage * opacity_at(along_hair(fragment.point, fragment.along));
}

fn add_hair(front: ptr<function, Front>, fragment: Fragment) {
    let weight = (*front).through * opacity_of(fragment);
    let strand = fragment.point / scene.points_per_strand;
    let s = along_hair(fragment.point, fragment.along);
    let tangent = unit_or(point_of(fragment.point + 1u) - point_of(fragment.point), vec3(0.0));
    (*front).radiance += weight * radiance_at(strand, s);
    (*front).albedo += weight * strands[strand].tint * guard_ramp(s);
    (*front).tangent += weight * tangent;
    (*front).z_m += weight * fragment.z_m;
    (*front).guard += weight;
    (*front).through -= weight;
}

fn add_undercoat(front: ptr<function, Front>, virtual_fragment: VirtualFragment, alpha: f32, z_m: f32) {
    let weight = (*front).through * alpha;
    (*front).radiance += weight * virtual_fragment.radiance;
    (*front).albedo += weight * unpack_albedo(virtual_fragment.faces);
    (*front).tangent += weight * unpack_tangent(virtual_fragment.faces);
    (*front).z_m += weight * z_m;
    (*front).undercoat += weight;
    (*front).through -= weight;
}

// The part of a virtual fragment between two depths.
fn add_part(front: ptr<function, Front>, virtual_fragment: VirtualFragment, from_m: f32, to_m: f32) {
    let extent = virtual_fragment.to_m - virtual_fragment.from_m;
    var share = 1.0;
    if extent > 0.0 {
        share = (to_m - from_m) / extent;
    }
    add_undercoat(front, virtual_fragment, 1.0 - exp(-virtual_fragment.depth * share), 0.5 * (from_m + to_m));
}

fn add_skin(front: ptr<function, Front>, at: u32, middle: vec2<f32>) {
    let named = atomicLoad(&skin_triangle[at]);
    if named == 0u {
        return;
    }
    let c = triangles[~named].corners;
    let shape = flat_of(
        camera_from_world(vertices[c.x].position_m),
        camera_from_world(vertices[c.y].position_m),
        camera_from_world(vertices[c.z].position_m),
    );
    let meeting = meet(shape, ray_through(middle));
    if !meeting.met {
        return;
    }
    let appearance = skin_light(~named, meeting.barycentric, direction_through(middle));
    let weight = (*front).through;
    (*front).radiance += weight * appearance.radiance;
    (*front).albedo += weight * appearance.albedo;
    (*front).normal += weight * appearance.normal;
    (*front).z_m += weight * meeting.z_m;
    (*front).through = 0.0;
}

// Lets what is in front stand for what little is seen through it.
fn fill(front: ptr<function, Front>) {
    let scale = 1.0 / (1.0 - (*front).through);
    (*front).radiance *= scale;
    (*front).albedo *= scale;
    (*front).tangent *= scale;
    (*front).normal *= scale;
    (*front).z_m *= scale;
    (*front).guard *= scale;
    (*front).undercoat *= scale;
    (*front).through = 0.0;
}

@compute @workgroup_size(64)
fn composite(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let at = (group.y * groups.x + group.x) * 64u + local;
    if at >= pixel_count() {
        return;
    }
    var front: Front;
    front.through = 1.0;
    var reader = read_from(at);
    var fragment = next_fragment(&reader);
    var index = heads[at];
    while index != NO_VIRTUAL_FRAGMENT && front.through >= scene.opaque {
        let virtual_fragment = virtual_fragments[index];
        while fragment.real && fragment.z_m <= virtual_fragment.from_m && front.through >= scene.opaque {
            add_hair(&front, fragment);
            fragment = next_fragment(&reader);
        }
        if SIMPLIFIED {
            var alpha = 1.0 - exp(-virtual_fragment.depth);
            var unoccluded = 1.0;
            var ahead = reader;
            var behind = fragment;
            while behind.real && unoccluded >= scene.opaque && alpha > 0.0 {
                // Weighted by the fragment's own opacity, so that a hair's thinner share of a pixel takes less.
                let own = opacity_of(behind) * unoccluded;
                alpha -= own * exp(-scene.attenuation_per_m * (behind.z_m - virtual_fragment.from_m));
                unoccluded -= own;
                behind = next_fragment(&ahead);
            }
            add_undercoat(&front, virtual_fragment, max(alpha, 0.0), virtual_fragment.from_m);
        } else {
            var from_m = virtual_fragment.from_m;
            while fragment.real && fragment.z_m < virtual_fragment.to_m && front.through >= scene.opaque {
                let to_m = max(fragment.z_m, from_m);
                add_part(&front, virtual_fragment, from_m, to_m);
                add_hair(&front, fragment);
                from_m = to_m;
                fragment = next_fragment(&reader);
            }
            if virtual_fragment.to_m > from_m || virtual_fragment.from_m == virtual_fragment.to_m {
                add_part(&front, virtual_fragment, from_m, virtual_fragment.to_m);
            }
        }
        index = virtual_fragment.next;
    }
    while fragment.real && front.through >= scene.opaque {
        add_hair(&front, fragment);
        fragment = next_fragment(&reader);
    }
    let middle = vec2<f32>(pixel_of(at)) + 0.5;
    if front.through < scene.opaque {
        fill(&front);
    } else {
        add_skin(&front, at, middle);
    }

    let count = pixel_count();
    let distance = front.z_m * length(ray_through(middle));
    var planes = array(
        vec4(front.radiance, 1.0 - front.through),
        vec4(front.albedo, distance),
        vec4(front.tangent, front.guard),
        vec4(front.normal, front.undercoat),
    );
    for (var plane = 0u; plane < 4u; plane++) {
        let slot = plane * count + at;
        film[slot] = planes[plane];
    }
}
