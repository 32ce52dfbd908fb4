// What bare or furred skin looks like, as src/hybrid/skin.rs.
#define_import_path furrier::skin_light

#import furrier::constants::PI
#import furrier::scene::{scene, lights, position_at, normal_at, lean_at, tint_at, density_at, length_at}
#import furrier::light::light_at
#import furrier::fur_light::{sky_depth, slant_depth, terminator}
#import furrier::scene::above_both
#import furrier::mean_shadow::{mean_depths, tips_m}

struct SkinLook {
    radiance: vec3<f32>,
    albedo: vec3<f32>,
    normal: vec3<f32>,
}

// Skin where a ray from the eye along `direction` meets a triangle: diffuse, under all of its hair.
fn skin_light(triangle: u32, b: vec3<f32>, direction: vec3<f32>) -> SkinLook {
    let outside = normal_at(triangle, b);
    let back = dot(direction, outside) > 0.0;
    let normal = select(outside, -outside, back);
    let lean = lean_at(triangle, b, normal);
    let albedo = tint_at(triangle, b) * scene.skin_factor;
    // The back of the skin is bare.
    let above = select(above_both(density_at(triangle, b), length_at(triangle, b), 0.0), 0.0, back);
    let at_m = position_at(triangle, b);
    var radiance = scene.ambient * albedo * exp(-sky_depth(above));
    for (var i = 0u; i < scene.light_count; i++) {
        let light = light_at(lights[i], at_m);
        let cosine = dot(light.to_light, normal);
        if cosine > 0.0 {
            var depth = slant_depth(above, light.to_light, normal, lean);
            if i == 0u && !back && tips_m() > 0.0 {
                let depths = mean_depths(triangle, b, 0.0);
                depth = depths.x + depths.y;
            }
            let shadow = exp(-depth);
            radiance += light.irradiance * albedo * (cosine * shadow * terminator(light.to_light, normal) / PI);
        }
    }
    return SkinLook(radiance, albedo, normal);
}
