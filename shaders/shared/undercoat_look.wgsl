// Light in undercoat, as src/render/march/light.rs.
#define_import_path furrier::undercoat_look

#import furrier::scene::{scene, triangles, lights, tint_at, normal_at, density_at, length_at, table_at}
#import furrier::prism::{barycentric, subelement}
#import furrier::undercoat::decode_value
#import furrier::march::Step
#import furrier::fur_light::{angles_of, cos_of, kajiya_kay, shadow_power, slant_depth, sky_depth, terminator}

// Bytes by layer, then sub-element; of all prisms one after the other.
@group(1) @binding(1) var<storage, read> shadow: array<u32>;

fn shadow_byte(byte: u32) -> f32 {
    return decode_value((shadow[byte >> 2u] >> (8u * (byte & 3u))) & 255u);
}

// Optical depth of undercoat towards the key light, linear between the middles of layers.
fn key_depth(triangle: u32, b: vec3<f32>, t: f32) -> f32 {
    let d = triangles[triangle].shadow_splits;
    let first = triangles[triangle].shadow_at * scene.layers + subelement(b, d);
    let at = clamp(t * f32(scene.layers) - 0.5, 0.0, f32(scene.layers - 1u));
    let low = u32(at);
    let from_depth = shadow_byte(first + (low << (2u * d)));
    let to_depth = shadow_byte(first + (min(low + 1u, scene.layers - 1u) << (2u * d)));
    return from_depth + (at - f32(low)) * (to_depth - from_depth);
}

fn undercoat_ramp(t: f32) -> vec3<f32> {
    let ramp = scene.undercoat_ramp;
    return select(
        mix(ramp[1].xyz, ramp[2].xyz, 2.0 * t - 1.0),
        mix(ramp[0].xyz, ramp[1].xyz, 2.0 * t),
        t < 0.5,
    );
}

struct Look {
    albedo: vec3<f32>,
    radiance: vec3<f32>,
}

// Colour of the hair at a step and the radiance it sends against `direction`.
fn undercoat_look(taken: Step, direction: vec3<f32>) -> Look {
    let b = barycentric(taken.place);
    let t = taken.place.t;
    let albedo = tint_at(taken.triangle, b) * undercoat_ramp(t);
    let power = shadow_power(albedo * scene.undercoat_albedo);
    let factor = density_at(taken.triangle, b) * length_at(taken.triangle, b);
    let own = factor * table_at(1u, t);
    let above = factor * table_at(2u, t);
    let normal = normal_at(taken.triangle, b);
    var radiance = scene.ambient * albedo * scene.undercoat_albedo * exp(-power * sky_depth(above));
    for (var i = 0u; i < scene.undercoat_light_count; i++) {
        let light = lights[i];
        let open = terminator(light.to_light, normal);
        if open <= 0.0 {
            continue;
        }
        var depth = 0.0;
        if i == 0u {
            depth = key_depth(taken.triangle, b, t) + slant_depth(above - own, light.to_light, normal, taken.hair);
        } else {
            depth = slant_depth(above, light.to_light, normal, taken.hair);
        }
        let angles = angles_of(taken.hair, light.to_light, -direction);
        let scattered = kajiya_kay(angles);
        radiance += light.irradiance * (albedo * scattered.x + scattered.y) * exp(-power * depth)
            * (cos_of(angles.sin_in) * open);
    }
    return Look(albedo, radiance);
}
