// A tile on the skin: its textures, its law of opacity, its frame (docs/steps/runtime.md).
#define_import_path furrier::coat

const PI: f32 = 3.14159265;
const GAIN_ANGLES: array<f32, 9> = array(0.0, 10.0, 22.0, 35.0, 48.0, 60.0, 70.0, 79.0, 86.0);
// Below this cosine a slab is no longer a plane; longer runs would average the tile anyway.
const MIN_COS: f32 = 0.02;
// What samplers give at least.
const MAX_ANISOTROPY: f32 = 16.0;

struct Tile {
    // Length that one unit of UV stands for, m.
    edge_m: f32,
    // Height of the stack, m.
    height_m: f32,
    // Extinction that a stored 1 stands for, 1/m.
    extinction_scale_per_m: f32,
    // Texels along an edge of mip 0.
    size: f32,
    // Layers, the skin counted.
    layers: u32,
    mips: u32,
}

struct CoatVertex {
    position_m: vec3<f32>,
    u: f32,
    // Root to the top of the stack.
    offset_m: vec3<f32>,
    v: f32,
    normal: vec3<f32>,
    // Colour factor and density factor.
    tint: vec4<f32>,
}

@group(1) @binding(0) var<uniform> tile: Tile;
// Per layer: mean slope of the hair, (dx, dy)/dz in tile axes.
@group(1) @binding(1) var<storage, read> slopes: array<vec2<f32>>;
// Per mip: gains at GAIN_ANGLES.
@group(1) @binding(2) var<storage, read> gains: array<f32>;
@group(1) @binding(3) var hair_sampler: sampler;
@group(1) @binding(4) var albedo_texture: texture_2d_array<f32>;
@group(1) @binding(5) var medium_texture: texture_2d_array<f32>;
@group(1) @binding(6) var ends_texture: texture_2d_array<f32>;

// The tile's axes at a point of the skin, in the world: columns are what 1 m along the tile's x, y and z becomes. z is
// the offset over the stack's height, so a leaning offset shears the tile.
struct Frame {
    world_from_tile: mat3x3<f32>,
    tile_from_world: mat3x3<f32>,
    // Inverse transpose of world_from_tile: what it does to areas, over its determinant.
    cofactors: mat3x3<f32>,
    determinant: f32,
}

fn frame(x_axis: vec3<f32>, y_axis: vec3<f32>, z_axis: vec3<f32>) -> Frame {
    let yz = cross(y_axis, z_axis);
    let zx = cross(z_axis, x_axis);
    let xy = cross(x_axis, y_axis);
    // Hair lying flat would give a volume of 0; 3 degrees above the skin is as low as it goes.
    let volume = dot(z_axis, xy);
    let least = 0.05 * length(xy) * length(z_axis);
    let determinant = select(-1.0, 1.0, volume >= 0.0) * max(max(abs(volume), least), 1e-20);
    let cofactors = mat3x3(yz, zx, xy) * (1.0 / determinant);
    return Frame(mat3x3(x_axis, y_axis, z_axis), transpose(cofactors), cofactors, determinant);
}

// A direction in the tile: unit, with the cosine to the tile's z kept away from 0.
struct Ray {
    direction: vec3<f32>,
    cosine: f32,
}

fn ray_in_tile(at: Frame, world: vec3<f32>) -> Ray {
    let direction = normalize(at.tile_from_world * world);
    return Ray(direction, max(abs(direction.z), MIN_COS));
}

// Optical depth per unit of A·Δh that a ray meets across hair of mean tangent m: sqrt(1 - (w.m)^2)/|cos θ|, times what
// the frame does to it. In the world the hair is M t, its projected length |M t × M w| per volume det M, and that is
// |cofactor(M) (t × w)| (docs/steps/runtime.md, "Frames that are not rotations").
fn lateral(at: Frame, ray: Ray, tangent: vec3<f32>) -> f32 {
    let along = dot(ray.direction, tangent);
    let across = cross(tangent, ray.direction);
    let size = length(across);
    var stretch = 1.0;
    if size > 1e-4 {
        stretch = length(at.cofactors * (across / size));
    }
    return sqrt(max(0.0, 1.0 - along * along)) * stretch / ray.cosine;
}

// How much of the ends κ a ray meets: roots spread with the skin's area, and are seen under their own angle.
fn ends_met(at: Frame, world: vec3<f32>) -> f32 {
    let z_axis = at.world_from_tile[2];
    let through = abs(at.determinant) * max(abs((at.tile_from_world * world).z), MIN_COS);
    return min(abs(dot(world, normalize(z_axis))) / through, 4.0);
}

// A fetch along the ray: gradients whose ellipse is the pixel's, widened by the run through the slab, and the mip used.
struct Footprint {
    major: vec2<f32>,
    minor: vec2<f32>,
    level: f32,
}

// Σ = Σ_pixel + s sᵀ; returns its axes, all in UV.
fn footprint(uv_dx: vec2<f32>, uv_dy: vec2<f32>, run: vec2<f32>) -> Footprint {
    let a = uv_dx.x * uv_dx.x + uv_dy.x * uv_dy.x + run.x * run.x;
    let b = uv_dx.x * uv_dx.y + uv_dy.x * uv_dy.y + run.x * run.y;
    let c = uv_dx.y * uv_dx.y + uv_dy.y * uv_dy.y + run.y * run.y;
    let middle = 0.5 * (a + c);
    let half_gap = length(vec2(0.5 * (a - c), b));
    let major = sqrt(middle + half_gap);
    let minor = sqrt(max(0.0, middle - half_gap));
    // Half the angle of (a - c, 2b), without trigonometry: the axis is (gap + (a - c)/2, b), or its mirror where that is short.
    let d = 0.5 * (a - c);
    var axis = select(vec2(b, half_gap - d), vec2(half_gap + d, b), d >= 0.0);
    let size = length(axis);
    axis = select(vec2(1.0, 0.0), axis / size, size > 1e-20);
    let texels = max(minor, major / MAX_ANISOTROPY) * tile.size;
    let level = clamp(log2(max(texels, 1e-6)), 0.0, f32(tile.mips - 1u));
    return Footprint(axis * major, vec2(-axis.y, axis.x) * minor, level);
}

// The ray's sideways run through a slab against the hair's own slope k, in UV.
fn run_through_slab(ray: Ray, slab_m: f32, slope: vec2<f32>) -> vec2<f32> {
    let z = select(-1.0, 1.0, ray.direction.z >= 0.0) * ray.cosine;
    return slab_m * (ray.direction.xy / z - slope) / tile.edge_m;
}

fn gain_of_mip(mip: u32, degrees: f32) -> f32 {
    var angles = GAIN_ANGLES;
    let first = mip * 9u;
    for (var i = 1u; i < 9u; i++) {
        if degrees <= angles[i] {
            return mix(gains[first + i - 1u], gains[first + i], (degrees - angles[i - 1u]) / (angles[i] - angles[i - 1u]));
        }
    }
    return gains[first + 8u];
}

// g(θ) of a level between two mips.
fn gain(level: f32, cosine: f32) -> f32 {
    let degrees = acos(clamp(cosine, 0.0, 1.0)) * (180.0 / PI);
    let mip = u32(level);
    let next = min(mip + 1u, tile.mips - 1u);
    return mix(gain_of_mip(mip, degrees), gain_of_mip(next, degrees), fract(level));
}

// What a texel of the medium holds.
struct Medium {
    extinction_per_m: f32,
    tangent: vec3<f32>,
}

fn decode_medium(texel: vec4<f32>) -> Medium {
    let weighted = (texel.yzw * 255.0 - 128.0) / 127.0;
    let tangent = weighted / max(texel.x, 1e-3);
    return Medium(texel.x * tile.extinction_scale_per_m, tangent / max(1.0, length(tangent)));
}

// Share of the coat that fins carry where the skin's normal is at this cosine to the view: the mean of Lengyel's weight
// max(0, 2|p| - 1) over edges of every direction, p = sin α cos ψ. Shells keep the rest, so that both together hold the
// coat once (docs/steps/runtime.md, "Silhouettes").
fn fin_share(cos_view: f32) -> f32 {
    let sin_view = sqrt(max(0.0, 1.0 - cos_view * cos_view));
    if sin_view <= 0.5 {
        return 0.0;
    }
    let limit = acos(0.5 / sin_view);
    return (2.0 / PI) * (2.0 * sin_view * sin(limit) - limit);
}
