// What hides the key light, as it is drawn into the shadow map: skin, wider by its hair across the light but not along it.
#import furrier::view::view
#import furrier::light::light_at

@vertex
fn vertex(@location(0) position_m: vec3<f32>, @location(1) swell_m: vec3<f32>) -> @builtin(position) vec4<f32> {
    let to_light = light_at(view.lights[0], position_m).to_light;
    return view.shadow_from_world * vec4(position_m + swell_m - to_light * dot(to_light, swell_m), 1.0);
}
