// Light on hair and on skin, with the shadow that the coat casts on itself (docs/steps/runtime.md).
#define_import_path furrier::shading

#import furrier::constants::PI

// Share of the light that hair's surface reflects without colouring it, and that passes through and comes back
// coloured: Fresnel at normal incidence for keratin (index 1.55) is 0.047, and about as much leaves by the way back.
const SURFACE_LOBE: f32 = 0.05;
const INNER_LOBE: f32 = 0.08;
// Scales tilt both lobes: the first towards the root, the second towards the tip (Marschner et al. 2003, table 1), rad.
const SURFACE_TILT: f32 = -0.12;
const INNER_TILT: f32 = 0.18;
const SURFACE_WIDTH: f32 = 0.18;
const INNER_WIDTH: f32 = 0.30;

// Hair at one point.
struct Hair {
    albedo: vec3<f32>,
    // Mean tangent root to tip, world axes; shorter than 1 by as much as the hairs there disagree.
    tangent: vec3<f32>,
    // Skin normal.
    normal: vec3<f32>,
    // Unit vector towards the viewer.
    to_viewer: vec3<f32>,
}

// A light near the skin's horizon is hidden by the body, gradually, because hair stands out above it.
fn above_horizon(cos_light: f32) -> f32 {
    return smoothstep(-0.25, 0.2, cos_light);
}

// Transmittance for light of which a share `albedo` goes on after each hit: the optical depth that counts is shorter by
// sqrt(1 - albedo), the diffusion exponent of isotropic scattering (van de Hulst 1980). White hair stays white.
fn multiply_scattered(transmittance: f32, albedo: vec3<f32>) -> vec3<f32> {
    return pow(vec3(max(transmittance, 1e-6)), sqrt(vec3(1.0) - min(albedo, vec3(0.99))));
}

fn lobe(angle: f32, width: f32) -> f32 {
    return exp(-0.5 * angle * angle / (width * width)) / (width * sqrt(2.0 * PI));
}

// Radiance towards the viewer per irradiance: the diffuse term of Kajiya and Kay 1989 with sin = sqrt(1 - (l·m)²), where
// `diffuse_reach` of the light arrives per channel, and two lobes along the cone that a tilted cylinder reflects into
// (Marschner et al. 2003), where `direct` arrives.
fn scattered(hair: Hair, to_light: vec3<f32>, direct: f32, diffuse_reach: vec3<f32>) -> vec3<f32> {
    let along_light = dot(hair.tangent, to_light);
    let sin_light = sqrt(max(0.0, 1.0 - along_light * along_light));
    let diffuse = hair.albedo * sin_light / PI * diffuse_reach;

    let agreement = clamp(length(hair.tangent), 1e-3, 1.0);
    let tangent = hair.tangent / agreement;
    // Spread tangents widen the lobes by their own standard deviation.
    let spread = 1.0 - agreement * agreement;
    let half_angle = 0.5 * (asin(clamp(dot(tangent, to_light), -1.0, 1.0)) + asin(clamp(dot(tangent, hair.to_viewer), -1.0, 1.0)));
    let surface = lobe(half_angle - SURFACE_TILT, sqrt(SURFACE_WIDTH * SURFACE_WIDTH + spread));
    let inner = lobe(half_angle - INNER_TILT, sqrt(INNER_WIDTH * INNER_WIDTH + spread));
    // A cylinder reflects most towards where the light comes from in azimuth: cos(phi/2).
    let across_light = to_light - tangent * dot(tangent, to_light);
    let across_viewer = hair.to_viewer - tangent * dot(tangent, hair.to_viewer);
    let cos_phi = dot(across_light, across_viewer) / max(1e-4, length(across_light) * length(across_viewer));
    let azimuth = 0.25 * sqrt(max(0.0, 0.5 + 0.5 * cos_phi));
    let specular = (vec3(SURFACE_LOBE * surface) + INNER_LOBE * hair.albedo * inner) * azimuth * sin_light;
    return (1.0 - SURFACE_LOBE - INNER_LOBE) * diffuse + specular * direct;
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
