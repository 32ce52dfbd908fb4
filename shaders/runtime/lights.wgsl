// The lights of a picture on hair of a coat: the key, whose way through the coat its pass knows, and those that fill.
#define_import_path furrier::lights

#import furrier::view::view
#import furrier::light::light_at
#import furrier::fur_light::{slant_depth, terminator}
#import furrier::law::{HairPlace, Seen, Worn, angles_of, lit}

// What of the key light arrives.
struct Key {
    // Optical depth towards it.
    depth: f32,
    // Share that nothing else hides.
    open: f32,
}

// Where hair is, which way it points, and how the skin lies under it.
struct Hair {
    position_m: vec3<f32>,
    tangent: vec3<f32>,
    normal: vec3<f32>,
    to_eye: vec3<f32>,
    // Hair area above per skin area.
    above: f32,
    // Hair area per volume times diameter.
    crowding: f32,
}

// Radiance towards the eye of all lights.
fn lit_by_all(hair: Hair, seen: Seen, worn: Worn, key: Key) -> vec3<f32> {
    var radiance = vec3(0.0);
    for (var i = 0u; i < view.light_count; i++) {
        let light = light_at(view.lights[i], hair.position_m);
        var arriving = key;
        if i > 0u {
            arriving.open = terminator(light.to_light, hair.normal);
            arriving.depth = slant_depth(hair.above, light.to_light, hair.normal, hair.tangent);
        }
        if arriving.open <= 0.0 {
            continue;
        }
        let angles = angles_of(hair.tangent, light.to_light, hair.to_eye);
        let place = HairPlace(
            hair.above, arriving.depth, dot(light.to_light, hair.to_eye), dot(hair.tangent, hair.normal),
            dot(hair.to_eye, hair.normal), dot(light.to_light, hair.normal),
        );
        radiance += arriving.open * light.irradiance * lit(seen, angles, place, worn, hair.crowding);
    }
    return radiance;
}
