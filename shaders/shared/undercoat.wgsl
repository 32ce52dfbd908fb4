// How undercoat crowds over a point of the skin, as src/fur/undercoat.rs, and how that is stored, as src/volume/shell/block.rs.
#define_import_path furrier::undercoat

#import furrier::constants::LARGEST
#import furrier::scene::{scene, triangles, vertices, clump_at, unit_or}
#import furrier::hash::{combine, unit, wide_of}
#import furrier::noise::simplex

// In place of an infinite distance.
const FAR: f32 = 1e30;

struct Column {
    at: vec3<f32>,
    blur: vec3<f32>,
    strength: f32,
    // The q at which hair would come from beyond the clump's cell.
    wall: f32,
}

// Where the nearest clump's cell ends, seen from its centre through `root_m`, as a factor on the distance.
fn clump_wall(root_m: vec3<f32>, normal: vec3<f32>) -> f32 {
    let spacing_m = scene.clump_spacing_m;
    let home = floor(root_m / spacing_m);
    var centres: array<vec3<f32>, 27>;
    var own = vec3(FAR);
    for (var i = 0u; i < 27u; i++) {
        let cell = home + vec3(f32(i % 3u), f32(i / 3u % 3u), f32(i / 9u)) - 1.0;
        let key = combine(combine(combine(vec2(0u), wide_of(i32(cell.x))), wide_of(i32(cell.y))), wide_of(i32(cell.z)));
        let offset = vec3(unit(key), unit(combine(key, vec2(1u, 0u))), unit(combine(key, vec2(2u, 0u))));
        let centre = (cell + offset) * spacing_m - root_m;
        centres[i] = centre;
        if dot(centre, centre) < dot(own, own) {
            own = centre;
        }
    }
    let away = normal * dot(own, normal) - own;
    var wall = FAR;
    for (var i = 0u; i < 27u; i++) {
        let across = dot(away, centres[i] - own);
        if across > 0.0 {
            let left = 0.5 * (dot(centres[i], centres[i]) - dot(own, own));
            wall = min(wall, 1.0 + left / across);
        }
    }
    return wall;
}

// What crowds the hair over a point of a triangle, at all heights (Andersen et al. 2016 §3.2).
fn column_over(triangle: u32, b: vec3<f32>) -> Column {
    let c = triangles[triangle].corners;
    let root_m = vertices[c.x].rest_m * b.x + vertices[c.y].rest_m * b.y + vertices[c.z].rest_m * b.z;
    var column = Column(vec3(0.0), vec3(0.0), scene.clump_strength * clump_at(triangle, b), FAR);
    if scene.pattern_amplitude > 0.0 {
        column.at = root_m / scene.pattern_wavelength_m;
        let first = simplex(column.at * 4.0, 1u);
        column.blur = scene.pattern_jitter * vec3(first, simplex(column.at * 4.0, 2u), -first);
    }
    if column.strength > 1e-3 {
        let normal = vertices[c.x].rest_normal * b.x + vertices[c.y].rest_normal * b.y + vertices[c.z].rest_normal * b.z;
        column.wall = clump_wall(root_m, unit_or(normal, vec3(0.0, 1.0, 0.0)));
    }
    return column;
}

// Density over its mean at height t.
fn column_crowding(column: Column, t: f32) -> f32 {
    var factor = 1.0;
    if scene.pattern_amplitude > 0.0 {
        factor += scene.pattern_amplitude * simplex(column.at + column.blur * t, 0u);
    }
    let q = 1.0 / (1.0 - min(column.strength * t * sqrt(t), 0.9));
    return select(0.0, factor * q * q, q < column.wall);
}

// Square-root coding into a byte.
fn code_value(value: f32) -> u32 {
    return u32(sqrt(clamp(value / LARGEST, 0.0, 1.0)) * 255.0 + 0.5);
}

fn decode_value(byte: u32) -> f32 {
    let root = f32(byte) * (1.0 / 255.0);
    return root * root * LARGEST;
}

// Mean |sin| between a ray and the hairs, where the mean hair's is `sine`.
fn mean_sine(sine: f32) -> f32 {
    let variance = scene.slope * scene.slope;
    let square = sine * sine;
    let c = 1.0 + 0.570796 * variance / (variance + 0.434 * square + 1e-12);
    return min(sqrt((square + c * variance) / (1.0 + variance)), 1.0);
}
