// Light on guard hair, one thread per strand, as src/hybrid/guard_light.rs.
#import furrier::constants::{AT_BORDER, LIT_POINTS, NOTHING}
#import furrier::scene::{scene, triangles, Strand, strands, lights, point_of, normal_at, lean_at, density_at, length_at, unit_or}
#import furrier::light::light_at
#import furrier::camera::view
#import furrier::guard::{guard_ramp, root_of}
#import furrier::fur_light::{slant_depth, terminator}
#import furrier::scene::above_both
#import furrier::law::{HairPlace, angles_of, lit, lit_by_sky, seen_of, worn_of}
#import furrier::mean_shadow::{mean_depths, tips_m}
#import furrier::undercoat_light::key_depth

// Logarithms of radiance, LIT_POINTS of each strand, three numbers each.
@group(3) @binding(0) var<storage, read_write> log_radiance: array<f32>;

// Mean of the two segments that meet in point `i` of a strand, twice their length.
fn step_at(first: u32, i: u32) -> vec3<f32> {
    let last = scene.points_per_strand - 1u;
    let step = point_of(first + min(i + 1u, last)) - point_of(first + max(i, 1u) - 1u);
    return step * select(1.0, 2.0, i == 0u || i >= last);
}

// Optical depth towards the key light: a hair is shadowed as the column over its own root is at its height, in the mean, but
// beside an open border, where clumps are seen from their sides, with its clumps.
fn depth_of(triangle: u32, b: vec3<f32>, height_m: f32, length: f32) -> f32 {
    let t = height_m / max(scene.undercoat_top_m * length, 1e-30);
    let root = triangles[triangle];
    if (root.traits & AT_BORDER) != 0u && root.shadow_at != NOTHING && t <= 1.0 {
        return key_depth(triangle, b, max(t, 0.0));
    }
    let depths = mean_depths(triangle, b, height_m / max(tips_m() * length, 1e-30));
    return depths.x + depths.y;
}

// Logarithm of what a strand sends to the eye at its lit point `i`.
fn log_radiance_at(strand: Strand, first: u32, i: u32) -> vec3<f32> {
    let s = sqrt(f32(i) / f32(LIT_POINTS - 1u));
    let at = s * f32(scene.points_per_strand - 1u);
    let segment = min(u32(at), scene.points_per_strand - 2u);
    let share = at - f32(segment);
    let b = root_of(strand);
    let normal = normal_at(strand.triangle, b);
    let lean = lean_at(strand.triangle, b, normal);
    let point_m = mix(point_of(first + segment), point_of(first + segment + 1u), share);
    // The hair's direction turns evenly from point to point.
    let along = unit_or(mix(step_at(first, segment), step_at(first, segment + 1u), share), lean);
    // Height along the lean, so that a leaning coat's layers are as thick as its hairs are long.
    let height_m = dot(point_m - point_of(first), normal) / max(dot(lean, normal), 0.05);
    let length = length_at(strand.triangle, b);
    let above = above_both(density_at(strand.triangle, b), length, height_m);
    let albedo = strand.tint * guard_ramp(s);
    let to_eye = unit_or(view.eye_m - point_m, normal);

    let worn = worn_of(0u, albedo);
    let hair_normal = dot(along, normal);
    let eye_normal = dot(to_eye, normal);
    let crowding = scene.guard_crowding * density_at(strand.triangle, b);
    var sum = vec3(0.0);
    if any(scene.ambient != vec3(0.0)) {
        let eye_hair = clamp(dot(along, to_eye), -1.0, 1.0);
        sum = scene.ambient * lit_by_sky(0u, above, eye_hair, hair_normal, eye_normal, worn, crowding);
    }
    let seen = seen_of(0u, above, clamp(dot(along, to_eye), -1.0, 1.0), hair_normal, eye_normal);
    for (var k = 0u; k < scene.light_count; k++) {
        let light = light_at(lights[k], point_m);
        var open = 1.0;
        var depth = 0.0;
        if k == 0u {
            depth = depth_of(strand.triangle, b, height_m, length);
        } else {
            open = terminator(light.to_light, normal);
            if open <= 0.0 {
                continue;
            }
            depth = slant_depth(above, light.to_light, normal, lean);
        }
        let angles = angles_of(along, light.to_light, to_eye);
        let place = HairPlace(above, depth, dot(light.to_light, to_eye), hair_normal, eye_normal, dot(light.to_light, normal));
        sum += light.irradiance * open * lit(seen, angles, place, worn, crowding);
    }
    return log(max(sum, vec3(1.1754944e-38)));
}

fn put(index: u32, log_rgb: vec3<f32>) {
    log_radiance[3u * index] = log_rgb.x;
    log_radiance[3u * index + 1u] = log_rgb.y;
    log_radiance[3u * index + 2u] = log_rgb.z;
}

@compute @workgroup_size(64)
fn shade(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let index = (group.y * groups.x + group.x) * 64u + local;
    if index >= scene.strand_count {
        return;
    }
    let strand = strands[index];
    let first = index * scene.points_per_strand;
    for (var i = 0u; i < LIT_POINTS; i++) {
        put(index * LIT_POINTS + i, log_radiance_at(strand, first, i));
    }
}
