// Lights from infinitely far away, from a point, and from a point in a cone: src/data/light.rs.
#define_import_path furrier::light

#import furrier::constants::NEAREST_M

struct Light {
    // The unit vector to a light from infinitely far away, the position of any other, m.
    place: vec3<f32>,
    // 1 over the range, 1/m; 0 where it goes on for ever.
    per_range: f32,
    // Irradiance of a light from infinitely far away, of any other irradiance × m², linear RGB.
    strength: vec3<f32>,
    // 0 for a light from infinitely far away, 1 for any other.
    near: f32,
    // Unit vector along the axis of a cone, or zero; what a cosine to it is multiplied by, and what is added.
    axis: vec3<f32>,
    cone_scale: f32,
    cone_offset: f32,
}

// What arrives somewhere.
struct Arriving {
    // Unit vector towards the light.
    to_light: vec3<f32>,
    // Irradiance on a plane at a right angle to it, linear RGB.
    irradiance: vec3<f32>,
}

// What arrives at `p`, m: inverse square, range and cone of KHR_lights_punctual.
fn light_at(light: Light, p: vec3<f32>) -> Arriving {
    if light.near == 0.0 {
        return Arriving(light.place, light.strength);
    }
    let to = light.place - p;
    let length_m = length(to);
    let distance_m = max(length_m, NEAREST_M);
    let to_light = select(vec3(0.0, 1.0, 0.0), to / distance_m, length_m > NEAREST_M);
    let share = distance_m * light.per_range;
    let window = clamp(1.0 - share * share * share * share, 0.0, 1.0);
    let cone = clamp(-dot(to_light, light.axis) * light.cone_scale + light.cone_offset, 0.0, 1.0);
    return Arriving(to_light, light.strength * (window / (distance_m * distance_m) * cone * cone));
}
