// Light on hair and on skin, with the shadow that the coat casts on itself (docs/steps/runtime.md).
#define_import_path furrier::shading

#import furrier::constants::PI

// A light near the skin's horizon is hidden by the body, gradually, because hair stands out above it.
fn above_horizon(cos_light: f32) -> f32 {
    return smoothstep(-0.35, 0.1, cos_light);
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
