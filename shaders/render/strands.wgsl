// Light on guard hair, one thread per point of a strand, as src/render/strands/shade.rs.
#import furrier::scene::{scene, strands, lights, point_of, normal_at, lean_at, density_at, length_at, unit_or}
#import furrier::camera::view
#import furrier::guard::{guard_ramp, root_of}
#import furrier::fur_light::{angles_of, cos_of, guard_lobes, shadow_power, slant_depth, sky_depth, terminator, above_both}

// Radiance by point, three numbers each.
@group(3) @binding(0) var<storage, read_write> looks: array<f32>;

@compute @workgroup_size(64)
fn shade(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) local: u32,
) {
    let index = (group.y * groups.x + group.x) * 64u + local;
    if index >= scene.strand_count * scene.points_per_strand {
        return;
    }
    let strand = strands[index / scene.points_per_strand];
    let i = index % scene.points_per_strand;
    let last = scene.points_per_strand - 1u;
    let b = root_of(strand);
    let normal = normal_at(strand.triangle, b);
    let lean = lean_at(strand.triangle, b, normal);
    let first = index - i;
    let point_m = point_of(index);
    let behind = point_of(first + max(i, 1u) - 1u);
    let along = unit_or(point_of(first + min(i + 1u, last)) - behind, lean);
    // Height along the lean, so that a leaning coat's layers are as thick as its hairs are long.
    let height_m = dot(point_m - point_of(first), normal) / max(dot(lean, normal), 0.05);
    let above = above_both(density_at(strand.triangle, b), length_at(strand.triangle, b), height_m);
    let albedo = strand.tint * guard_ramp(f32(i) / f32(last));
    let to_eye = unit_or(view.eye_m - point_m, normal);

    let power = shadow_power(albedo * scene.guard_albedo);
    var sum = scene.ambient * albedo * scene.guard_albedo * exp(-power * sky_depth(above));
    for (var k = 0u; k < scene.light_count; k++) {
        let light = lights[k];
        let open = terminator(light.to_light, normal);
        if open <= 0.0 {
            continue;
        }
        let angles = angles_of(along, light.to_light, to_eye);
        let s = guard_lobes(angles);
        let scattered = vec3(s.x) + albedo * s.y + albedo * albedo * s.z;
        let depth = slant_depth(above, light.to_light, normal, lean);
        sum += light.irradiance * scattered * exp(-power * depth) * (cos_of(angles.sin_in) * open);
    }
    looks[3u * index] = sum.x;
    looks[3u * index + 1u] = sum.y;
    looks[3u * index + 2u] = sum.z;
}
