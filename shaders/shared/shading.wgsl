// Light on hair and on skin, with the shadow that the coat casts on itself (docs/steps/runtime.md).
#define_import_path furrier::shading

#import furrier::constants::PI

// Least rise of light over flat skin.
const LEAST_STEEP: f32 = 0.02;

// How far light comes through hair that thins out with height, over `scale_m`, the height at which it is 1/e: what of it lies along
// the way over what lies straight above. `rise` is how much higher a metre along the light is; the skin bends away from it by
// `bend_per_m`. For a flat coat it is 1/rise; else Chapman's function, simply.
fn way_up(rise: f32, bend_per_m: f32, scale_m: f32) -> f32 {
    let bent = max(bend_per_m, 0.0) * scale_m;
    let steep = abs(rise);
    let out = 2.0 / max(steep + sqrt(steep * steep + 16.0 / PI * bent), 2.0 * LEAST_STEEP);
    if rise >= 0.0 {
        return out;
    }
    // Down to where it is level, and up again.
    let level = sqrt(PI / max(bent, 1e-6));
    return level * exp(min(steep * steep / max(4.0 * bent, 1e-6), 20.0)) - out;
}

// The same where the coat ends after `border_m` along the light, over skin that is flat up to there.
fn way_to_border(rise: f32, border_m: f32, scale_m: f32) -> f32 {
    let ahead = border_m / max(scale_m, 1e-9);
    let up = clamp(ahead * rise, -20.0, 80.0);
    return select(ahead * (1.0 - exp(-up)) / up, ahead * (1.0 - 0.5 * up), abs(up) < 1e-3);
}

// Share of a light that comes past the edge of the skin to hair at `height_m` over it, where the coat ends after `border_m` along the
// light.
fn past_border(rise: f32, border_m: f32, height_m: f32) -> f32 {
    return 1.0 - smoothstep(0.3, 1.0, -rise * border_m / max(height_m, 1e-9));
}

// Share of a light that comes by the skin to hair at `height_m` over it: below the horizon it is hidden by the body, unless the
// skin bends away.
fn past_skin(rise: f32, bend_per_m: f32, height_m: f32) -> f32 {
    let sunk_m = rise * rise / max(4.0 * bend_per_m, 1e-6);
    return select(1.0 - smoothstep(0.3, 1.0, sunk_m / max(height_m, 1e-9)), 1.0, rise >= 0.0);
}

// Radiance of bare or furred skin: Lambert, and for what shines (eyes, noses) a Blinn-Phong lobe with Schlick's
// Fresnel term, normalised (Akenine-Moller et al. 2018, ch. 9).
fn skin_radiance(albedo: vec3<f32>, normal: vec3<f32>, to_viewer: vec3<f32>, to_light: vec3<f32>, gloss: f32) -> vec3<f32> {
    let cos_light = max(0.0, dot(normal, to_light));
    let half_way = normalize(to_light + to_viewer);
    let fresnel = 0.04 + 0.96 * pow(1.0 - max(0.0, dot(half_way, to_viewer)), 5.0);
    let exponent = 60.0;
    let highlight = fresnel * (exponent + 2.0) / (8.0 * PI) * pow(max(0.0, dot(normal, half_way)), exponent);
    return (albedo / PI + gloss * highlight) * cos_light;
}
