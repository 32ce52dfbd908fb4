// Skin: opaque, with the base colour of the asset; under a coat it lies in the coat's shadow.
#import furrier::view::{view, ray_direction}
#import furrier::light::light_at
#import furrier::shading::skin_radiance
#import furrier::items::shadow_reads
#import furrier::shadow_map::{SKIN_TAPS, key_share}
#import furrier::constants::{FADE_BELOW, LEAST_COSINE}
#import furrier::coat::{hair_sampler, albedo_texture, area_above}

@group(2) @binding(0) var base_sampler: sampler;
@group(2) @binding(1) var base_texture: texture_2d_array<f32>;
@group(2) @binding(2) var painted_sampler: sampler;
@group(2) @binding(3) var painted_texture: texture_2d_array<f32>;

struct Varyings {
    @invariant @builtin(position) clip: vec4<f32>,
    // Within the triangle, or a place beyond an outline would stand behind the body, in its shadow.
    @location(0) @interpolate(perspective, centroid) position_m: vec3<f32>,
    @location(1) @interpolate(perspective, centroid) normal: vec3<f32>,
    @location(2) colour: vec3<f32>,
    @location(3) uv: vec2<f32>,
    @location(4) coat_uv: vec2<f32>,
    @location(5) coat_density: f32,
    @location(6) painted_uv: vec2<f32>,
}

@vertex
fn vertex(
    @location(0) position_m: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) colour: vec3<f32>,
    @location(3) uv: vec2<f32>,
    @location(4) coat_uv: vec2<f32>,
    @location(5) coat_density: f32,
    @location(6) painted_uv: vec2<f32>,
) -> Varyings {
    let clip = view.clip_from_world * vec4(position_m, 1.0);
    return Varyings(clip, position_m, normal, colour, uv, coat_uv, coat_density, painted_uv);
}

// Whether it is drawn, or 4 for what it costs: fragments in red, reads of texels in green; or 5 for its hair: optical depth from outside in red,
// and in green whether there is any.
override MEASURE: u32 = 0u;
// Reads of the tile, of what is painted and of the base colour, at the most that their samplers do.
const READS: f32 = 13.0;
// Skin that is seen lies at a border or in a parting, where light finds the way that the eye found.
const DEEPEST_SKIN: f32 = 1.5;

@fragment
fn fragment(in: Varyings) -> @location(0) vec4<f32> {
    // Layer 0 of the tile: colour factor of the skin under hair, and how much light comes through.
    let cover = textureSample(albedo_texture, hair_sampler, in.coat_uv, 0);
    // Density in red, length in green; white where nothing is painted.
    let painted = textureSample(painted_texture, painted_sampler, in.painted_uv, 0);
    if MEASURE == 4u {
        return vec4(1.0, READS + shadow_reads(SKIN_TAPS), 0.0, 0.0);
    }
    let furred = smoothstep(0.0, FADE_BELOW, painted.g) * select(0.0, 1.0, in.coat_density > 0.0);
    let hair_depth = area_above(cover.a) * in.coat_density * painted.r * furred;
    if MEASURE == 5u {
        return vec4(hair_depth, furred, 0.0, 1.0);
    }
    let base = in.colour * textureSample(base_texture, base_sampler, in.uv, 0).rgb;
    let albedo = base * mix(vec3(1.0), cover.rgb, furred);
    let world_ray = ray_direction(in.position_m);
    let turned = normalize(in.normal);
    let normal = select(turned, -turned, dot(turned, world_ray) > 0.0);
    let outside_depth = min(hair_depth, DEEPEST_SKIN);
    let gloss = 1.0 - furred;

    var radiance = albedo * view.ambient * exp(-outside_depth);
    for (var i = 0u; i < view.light_count; i++) {
        let light = light_at(view.lights[i], in.position_m);
        let cos_light = dot(turned, light.to_light);
        // Upright hair of which 45 degrees is the stored case: tan θ.
        let slope = sqrt(max(0.0, 1.0 - cos_light * cos_light)) / max(abs(cos_light), LEAST_COSINE);
        let shadow = exp(-outside_depth * max(slope, 0.3));
        let reaching = light.irradiance * key_share(i, in.position_m, in.position_m, turned, light.to_light, SKIN_TAPS);
        radiance += reaching * shadow * skin_radiance(albedo, normal, -world_ray, light.to_light, gloss);
    }
    return vec4(radiance, 1.0);
}
