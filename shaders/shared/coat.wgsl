// A tile on the skin: its textures, its law of opacity, its frame (docs/steps/runtime.md).
#define_import_path furrier::coat

#import furrier::constants::{APART, FADE_BELOW, GAIN_ANGLES_DEG, LEAST_AXIS, LEAST_BULK, LEAST_CLEAR, LEAST_COSINE, LEAST_DIRECTION,
    LEAST_EXTINCTION, LEAST_VOLUME, MOST_ABOVE, OUTLINE, PI, TOLD_APART}

struct Tile {
    // Length that one unit of UV stands for, m.
    edge_m: f32,
    // Height of the stack, m.
    height_m: f32,
    // Texels along an edge of mip 0.
    size: f32,
    // Layers, the skin counted.
    layers: u32,
    mips: u32,
    // 1 where the coat's tint gives shells colour and density, 0 where the texels hold them.
    tinted: f32,
    // Extinction that a fetched 1 of the medium stands for, 1/m.
    medium_unit_per_m: f32,
}

// A layer: where it lies in the stack.
struct Slab {
    // Mean slope of the hair, (dx, dy)/dz in tile axes.
    slope: vec2<f32>,
    // Heights over the stack's.
    bottom: f32,
    top: f32,
}

// Of one layer.
struct Mip {
    // At GAIN_ANGLES_DEG.
    gains: array<f32, 9>,
}

struct CoatVertex {
    position_m: vec3<f32>,
    u: f32,
    // Root to the top of the stack.
    offset_m: vec3<f32>,
    v: f32,
    normal: vec3<f32>,
    // Longest length painted around it.
    longest: f32,
    // The tile's x axis on the skin, of any length; 0 where it is the texture's own.
    axis: vec3<f32>,
    // Sum of the skin's principal curvatures, 1/m.
    bend_per_m: f32,
    // Colour factor and density factor.
    tint: vec4<f32>,
    // Where textures of the root are read: of colour in xy, of what is painted in zw.
    root: vec4<f32>,
    // Normal of the coat's outer side.
    outer_normal: vec3<f32>,
    // How far it is from where the coat ends, m; very far where it nowhere does.
    away_m: f32,
}

// Which textures of the root there are, 0 or 1 each; and what of the coat is drawn.
struct Paint {
    has_colour: u32,
    has_painted: u32,
    // Share of the optical depth that the level which is drawn has, and of the fins.
    share: f32,
    fins: f32,
}

// Strips of hair along a tile's edge that are told apart near by.
const STRIPS: f32 = 128.0;

@group(1) @binding(0) var<uniform> tile: Tile;
// Per layer.
@group(1) @binding(1) var<storage, read> slabs: array<Slab>;
// Of every layer, mip after mip.
@group(1) @binding(2) var<storage, read> mips: array<Mip>;
@group(1) @binding(3) var hair_sampler: sampler;
@group(1) @binding(4) var albedo_texture: texture_2d_array<f32>;
@group(1) @binding(5) var medium_texture: texture_2d_array<f32>;
@group(1) @binding(6) var ends_texture: texture_2d_array<f32>;

// The tile's axes at a point of the skin, in the world: columns are what 1 m along the tile's x, y and z becomes. z is
// the offset over the stack's height, so a leaning offset shears the tile.
struct Frame {
    world_from_tile: mat3x3<f32>,
    tile_from_world: mat3x3<f32>,
    // What 1 m³ of the tile becomes, m³.
    volume: f32,
}

fn frame(x_axis: vec3<f32>, y_axis: vec3<f32>, z_axis: vec3<f32>) -> Frame {
    let xy = cross(x_axis, y_axis);
    let signed_volume = dot(z_axis, xy);
    let volume = max(max(abs(signed_volume), LEAST_VOLUME * length(xy) * length(z_axis)), LEAST_BULK);
    let scale = select(-1.0, 1.0, signed_volume >= 0.0) / volume;
    let rows = mat3x3(cross(y_axis, z_axis), cross(z_axis, x_axis), xy) * scale;
    return Frame(mat3x3(x_axis, y_axis, z_axis), transpose(rows), volume);
}

// The frame of hair that was sampled on a square: it stands along `axis` in the plane of `normal`, whichever way its texture lies
// there, so that stretch and turn of a patch show in its picture alone. `spread` is how much wider the skin is at this
// height, as a length.
fn hair_frame(axis: vec3<f32>, texture_axis: vec3<f32>, normal: vec3<f32>, spread: f32, z_axis: vec3<f32>) -> Frame {
    let along = axis - normal * dot(normal, axis);
    let x_axis = normalize(select(texture_axis, along, length(along) > LEAST_AXIS * length(axis)));
    return frame(spread * x_axis, spread * cross(normal, x_axis), z_axis);
}

// A direction in the tile: what 1 m of it in the world becomes, its z kept away from 0.
struct Ray {
    direction: vec3<f32>,
    // |cos θ| between it and the tile's z axis.
    cosine: f32,
    // |z| as it really is.
    fall: f32,
}

fn ray_in_tile(at: Frame, world: vec3<f32>) -> Ray {
    let direction = at.tile_from_world * world;
    let size = length(direction);
    let z = max(abs(direction.z), LEAST_COSINE * size);
    let steep = vec3(direction.xy, select(-z, z, direction.z > 0.0));
    return Ray(steep, z / length(steep), abs(direction.z));
}

// What a texel of the medium holds.
struct Medium {
    // A, 1/m.
    extinction: f32,
    // A·m, 1/m, tile axes.
    tangent: vec3<f32>,
}

// The texture holds decoded numbers over one unit for all mips, so that a sampler's mean between two mips is that of the law.
fn medium_of(texel: vec4<f32>) -> Medium {
    return Medium(texel.x * tile.medium_unit_per_m, texel.yzw * tile.medium_unit_per_m);
}

// Extinction that a ray along the unit vector `world` meets, 1/m of the ray. Hair keeps its diameter under the frame M: it
// becomes |M m̂| times as long in a volume det M times as large. For M = 1 this is A·sqrt(1 - (ω·m)²). Hair without a direction
// has none.
fn lateral(at: Frame, world: vec3<f32>, medium: Medium) -> f32 {
    return select(0.0, across(at, world, medium), length(medium.tangent) > LEAST_DIRECTION);
}

// The same, hair without a direction counted as lying across the ray.
fn across(at: Frame, world: vec3<f32>, medium: Medium) -> f32 {
    let size = length(medium.tangent);
    var stretched = medium.extinction;
    if size > LEAST_DIRECTION {
        stretched *= length(at.world_from_tile * (medium.tangent / size));
    }
    let along = dot(world, at.world_from_tile * medium.tangent);
    return sqrt(max(0.0, stretched * stretched - along * along)) / at.volume;
}

// Hair area above per skin area, of alpha.
fn area_above(alpha: f32) -> f32 {
    return MOST_ABOVE * (1.0 - alpha) * (1.0 - alpha);
}

// How deep in a layer lies what is seen of it from outside, in the mean, as a share of its thickness; `depth` is what the eye's ray
// meets of it.
fn seen_at(depth: f32) -> f32 {
    if depth < 0.1 {
        return 0.5 - depth / 12.0;
    }
    return 1.0 / depth - 1.0 / (exp(min(depth, 80.0)) - 1.0);
}

// Hair area that seen_above can tell; of less it is the same.
const LEAST_SEEN: f32 = 0.002;

// Mean of what comes through a layer of this depth to each place in it.
fn mean_clear(depth: f32) -> f32 {
    if depth < 0.1 {
        return 1.0 - depth * (1.0 / 2.0 - depth * (1.0 / 6.0 - depth / 24.0));
    }
    return (1.0 - exp(-depth)) / depth;
}

// Share of a layer's hair that lies above what is seen of it, of which the layer holds `area` per skin area; `depth` is what the eye's
// ray meets of it. Not the mean, but what darkens by e to minus it as much as all that is seen does in the mean.
fn seen_above(depth: f32, area: f32) -> f32 {
    let d = max(area, LEAST_SEEN);
    return -log(mean_clear(depth + d) / mean_clear(depth)) / d;
}

// Opacity of a slab with `amount` times as much hair as one of this opacity. Hair is opaque where it is: less hair covers less of
// what it covers, and does not become more of a veil.
fn thinned(opacity: f32, amount: f32) -> f32 {
    return select(1.0 - exp(-amount * depth_of_opacity(opacity)), amount * opacity, amount < 1.0);
}

// Optical depth of an opacity: κ of the filtered 1 - e^-κ, and that of a fin.
fn depth_of_opacity(ends: f32) -> f32 {
    return -log(max(1.0 - ends, LEAST_CLEAR));
}

// What a texel says of the hair that has its root there.
struct Root {
    // Factor on density.
    density: f32,
    // Length over that of the offset, in [0, 1].
    share: f32,
}

fn root_of(painted: vec4<f32>, longest: f32) -> Root {
    return Root(painted.r, clamp(painted.g / longest, 0.0, 1.0));
}

// What of a slab hair fills that is shorter than the offset: the tile is squeezed to `share` of the stack, and ends there.
struct Filled {
    // Layer of the tile in the middle of what is filled.
    layer: i32,
    // Thickness of what is filled, in metres of the squeezed tile.
    slab_m: f32,
    // Slabs of the tile in it.
    slabs: f32,
}

fn filled_slab(layer: u32, share: f32) -> Filled {
    let last = tile.layers - 1u;
    let bottom = slabs[layer].bottom / max(share, 1e-6);
    let top = min(slabs[layer].top / max(share, 1e-6), slabs[last].top);
    let filled = max(top - bottom, 0.0);
    var own = layer;
    while own < last && slabs[own].top <= 0.5 * (bottom + top) {
        own++;
    }
    return Filled(i32(own), filled * tile.height_m, filled / (slabs[own].top - slabs[own].bottom));
}

// How much of hair with this offset is there: skin without hair has offsets of length 0, and the last hundredth fades.
fn presence(offset_m: vec3<f32>) -> f32 {
    return smoothstep(0.0, FADE_BELOW, length(offset_m) / tile.height_m);
}

// How far a ray runs through a slab, m, from where it enters by the slab's top to where it leaves by the bottom or, on
// a surface that bends away from it, turns upwards again. The height over the bottom, in metres of the tile, is
// slab - |d.z| s + bend s² after s metres.
fn path_through_slab(ray: Ray, slab_m: f32, bend_per_m: f32) -> f32 {
    let fall = abs(ray.direction.z);
    let discriminant = fall * fall - 4.0 * bend_per_m * slab_m;
    if discriminant < 0.0 {
        return ray.fall / (2.0 * bend_per_m);
    }
    return 2.0 * slab_m / (fall + sqrt(discriminant));
}

// A fetch along a line: taps of one level, evenly spread, as anisotropic samplers do. Done by hand because what drivers do
// under that name differs: a software one blurs by half a texel more.
struct Footprint {
    // From the first to the last tap, in UV.
    line: vec2<f32>,
    taps: f32,
    level: f32,
    // Level at which one tap covers as much as all of them.
    round_level: f32,
}

// The ellipse of a pixel with derivatives `uv_dx`, `uv_dy`, widened by `run`: Σ_pixel + run runᵀ. Taps lie along its major
// axis, a minor axis apart, at most `max_taps`.
fn footprint(uv_dx: vec2<f32>, uv_dy: vec2<f32>, run: vec2<f32>, max_taps: f32) -> Footprint {
    let a = uv_dx.x * uv_dx.x + uv_dy.x * uv_dy.x + run.x * run.x;
    let b = uv_dx.x * uv_dx.y + uv_dy.x * uv_dy.y + run.x * run.y;
    let c = uv_dx.y * uv_dx.y + uv_dy.y * uv_dy.y + run.y * run.y;
    let middle = 0.5 * (a + c);
    let d = 0.5 * (a - c);
    let half_gap = length(vec2(d, b));
    let major = sqrt(middle + half_gap);
    // Taps closer than a texel would see nothing new.
    let minor = max(sqrt(max(0.0, middle - half_gap)), 1.0 / tile.size);
    // The larger eigenvector, by whichever of its two forms is the longer.
    let vector = select(vec2(b, half_gap - d), vec2(half_gap + d, b), d >= 0.0);
    let size = length(vector);
    let axis = select(vec2(1.0, 0.0), vector / size, size > 1e-20);
    let taps = clamp(ceil(major / minor - 1e-3), 1.0, max_taps);
    let level = clamp(log2(max(major, minor) / taps * tile.size), 0.0, f32(tile.mips - 1u));
    let round_level = clamp(log2(sqrt(max(major, minor) * minor) * tile.size), 0.0, f32(tile.mips - 1u));
    return Footprint(axis * max(major - minor, 0.0), taps, level, round_level);
}

fn fetch(texture: texture_2d_array<f32>, uv: vec2<f32>, layer: i32, spot: Footprint) -> vec4<f32> {
    var sum = vec4(0.0);
    for (var tap = 0.5; tap < spot.taps; tap += 1.0) {
        let at = uv + spot.line * (tap / spot.taps - 0.5);
        sum += textureSampleLevel(texture, hair_sampler, at, layer, spot.level);
    }
    return sum / spot.taps;
}

// The ray's sideways run through a slab against the hair's own slope k, in UV.
fn run_through_slab(ray: Ray, path_m: f32, slab_m: f32, slope: vec2<f32>) -> vec2<f32> {
    return (sign(ray.direction.z) * path_m * ray.direction.xy - slab_m * slope) / tile.edge_m;
}

// g(θ) of a layer at a level between two mips.
fn gain(level: f32, layer: u32, cosine: f32) -> f32 {
    let degrees = clamp(acos(clamp(cosine, 0.0, 1.0)) * (180.0 / PI), GAIN_ANGLES_DEG[0], GAIN_ANGLES_DEG[8]);
    var next = 1u;
    var low = GAIN_ANGLES_DEG[0];
    var high = GAIN_ANGLES_DEG[1];
    // Unrolled by the compiler, as the list is constant: no loads but those of the gains.
    for (var i = 2u; i < 9u; i++) {
        if degrees > GAIN_ANGLES_DEG[i - 1u] {
            next = i;
            low = GAIN_ANGLES_DEG[i - 1u];
            high = GAIN_ANGLES_DEG[i];
        }
    }
    let share = (degrees - low) / (high - low);
    let mip = u32(level);
    let fine = mip * tile.layers + layer;
    let coarse = min(mip + 1u, tile.mips - 1u) * tile.layers + layer;
    let of_fine = mix(mips[fine].gains[next - 1u], mips[fine].gains[next], share);
    return mix(of_fine, mix(mips[coarse].gains[next - 1u], mips[coarse].gains[next], share), fract(level));
}

// Share of the coat that fins carry where the skin's normal is at this cosine to the view: the mean of Lengyel's weight
// max(0, 2|p| - 1) over edges of every direction, p = sin α cos ψ. Shells keep the rest, so that both together hold the
// coat once (docs/steps/runtime.md, "Silhouettes").
fn fin_share(cos_view: f32, near: f32) -> f32 {
    let sin_view = sqrt(max(0.0, 1.0 - cos_view * cos_view));
    if sin_view <= 0.5 {
        return 0.0;
    }
    let limit = acos(0.5 / sin_view);
    return (2.0 / PI) * (2.0 * sin_view * sin(limit) - limit) * at_outline(cos_view, near);
}

// How far fins stand for hair where the skin's normal is at this cosine to the view. They lie behind all near shells and in no order, so
// from afar shells are all of the coat but at the outline; near by shells are smooth, and fins show single hairs.
fn at_outline(cos_view: f32, near: f32) -> f32 {
    let edge = mix(OUTLINE[0], OUTLINE[1], near);
    return 1.0 - smoothstep(edge, 2.0 * edge, abs(cos_view));
}

// How near a pixel is, from 0 to 1, given what of the tile's edge it spans: whether single hairs can be told apart in it.
fn nearness(span: f32) -> f32 {
    return 1.0 - clamp(span * TOLD_APART, 0.0, 1.0);
}

// How far fins stand for the hair around them, which is as far as they stand closer than it is long: `spacing_m` is the skin's
// area per length of edges, the thickness of the slab that a fin holds.
fn closeness(hair_m: f32, spacing_m: f32) -> f32 {
    return min(1.0, hair_m / max(APART * spacing_m, 1e-20));
}
