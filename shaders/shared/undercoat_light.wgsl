// Light in undercoat, as src/hybrid/undercoat_light.rs.
#define_import_path furrier::undercoat_light

#import furrier::scene::{scene, triangles, lights, tint_at, normal_at, density_at, length_at, table_at}
#import furrier::prism::{barycentric, corners_of, around_corners}
#import furrier::undercoat::decode_value
#import furrier::march::Step
#import furrier::light::light_at
#import furrier::fur_light::{slant_depth, terminator}
#import furrier::law::{HairPlace, angles_of, lit, lit_by_sky, seen_of, worn_of}

// Bytes by level, then corner of sub-elements; of all prisms one after the other.
@group(1) @binding(1) var<storage, read> shadow: array<u32>;

fn shadow_byte(byte: u32) -> f32 {
    return decode_value((shadow[byte >> 2u] >> (8u * (byte & 3u))) & 255u);
}

// Optical depth towards the key light, linear between the three corners and two levels around a point;
// between levels as a flat coat's is.
fn key_depth(triangle: u32, b: vec3<f32>, t: f32) -> f32 {
    let d = triangles[triangle].shadow_splits;
    let around = around_corners(b, d);
    let at = clamp(table_at(2u, t), 0.0, f32(scene.layers));
    let low = min(u32(at), scene.layers - 1u);
    let below = triangles[triangle].shadow_at * (scene.layers + 1u) + low * corners_of(d) + around.corners;
    let above = below + corners_of(d);
    let from_depth = dot(around.weights, vec3(shadow_byte(below.x), shadow_byte(below.y), shadow_byte(below.z)));
    let to_depth = dot(around.weights, vec3(shadow_byte(above.x), shadow_byte(above.y), shadow_byte(above.z)));
    return max(from_depth + (at - f32(low)) * (to_depth - from_depth), 0.0);
}

fn undercoat_ramp(t: f32) -> vec3<f32> {
    let ramp = scene.undercoat_ramp;
    return select(
        mix(ramp[1].xyz, ramp[2].xyz, 2.0 * t - 1.0),
        mix(ramp[0].xyz, ramp[1].xyz, 2.0 * t),
        t < 0.5,
    );
}

struct Appearance {
    albedo: vec3<f32>,
    radiance: vec3<f32>,
}

// Colour of the hair at a step of a ray from `origin_m`, and the radiance it sends against `direction`.
fn undercoat_light(taken: Step, origin_m: vec3<f32>, direction: vec3<f32>) -> Appearance {
    let middle_m = origin_m + direction * (taken.from_m + 0.5 * taken.length_m);
    let b = barycentric(taken.point);
    let t = taken.point.t;
    let albedo = tint_at(taken.triangle, b) * undercoat_ramp(t);
    let worn = worn_of(1u, albedo);
    let factor = density_at(taken.triangle, b) * length_at(taken.triangle, b);
    let above = factor * table_at(1u, t);
    let normal = normal_at(taken.triangle, b);
    let to_eye = -direction;
    let hair_normal = dot(taken.hair, normal);
    let eye_normal = dot(to_eye, normal);
    var radiance = vec3(0.0);
    if any(scene.ambient != vec3(0.0)) {
        let eye_hair = clamp(dot(taken.hair, to_eye), -1.0, 1.0);
        radiance = scene.ambient * lit_by_sky(1u, above, eye_hair, hair_normal, eye_normal, worn, scene.undercoat_crowding);
    }
    let seen = seen_of(1u, above, clamp(dot(taken.hair, to_eye), -1.0, 1.0), hair_normal, eye_normal);
    for (var i = 0u; i < scene.undercoat_light_count; i++) {
        let light = light_at(lights[i], middle_m);
        var open = 1.0;
        var depth = 0.0;
        if i == 0u {
            depth = key_depth(taken.triangle, b, t);
        } else {
            open = terminator(light.to_light, normal);
            if open <= 0.0 {
                continue;
            }
            depth = slant_depth(above, light.to_light, normal, taken.hair);
        }
        let angles = angles_of(taken.hair, light.to_light, to_eye);
        let place = HairPlace(above, depth, dot(light.to_light, to_eye), hair_normal, eye_normal, dot(light.to_light, normal));
        radiance += light.irradiance * open * lit(seen, angles, place, worn, scene.undercoat_crowding);
    }
    return Appearance(albedo, radiance);
}
