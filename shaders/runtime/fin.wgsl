// Fins: quads on edges near the silhouette, with hair seen from the side (Lengyel et al. 2001 §2.3).
#import furrier::view::{view, ray_direction}
#import furrier::light::light_at
#import furrier::blending::{Shaded, Weighted, chance, plain, weighted_of, finest_step, kept_or_not, threshold}
#import furrier::items::{items, uncovered, shadow_reads, read_root, root_level}
#import furrier::lights::{Hair, Key, lit_by_all}
#import furrier::shading::{past_skin, way_up}
#import furrier::law::{cos_of, lit_by_sky, seen_of, worn_of}
#import furrier::looks::layer_looks
#import furrier::shadow_map::{HAIR_TAPS, key_share}
#import furrier::constants::{INVISIBLE, LEAST_COSINE}
#import furrier::coat::{CoatVertex, Paint, Root, root_of, tile, slabs, area_above, presence, thinned, closeness, at_outline, nearness, STRIPS}

// Whether it is drawn, or 4 for what it costs: fragments in red, reads of texels in green.
override MEASURE: u32 = 0u;
// Reads of both textures of a fin.
const FIN_READS: f32 = 2.0;
// Least of how wide apart hair stands over a hollow, or texels of next to nothing would be opaque.
const LEAST_SPREAD: f32 = 0.5;
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
    @location(10) bend_per_m: f32,
    // Cosine between normal and view.
    @location(11) @interpolate(flat) cos_view: f32,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Varyings {
    let fin = fins[items[index / 6u].index];
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
    out.bend_per_m = own.bend_per_m;
    out.along = normalize(edge + vec3(0.0, 0.0, 1e-20));
    out.across = across / max(size, 1e-20);
    out.cos_view = dot(normalize(start.normal + end.normal), ray_direction(middle));
    // A slab of hair seen aslant is as much thicker.
    out.weight = closeness(length(rise), fin.spacing_m) * fin.thickness * weight / max(facing, 0.5);
    if weight > 0.0 && size > 0.0 {
        out.clip = view.clip_from_world * vec4(out.position_m, 1.0);
    } else {
        out.clip = vec4(0.0, 0.0, -1.0, 1.0);
    }
    return out;
}

// By how much the skin bends away from a direction at this cosine to its normal, by the metre's square: along a limb less and across
// it more, half of the sum of both.
fn bend_along(bend_per_m: f32, cosine: f32) -> f32 {
    return 0.25 * bend_per_m * max(1.0 - cosine * cosine, 0.0);
}

// What a fragment shows.
fn shaded(in: Varyings) -> Shaded {
    // Where fins stand close, a pixel spans many texels along the edge and few along the hair. A mip that holds the former
    // would mix roots and tips, so no more of the width counts than a sampler can take apart.
    let size = vec2<f32>(textureDimensions(fin_albedo).xy);
    let root_dx = dpdx(in.root);
    let root_dy = dpdy(in.root);
    var root = Root(1.0, 1.0);
    if paint.has_painted > 0u {
        root = root_of(read_root(painted_texture, painted_sampler, in.root.zw, root_dx.zw, root_dy.zw), in.longest);
    }
    var tint = in.tint;
    if paint.has_colour > 0u {
        tint = vec4(tint.rgb * read_root(colour_texture, colour_sampler, in.root.xy, root_dx.xy, root_dy.xy).rgb, tint.w);
    }
    // Shorter hair ends lower: the texture is squeezed to it.
    let squeeze = 1.0 / max(root.share, 1e-6);
    let uv = vec2(in.uv.x, 1.0 - (1.0 - in.uv.y) * squeeze);
    let uv_dx = dpdx(in.uv) * vec2(1.0, squeeze);
    let uv_dy = dpdy(in.uv) * vec2(1.0, squeeze);
    let offset_m = in.offset_m * root.share;
    let near = nearness(max(abs(uv_dx.x), abs(uv_dy.x)));
    let near_outline = at_outline(in.cos_view, near);
    let root_reads = f32(paint.has_painted + paint.has_colour);
    if near_outline <= 0.0 {
        return plain(select(vec4(0.0), vec4(1.0, root_reads, 0.0, 0.0), MEASURE == 4u));
    }
    let texels = vec2(length(vec2(uv_dx.x, uv_dy.x)), length(vec2(uv_dx.y, uv_dy.y))) * size;
    let narrowed = vec2(min(1.0, MAX_STRETCH * max(texels.y, 1.0) / max(texels.x, 1e-6)), 1.0);
    let level = root_level(uv_dx * narrowed * size, uv_dy * narrowed * size);
    let surface = textureSampleLevel(fin_albedo, fin_sampler, uv, 0, level);
    let medium = textureSampleLevel(fin_tangent, fin_sampler, uv, 0, level);
    if uv.y < 0.0 {
        return plain(select(vec4(0.0), vec4(1.0, root_reads + FIN_READS, 0.0, 0.0), MEASURE == 4u));
    }
    let present = tint.w * root.density * presence(offset_m);
    let stored = (medium.xyz * 255.0 - 128.0) / 127.0;
    let up = normalize(in.offset_m);
    let tangent = normalize(stored.x * in.along + stored.y * in.across + stored.z * up + up * 1e-6);
    let to_eye = -ray_direction(in.position_m);
    let normal = normalize(in.normal);
    let hair_normal = dot(tangent, normal);
    let eye_normal = dot(to_eye, normal);
    let eye_hair = dot(tangent, to_eye);
    let hair_m = length(offset_m);
    let height_m = (1.0 - uv.y) * hair_m;
    let above = area_above(medium.a) * present * hair_m / tile.height_m;
    var layer = 1u;
    while layer + 1u < tile.layers && slabs[layer].top < 1.0 - uv.y {
        layer++;
    }
    let upright_m = max(dot(up, normal), LEAST_COSINE) * hair_m;
    let scale_m = layer_looks[layer].scale * upright_m;

    // Hair that stands out of a bent skin stands the wider apart the higher it is.
    let spread = max(1.0 + 0.5 * in.bend_per_m * height_m, LEAST_SPREAD);
    let amount = in.weight * near_outline * present * paint.fins / (spread * spread);
    // Near by, whole hairs are left out; from afar, a share of each.
    let left = mix(amount, step(chance(u32(i32(floor(in.uv.x * STRIPS)))), amount), near);
    let opacity = thinned(surface.a, select(left, amount, amount >= 1.0)) * uncovered(in.clip);
    if MEASURE == 4u {
        return plain(vec4(1.0, root_reads + FIN_READS + 1.0 + select(0.0, shadow_reads(HAIR_TAPS), opacity >= INVISIBLE), 0.0, 0.0));
    }
    if opacity < INVISIBLE {
        return plain(vec4(0.0));
    }

    // What stands out at the outline is guard hair.
    let which = 0u;
    let crowding = layer_looks[tile.layers - 1u].crowding * present;
    let worn = worn_of(which, surface.rgb * tint.rgb);
    let seen = seen_of(which, above, eye_hair, hair_normal, eye_normal);
    var radiance = vec3(0.0);
    if any(view.ambient != vec3(0.0)) {
        radiance = view.ambient * lit_by_sky(which, above, eye_hair, hair_normal, eye_normal, worn, crowding);
    }
    let root_m = in.position_m - (1.0 - in.uv.y) * in.offset_m;
    var key = Key(0.0, 0.0);
    if view.light_count > 0u {
        let to_light = light_at(view.lights[0], in.position_m).to_light;
        let rise = dot(normal, to_light);
        let bend_per_m = bend_along(in.bend_per_m, rise);
        let open = past_skin(rise, bend_per_m, (1.0 - uv.y) * upright_m);
        let depth = above * cos_of(clamp(dot(tangent, to_light), -1.0, 1.0)) * way_up(rise, bend_per_m, scale_m);
        key = Key(depth, open * key_share(0u, root_m, in.position_m, normal, to_light, HAIR_TAPS));
    }
    radiance += lit_by_all(Hair(in.position_m, tangent, normal, to_eye, above, crowding), seen, worn, key);
    return Shaded(vec4(radiance * opacity, opacity), surface.rgb * tint.rgb, above * cos_of(clamp(eye_hair, -1.0, 1.0)) / max(abs(eye_normal), LEAST_COSINE));
}

@fragment
fn fragment(in: Varyings) -> @location(0) vec4<f32> {
    return shaded(in).light;
}

@fragment
fn weighted(in: Varyings) -> Weighted {
    return weighted_of(shaded(in), in.clip.z);
}

@fragment
fn hashed(in: Varyings) -> @location(0) vec4<f32> {
    let finest = finest_step(in.position_m);
    return kept_or_not(shaded(in).light, threshold(in.position_m, finest));
}
