// Shells: slab after slab of the coat. Each is drawn at its top, so that its outline is where the hair's is, and fetched
// where the ray passes its middle.
#import furrier::view::{view, ray_direction}
#import furrier::light::light_at
#import furrier::blending::{Shaded, Weighted, plain, weighted_of, finest_step, kept_or_not, threshold}
#import furrier::items::{items, uncovered, shadow_reads, read_root}
#import furrier::lights::{Hair, Key, lit_by_all}
#import furrier::shading::{past_border, past_skin, way_to_border, way_up}
#import furrier::law::{lit_by_sky, seen_of, worn_of}
#import furrier::looks::layer_looks
#import furrier::shadow_map::{HAIR_TAPS, key_share}
#import furrier::constants::{INVISIBLE, LEAST_EXTINCTION, LEAST_RISE, LEAST_UV_AREA, MOST_SPREAD, MOST_TAPS}
#import furrier::coat::{CoatVertex, Paint, Root, root_of, Filled, filled_slab, Frame, Medium, Footprint, tile, slabs, hair_sampler, albedo_texture, medium_texture, ends_texture, Ray, frame, hair_frame, ray_in_tile,
    lateral, across, area_above, seen_at, seen_above, depth_of_opacity, presence, path_through_slab, footprint, fetch, run_through_slab, gain, medium_of, fin_share, nearness, closeness}

// Whether fins are drawn too and take their share.
override WITH_FINS: bool = true;
// Whether roots have textures.
override PAINTED: bool = true;
// What is measured instead of drawn, 0 for nothing: 1 the mean optical depth of a slab, added up in red; 2 on the skin itself that of all
// slabs, as they would lie over it on a plane, in green, and 1 in blue, nothing where root.x is above 0; 3 nothing but the near side's
// depth, where there is hair; 4 what it costs: fragments in red, reads of texels in green.
override MEASURE: u32 = 0u;
// Cosines between a facet and the smooth normals at its corners: of a hard edge, and of a surface that facets stand for.
const HARD: f32 = 0.707;
const SOFT: f32 = 0.906;
// Deeper is never seen through.
const OPAQUE: f32 = 4.0;
// The one look that is bound.
const LOOK: u32 = 0u;
// Lengths of hair from the coat's end up to which light comes in there, and from which on it does not.
const BESIDE: vec2<f32> = vec2(1.0, 2.0);
// Taps at the most where no single hair is told apart, as many layers are averaged anyway: of the upper half of a stack, of the lower, which
// is seen through it, and of the far side.
const UPPER_TAPS: f32 = 4.0;
const LOWER_TAPS: f32 = 2.0;
const FAR_TAPS: f32 = 1.0;

@group(2) @binding(0) var<storage, read> vertices: array<CoatVertex>;
@group(2) @binding(1) var<storage, read> indices: array<u32>;
@group(2) @binding(2) var<uniform> paint: Paint;
@group(2) @binding(3) var colour_sampler: sampler;
@group(2) @binding(4) var colour_texture: texture_2d_array<f32>;
@group(2) @binding(5) var painted_sampler: sampler;
@group(2) @binding(6) var painted_texture: texture_2d_array<f32>;

struct Varyings {
    @builtin(position) clip: vec4<f32>,
    // In xyz; how far it is from where the coat ends in w, m.
    @location(0) position_m: vec4<f32>,
    @location(1) uv: vec2<f32>,
    @location(2) offset_m: vec3<f32>,
    // Of the slab, which lies as the coat's outer side does the more the higher it is.
    @location(3) normal: vec3<f32>,
    @location(4) tint: vec4<f32>,
    // What one metre of the tile becomes on this triangle at this height. In w the square root of the triangle's area at this height over
    // that on the skin, and how far fins stand for the hair around them.
    @location(5) @interpolate(flat) x_axis: vec4<f32>,
    @location(6) @interpolate(flat) y_axis: vec4<f32>,
    // How the slab and the skin bend along them: what the normal changes by, of x along x, of both along each other, of y along y.
    @location(7) @interpolate(flat) bend: vec3<f32>,
    @location(8) @interpolate(flat) skin_bend: vec3<f32>,
    // Layer, and 1 where it is seen from inside.
    @location(9) @interpolate(flat) layer: vec2<u32>,
    @location(10) axis: vec3<f32>,
    // How much further it is from where the coat ends, per metre.
    @location(11) @interpolate(flat) away: vec3<f32>,
    @location(12) root: vec4<f32>,
    @location(13) longest: f32,
    // Normal of the facet, outwards, and how far it gives way to the smooth one.
    @location(14) @interpolate(flat) facet: vec4<f32>,
    @location(15) skin_normal: vec3<f32>,
}

// How far normals that turn so along two edges turn towards the texture's axes along them.
fn bend_of(turns: mat2x3<f32>, uv_b: vec2<f32>, uv_c: vec2<f32>, scale: f32, axes: mat2x3<f32>) -> vec3<f32> {
    let x_turn = (turns[0] * uv_c.y - turns[1] * uv_b.y) * scale;
    let y_turn = (turns[1] * uv_b.x - turns[0] * uv_c.x) * scale;
    return vec3(dot(x_turn, axes[0]), dot(x_turn, axes[1]) + dot(y_turn, axes[0]), dot(y_turn, axes[1]));
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Varyings {
    let item = items[index / 3u];
    let first = 3u * item.index;
    let layer = item.layer & 0xffffu;
    let a = vertices[indices[first]];
    let b = vertices[indices[first + 1u]];
    let c = vertices[indices[first + 2u]];
    let height = slabs[layer].top;
    let at_a = a.position_m + height * a.offset_m;
    let edge_b = b.position_m + height * b.offset_m - at_a;
    let edge_c = c.position_m + height * c.offset_m - at_a;

    // The triangle's axes: edges are U du + V dv, solved for U and V.
    let uv_b = vec2(b.u - a.u, b.v - a.v) * tile.edge_m;
    let uv_c = vec2(c.u - a.u, c.v - a.v) * tile.edge_m;
    let area = uv_b.x * uv_c.y - uv_c.x * uv_b.y;
    let scale = select(0.0, 1.0 / area, abs(area) > LEAST_UV_AREA);

    let own = vertices[indices[first + index % 3u]];
    var out: Varyings;
    out.position_m = vec4(own.position_m + height * own.offset_m, own.away_m);
    out.uv = vec2(own.u, own.v);
    out.offset_m = own.offset_m;
    out.normal = mix(own.normal, own.outer_normal, height);
    out.skin_normal = own.normal;
    out.tint = own.tint;
    let x_axis = (edge_b * uv_c.y - edge_c * uv_b.y) * scale;
    let y_axis = (edge_c * uv_b.x - edge_b * uv_c.x) * scale;
    let normal_a = mix(a.normal, a.outer_normal, height);
    let normal_b = mix(b.normal, b.outer_normal, height);
    let normal_c = mix(c.normal, c.outer_normal, height);
    let axes = mat2x3(x_axis, y_axis);
    out.bend = bend_of(mat2x3(normal_b - normal_a, normal_c - normal_a), uv_b, uv_c, scale, axes);
    out.skin_bend = bend_of(mat2x3(b.normal - a.normal, c.normal - a.normal), uv_b, uv_c, scale, axes);
    out.layer = vec2(layer, item.layer >> 16u);
    out.root = own.root;
    out.longest = own.longest;
    out.axis = own.axis;
    let foot_b = b.position_m - a.position_m;
    let foot_c = c.position_m - a.position_m;
    let foot = cross(foot_b, foot_c);
    let further = (b.away_m - a.away_m) * cross(foot_c, foot) + (c.away_m - a.away_m) * cross(foot, foot_b);
    out.away = further / max(dot(foot, foot), 1e-30);
    let spread = clamp(sqrt(length(cross(edge_b, edge_c)) / max(length(foot), 1e-30)), 1.0 / MOST_SPREAD, MOST_SPREAD);
    let face = cross(edge_b, edge_c);
    let around = length(edge_b) + length(edge_c) + length(edge_c - edge_b);
    let close = closeness(length(own.offset_m), length(face) / max(around, 1e-20));
    out.x_axis = vec4(x_axis, spread);
    out.y_axis = vec4(y_axis, close);
    // The smooth normal is right where it is near the facet's at all corners, or where facets are small.
    let plain = face / max(length(face), 1e-30);
    let facet = select(-plain, plain, dot(plain, normal_a + normal_b + normal_c) >= 0.0);
    let nearest = min(min(dot(facet, normal_a), dot(facet, normal_b)), dot(facet, normal_c));
    out.facet = vec4(facet, max(close, smoothstep(HARD, SOFT, nearest)));
    out.clip = select(vec4(0.0, 0.0, -1.0, 1.0), view.clip_from_world * vec4(out.position_m.xyz, 1.0), scale != 0.0);
    return out;
}

// How the skin lies at a pixel at this height, and how it bends: per metre of the texture.
struct Skin {
    // Metres of the texture of a direction in the world: two rows.
    x_row: vec3<f32>,
    y_row: vec3<f32>,
    // As `Varyings.skin_bend`, times half of how far bends count over how much of the offset is upright.
    bend: vec3<f32>,
}

// By how much, per square of a metre along a direction with these metres of the texture, a surface bends away from it, in
// metres of the tile.
fn bend_along(bend: vec3<f32>, texture: vec2<f32>) -> f32 {
    return dot(bend, vec3(texture.x * texture.x, texture.x * texture.y, texture.y * texture.y));
}

// The way of light, or of the eye's ray, through the hair above a place.
struct Way {
    // Optical depth over hair area straight above, and over that along it.
    longer: f32,
    side: f32,
    // Metres of the tile that it rises, and that the skin bends away from it, by the metre and its square.
    rise: f32,
    bend_per_m: f32,
}

fn way_of(place: Place, medium: Medium, to: vec3<f32>, scale_m: f32) -> Way {
    let rise = dot(place.rise, to);
    let bend_per_m = bend_along(place.skin.bend, vec2(dot(place.skin.x_row, to), dot(place.skin.y_row, to)));
    let side = across(place.at, to, medium) / max(medium.extinction, LEAST_EXTINCTION);
    return Way(side * way_up(rise, bend_per_m, scale_m), side, rise, bend_per_m);
}

// How a coat lies at a pixel, and how it is seen.
struct Place {
    // Of the skin.
    normal: vec3<f32>,
    world_ray: vec3<f32>,
    // The hair's frame.
    at: Frame,
    ray: Ray,
    // The same ray as the texture is fetched along it.
    sweep: Ray,
    bend_per_m: f32,
    skin: Skin,
    // Metres of the tile that a direction rises over the slab.
    rise: vec3<f32>,
    uv: vec2<f32>,
    uv_dx: vec2<f32>,
    uv_dy: vec2<f32>,
}

// What a ray meets of a slab.
struct Met {
    // Optical depth at full density.
    depth: f32,
    medium: Medium,
    // Where it is fetched.
    uv: vec2<f32>,
    round_level: f32,
    // How many texels were read, as a sampler counts.
    reads: f32,
    gained: f32,
}

fn place_of(in: Varyings, offset_m: vec3<f32>, uv_dx: vec2<f32>, uv_dy: vec2<f32>) -> Place {
    // Axes in the plane of the smooth normal, or facets would show; where they are larger than hair is long they are what there is.
    let normal = normalize(mix(in.facet.xyz, normalize(in.normal), in.facet.w));
    let x_axis = in.x_axis.xyz - normal * dot(normal, in.x_axis.xyz);
    let y_axis = in.y_axis.xyz - normal * dot(normal, in.y_axis.xyz);
    let up = offset_m / tile.height_m;
    let texture = frame(x_axis, y_axis, up);
    var at = texture;
    if tile.tinted > 0.5 {
        at = hair_frame(in.axis, x_axis, normal, in.x_axis.w, up);
    }
    let world_ray = ray_direction(in.position_m.xyz);
    let ray = ray_in_tile(at, world_ray);
    let sweep = Ray(vec3((texture.tile_from_world * world_ray).xy, ray.direction.z), ray.cosine, ray.fall);

    // The surface bends away from the ray by half its normal curvature along it, measured in metres of the tile.
    let rows = transpose(texture.tile_from_world);
    let half_share = 0.5 * in.facet.w / max(dot(normal, at.world_from_tile[2]), LEAST_RISE);
    let skin = Skin(rows[0], rows[1], in.skin_bend * half_share);
    let bend_per_m = bend_along(in.bend * half_share, sweep.direction.xy);
    let rise = normal / max(dot(normal, up), LEAST_RISE);
    // What a hair sends where follows from how the skin lies: that is how the law was solved.
    let skin_normal = normalize(mix(in.facet.xyz, normalize(in.skin_normal), in.facet.w));
    return Place(skin_normal, world_ray, at, ray, sweep, bend_per_m, skin, rise, in.uv, uv_dx, uv_dy);
}

fn met(place: Place, slab: Filled, near_side: bool, near: f32) -> Met {
    let path_m = path_through_slab(place.ray, slab.slab_m, place.bend_per_m);
    let inwards = select(-0.5, 0.5, near_side) * path_m;
    let uv = place.uv + inwards * place.sweep.direction.xy / tile.edge_m;

    let run = run_through_slab(place.sweep, path_m, slab.slab_m, slabs[slab.layer].slope);
    let from_afar = select(FAR_TAPS, select(LOWER_TAPS, UPPER_TAPS, slabs[slab.layer].top > 0.5), near_side);
    let most_taps = floor(mix(from_afar, select(4.0 * FAR_TAPS, MOST_TAPS, near_side), min(2.0 * near, 1.0)));
    var spot = footprint(place.uv_dx, place.uv_dy, run, most_taps);
    var gain_level = footprint(place.uv_dx, place.uv_dy, vec2(0.0), MOST_TAPS).level;
    if MEASURE == 1u || MEASURE == 2u {
        // The mean of the tile: no gap between two hairs counts as bald.
        gain_level = f32(tile.mips - 1u);
        spot = Footprint(vec2(0.0), 1.0, gain_level, gain_level);
    }
    let medium = medium_of(fetch(medium_texture, uv, slab.layer, spot));
    // Ends count where the run is short, and colour varies little from hair to hair: one tap each.
    let ends = textureSampleLevel(ends_texture, hair_sampler, uv, slab.layer, spot.round_level).r;

    // τ = g(θ)·[A √(1 − (ω·m)²) Δh/|cos θ| + κ], model e of docs/steps/shells.md; g by the pixel's own mip.
    let through = path_m * lateral(place.at, place.world_ray, medium);
    let of_ends = slab.slabs * depth_of_opacity(ends) * min(1.0, path_m * place.ray.fall / max(slab.slab_m, 1e-20));
    let gained = gain(gain_level, u32(slab.layer), place.ray.cosine);
    return Met(gained * (through + of_ends), medium, uv, spot.round_level, spot.taps + 1.0, gained);
}

// What a fragment shows.
fn shaded(in: Varyings) -> Shaded {
    let near_side = in.layer.y == 0u;
    let uv_dx = dpdx(in.uv);
    let uv_dy = dpdy(in.uv);
    var root_dx = vec4(0.0);
    var root_dy = vec4(0.0);
    if PAINTED {
        root_dx = dpdx(in.root);
        root_dy = dpdy(in.root);
    }
    // What is painted where the hair has its root: below, along the offset. Texels that were sampled on the skin hold it.
    var root = Root(1.0, 1.0);
    if PAINTED && paint.has_painted > 0u && tile.tinted > 0.5 {
        root = root_of(read_root(painted_texture, painted_sampler, in.root.zw, root_dx.zw, root_dy.zw), in.longest);
    }
    var slab = Filled(i32(in.layer.x), (slabs[in.layer.x].top - slabs[in.layer.x].bottom) * tile.height_m, 1.0);
    if PAINTED {
        slab = filled_slab(in.layer.x, root.share);
    }
    let painted_reads = select(0.0, 1.0, PAINTED && paint.has_painted > 0u && tile.tinted > 0.5);
    if slab.slabs <= 0.0 && MEASURE == 3u {
        discard;
    }
    if slab.slabs <= 0.0 && MEASURE == 4u {
        return plain(vec4(1.0, painted_reads, 0.0, 0.0));
    }
    if slab.slabs <= 0.0 && MEASURE != 2u {
        return plain(vec4(0.0));
    }
    let offset_m = in.offset_m * root.share;
    let place = place_of(in, offset_m, uv_dx, uv_dy);
    let present = mix(1.0, in.tint.w * root.density, tile.tinted) * presence(offset_m);
    if MEASURE == 2u {
        // Whether hair lies over skin beside a border of the coat hangs on which way it leans.
        if in.root.x > 0.0 {
            discard;
        }
        var expected = 0.0;
        for (var layer = 1u; layer < tile.layers; layer++) {
            expected += met(place, filled_slab(layer, root.share), true, 1.0).depth * present;
        }
        return plain(uncovered(in.clip) * vec4(0.0, min(expected, OPAQUE), 1.0, 0.0));
    }

    let look = layer_looks[u32(slab.layer)];
    let scale_m = look.scale * tile.height_m;
    let to_eye = -place.world_ray;
    let near = nearness(max(length(uv_dx), length(uv_dy)));
    let found = met(place, slab, near_side, near);
    let medium = found.medium;
    let kept = select(1.0, 1.0 - paint.fins * in.y_axis.w * fin_share(dot(place.normal, place.world_ray), near), WITH_FINS);
    let depth = found.depth * present * kept * paint.share;
    if MEASURE == 1u {
        return plain(vec4(min(depth, OPAQUE), 0.0, 0.0, 0.0));
    }
    var opacity = 1.0 - exp(-depth);
    let visible = opacity >= INVISIBLE;
    if visible {
        opacity *= uncovered(in.clip);
    }
    if MEASURE == 3u && (opacity < INVISIBLE || !near_side) {
        discard;
    }
    if MEASURE == 4u {
        let coloured = PAINTED && paint.has_colour > 0u && tile.tinted > 0.5;
        let of_light = 1.0 + select(0.0, 1.0, coloured) + shadow_reads(HAIR_TAPS);
        return plain(vec4(1.0, painted_reads + found.reads + select(0.0, 1.0, visible) + select(0.0, of_light, opacity >= INVISIBLE), 0.0, 0.0));
    }
    if MEASURE == 3u || opacity < INVISIBLE {
        return plain(vec4(0.0));
    }
    let surface = textureSampleLevel(albedo_texture, hair_sampler, found.uv, slab.layer, found.round_level);
    var tint = vec3(1.0);
    if tile.tinted > 0.5 {
        tint = in.tint.rgb;
        if PAINTED && paint.has_colour > 0u {
            tint *= read_root(colour_texture, colour_sampler, in.root.xy, root_dx.xy, root_dy.xy).rgb;
        }
    }
    let at = place.at;
    let normal = place.normal;

    // m, where there is enough hair for eight bits to tell.
    let tangent = normalize(at.world_from_tile * (medium.tangent + vec3(0.0, 0.0, LEAST_EXTINCTION)));
    let worn = worn_of(LOOK, surface.rgb * tint);
    let hair_normal = dot(tangent, normal);
    let eye_normal = dot(to_eye, normal);
    // Less lies above what is seen of a slab than above its middle.
    let middle_area = area_above(surface.a) * present;
    let own_area = min(2.0 * (1.0 - look.top_share) * slab.slabs, 2.0) * middle_area;
    let top_area = middle_area - 0.5 * own_area;
    var seen_depth = 0.0;
    var within = 0.5;
    var area = middle_area;
    if near_side {
        seen_depth = found.gained * own_area * way_of(place, medium, to_eye, scale_m).longer;
        within = seen_at(seen_depth);
        area = top_area + own_area * seen_above(seen_depth, own_area);
    }
    let above = area * length(at.world_from_tile[2]);
    let crowding = look.crowding * present;
    let seen = seen_of(LOOK, above, dot(tangent, to_eye), hair_normal, eye_normal);
    var radiance = vec3(0.0);
    if any(view.ambient != vec3(0.0)) {
        radiance = view.ambient * lit_by_sky(LOOK, above, dot(tangent, to_eye), hair_normal, eye_normal, worn, crowding);
    }
    let root_m = in.position_m.xyz - in.offset_m * slabs[in.layer.x].top;
    var key = Key(0.0, 0.0);
    if view.light_count > 0u {
        let to_light = light_at(view.lights[0], in.position_m.xyz).to_light;
        let way = way_of(place, medium, to_light, scale_m);
        let height_m = slabs[slab.layer].top * tile.height_m - within * slab.slab_m;
        // Where the coat ends before, light comes in from the side.
        let nearer = dot(in.away, at.world_from_tile[2] * way.rise - to_light);
        // From further away none arrives, and what ends there may be a pinhole.
        let beside = 1.0 - smoothstep(BESIDE.x, BESIDE.y, in.position_m.w / max(length(in.offset_m), 1e-9));
        let border_m = max(in.position_m.w, 0.0) / max(nearer * beside, 1e-6);
        let open = max(past_skin(way.rise, way.bend_per_m, height_m), past_border(way.rise, border_m, height_m));
        let longer = min(way.longer, way.side * way_to_border(way.rise, border_m, scale_m));
        let own_depth = select(area * longer, top_area * longer + own_area * longer * seen_above(seen_depth, own_area * longer), near_side);
        key = Key(own_depth, open * key_share(0u, root_m, in.position_m.xyz, normal, to_light, HAIR_TAPS));
    }
    radiance += lit_by_all(Hair(in.position_m.xyz, tangent, normal, to_eye, above, crowding), seen, worn, key);
    // What the eye's ray meets of the coat before it comes here.
    let before = select(2.0 * OPAQUE, found.gained * top_area * way_of(place, medium, to_eye, scale_m).longer, near_side);
    return Shaded(vec4(radiance * opacity, opacity), surface.rgb * tint, before);
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
    let finest = finest_step(in.position_m.xyz);
    return kept_or_not(shaded(in).light, threshold(in.position_m.xyz, finest));
}
