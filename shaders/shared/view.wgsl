// What every pass that draws a picture knows: the camera and the lights.
#define_import_path furrier::view

#import furrier::light::Light
#import furrier::constants::MAX_LIGHTS

struct View {
    clip_from_world: mat4x4<f32>,
    // Perspective: the eye, m, and 1. Orthographic: the unit vector towards the viewer, and 0.
    eye: vec4<f32>,
    // Radiance that comes from everywhere, linear RGB.
    ambient: vec3<f32>,
    light_count: u32,
    lights: array<Light, MAX_LIGHTS>,
    // World to the clip space of the key light's shadow map.
    shadow_from_world: mat4x4<f32>,
    // How far what is compared with it is moved towards the light where w is 1, m; 0 without a map.
    shadow_bias_m: f32,
}

@group(0) @binding(0) var<uniform> view: View;

// Unit vector along the ray that sees `position_m`, away from the viewer.
fn ray_direction(position_m: vec3<f32>) -> vec3<f32> {
    return normalize(position_m * view.eye.w - view.eye.xyz);
}
