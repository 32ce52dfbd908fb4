// Fins: quads on edges near the silhouette, with hair seen from the side (Lengyel et al. 2001 §2.3).
#import furrier::view::{view, ray_direction}
#import furrier::light::light_at
#import furrier::shading::above_horizon
#import furrier::law::{HairPlace, angles_of, lit, lit_by_sky, worn_of}
#import furrier::looks::layer_looks
#import furrier::shadow_map::key_share
#import furrier::constants::{INVISIBLE, LEAST_CLEAR, LEAST_COSINE}
#import furrier::coat::{CoatVertex, Paint, Root, root_of, tile, depth_of_opacity, presence, closeness}

// Texels along the edge per texel along the hair that one fetch may average.
const MAX_STRETCH: f32 = 4.0;

struct FinEdge {
    // Coat vertices of its ends.
    ends: vec2<u32>,
    // Interval of the fin texture.
    u: vec2<f32>,
    // Thickness of hair it stands for over the texture's.
    thickness: f32,
    // The same, m.
    spacing_m: f32,
}

@group(2) @binding(0) var<storage, read> vertices: array<CoatVertex>;
@group(2) @binding(1) var<storage, read> fins: array<FinEdge>;
@group(2) @binding(2) var<uniform> paint: Paint;
@group(2) @binding(3) var colour_sampler: sampler;
@group(2) @binding(4) var colour_texture: texture_2d_array<f32>;
@group(2) @binding(5) var painted_sampler: sampler;
@group(2) @binding(6) var painted_texture: texture_2d_array<f32>;
@group(3) @binding(0) var fin_sampler: sampler;
@group(3) @binding(1) var fin_albedo: texture_2d_array<f32>;
@group(3) @binding(2) var fin_tangent: texture_2d_array<f32>;

struct Varyings {
    @builtin(position) clip: vec4<f32>,
    @location(0) position_m: vec3<f32>,
    @location(1) uv: vec2<f32>,
    @location(2) offset_m: vec3<f32>,
    @location(3) normal: vec3<f32>,
    @location(4) tint: vec4<f32>,
    @location(5) @interpolate(flat) along: vec3<f32>,
    @location(6) @interpolate(flat) across: vec3<f32>,
    // Optical depth over the texture's.
    @location(7) @interpolate(flat) weight: f32,
    @location(8) root: vec4<f32>,
    @location(9) longest: f32,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Varyings {
    let fin = fins[index / 6u];
    // Two triangles of the quad (end, height): 00 10 01, 01 10 11.
    var corners = array(vec2(0u, 0u), vec2(1u, 0u), vec2(0u, 1u), vec2(0u, 1u), vec2(1u, 0u), vec2(1u, 1u));
    let corner = corners[index % 6u];
    let start = vertices[fin.ends.x];
    let end = vertices[fin.ends.y];
    let edge = end.position_m - start.position_m;
    let rise = 0.5 * (start.offset_m + end.offset_m);
    let middle = 0.5 * (start.position_m + end.position_m + rise);

    let across = cross(edge, rise);
    let size = length(across);
    let facing = abs(dot(across, ray_direction(middle))) / max(size, 1e-20);
    let weight = max(0.0, 2.0 * facing - 1.0);

    var own = start;
    if corner.x == 1u {
        own = end;
    }
    let height = f32(corner.y);
    var out: Varyings;
    out.position_m = own.position_m + height * own.offset_m;
    out.uv = vec2(select(fin.u.x, fin.u.y, corner.x == 1u), 1.0 - height);
    out.offset_m = own.offset_m;
    out.normal = own.normal;
    out.tint = own.tint;
    out.root = own.root;
    out.longest = own.longest;
    out.along = normalize(edge + vec3(0.0, 0.0, 1e-20));
    out.across = across / max(size, 1e-20);
    // A slab of hair seen aslant is as much thicker.
    out.weight = closeness(length(rise), fin.spacing_m) * fin.thickness * weight / max(facing, 0.5);
    if weight > 0.0 && size > 0.0 {
        out.clip = view.clip_from_world * vec4(out.position_m, 1.0);
    } else {
        out.clip = vec4(0.0, 0.0, -1.0, 1.0);
    }
    return out;
}

@fragment
fn fragment(in: Varyings) -> @location(0) vec4<f32> {
    // Where fins stand close, a pixel spans many texels along the edge and few along the hair. A mip that holds the former
    // would mix roots and tips, so no more of the width counts than a sampler can take apart.
    let size = vec2<f32>(textureDimensions(fin_albedo).xy);
    let root_dx = dpdx(in.root);
    let root_dy = dpdy(in.root);
    var root = Root(1.0, 1.0);
    if paint.has_painted > 0u {
        root = root_of(textureSampleGrad(painted_texture, painted_sampler, in.root.zw, 0, root_dx.zw, root_dy.zw), in.longest);
    }
    var tint = in.tint;
    if paint.has_colour > 0u {
        tint = vec4(tint.rgb * textureSampleGrad(colour_texture, colour_sampler, in.root.xy, 0, root_dx.xy, root_dy.xy).rgb, tint.w);
    }
    // Shorter hair ends lower: the texture is squeezed to it.
    let squeeze = 1.0 / max(root.share, 1e-6);
    let uv = vec2(in.uv.x, 1.0 - (1.0 - in.uv.y) * squeeze);
    let uv_dx = dpdx(in.uv) * vec2(1.0, squeeze);
    let uv_dy = dpdy(in.uv) * vec2(1.0, squeeze);
    let offset_m = in.offset_m * root.share;
    let texels = vec2(length(vec2(uv_dx.x, uv_dy.x)), length(vec2(uv_dx.y, uv_dy.y))) * size;
    let narrowed = vec2(min(1.0, MAX_STRETCH * max(texels.y, 1.0) / max(texels.x, 1e-6)), 1.0);
    let surface = textureSampleGrad(fin_albedo, fin_sampler, uv, 0, uv_dx * narrowed, uv_dy * narrowed);
    let medium = textureSampleGrad(fin_tangent, fin_sampler, uv, 0, uv_dx * narrowed, uv_dy * narrowed);
    if uv.y < 0.0 {
        discard;
    }
    let present = tint.w * root.density * presence(offset_m);
    let depth = depth_of_opacity(surface.a) * in.weight * present;
    let opacity = 1.0 - exp(-depth);
    if opacity < INVISIBLE {
        discard;
    }

    let stored = (medium.xyz * 255.0 - 128.0) / 127.0;
    let up = normalize(in.offset_m);
    let tangent = normalize(stored.x * in.along + stored.y * in.across + stored.z * up + up * 1e-6);
    let world_ray = ray_direction(in.position_m);
    let normal = normalize(in.normal);
    // What stands out at the outline is guard hair.
    let look = 0u;
    let crowding = layer_looks[tile.layers - 1u].crowding;
    let worn = worn_of(look, surface.rgb * tint.rgb);
    let to_eye = -world_ray;
    let hair_normal = dot(tangent, normal);
    let eye_normal = dot(to_eye, normal);
    let above = -log(max(medium.a, LEAST_CLEAR)) * present;
    var radiance = vec3(0.0);
    if any(view.ambient != vec3(0.0)) {
        radiance = view.ambient * lit_by_sky(look, above, dot(tangent, to_eye), hair_normal, eye_normal, worn, crowding);
    }
    let root_m = in.position_m - (1.0 - in.uv.y) * in.offset_m;
    for (var i = 0u; i < view.light_count; i++) {
        let light = light_at(view.lights[i], in.position_m);
        let cos_light = dot(normal, light.to_light);
        let angles = angles_of(tangent, light.to_light, to_eye);
        let lateral = sqrt(max(0.0, 1.0 - angles.sin_in * angles.sin_in)) / max(abs(cos_light), LEAST_COSINE);
        let here = HairPlace(above, above * lateral, dot(light.to_light, to_eye), hair_normal, eye_normal, cos_light);
        let reaching = light.irradiance * key_share(i, root_m, in.position_m, normal, light.to_light);
        radiance += above_horizon(cos_light) * reaching * lit(look, angles, here, worn, crowding);
    }
    return vec4(radiance * opacity, opacity);
}
