// How hair scatters, and how hair above a point shadows it: src/shade/ and src/volume/scene.rs.
#define_import_path furrier::fur_light

#import furrier::constants::{DEEPEST_HAIR, HORIZON, PI}

// Optical depth towards a light through a flat layer with hair area `above` per skin area.
fn slant_depth(above: f32, to_light: vec3<f32>, normal: vec3<f32>, lean: vec3<f32>) -> f32 {
    let along = dot(to_light, lean);
    return min(above * sqrt(max(1.0 - along * along, 0.0)) / max(dot(to_light, normal), HORIZON), DEEPEST_HAIR);
}

// Share of a light that the body lets pass to hair over skin with this normal.
fn terminator(to_light: vec3<f32>, normal: vec3<f32>) -> f32 {
    let x = clamp((dot(to_light, normal) + 0.35) / 0.35, 0.0, 1.0);
    return x * x * (3.0 - 2.0 * x);
}

// Optical depth towards the whole sky.
fn sky_depth(above: f32) -> f32 {
    return min(1.5 * 0.25 * PI * above, DEEPEST_HAIR);
}
