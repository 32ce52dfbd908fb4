// Smooth noise in space, as src/math/noise.rs.
#define_import_path furrier::noise

// One of the twelve edge directions of a cube.
fn gradient(corner: vec3<f32>, seed: u32) -> vec3<f32> {
    var h = seed;
    for (var i = 0u; i < 3u; i++) {
        h = (h ^ bitcast<u32>(i32(corner[i]))) * 0x9E3779B1u;
        h ^= h >> 15u;
    }
    h *= 0x85EBCA77u;
    let u = select(-1.0, 1.0, (h >> 31u) == 0u);
    let v = select(-1.0, 1.0, ((h >> 30u) & 1u) == 0u);
    let axis = (h >> 8u) % 3u;
    return select(select(vec3(0.0, u, v), vec3(u, 0.0, v), axis == 1u), vec3(u, v, 0.0), axis == 0u);
}

fn corner_part(x: vec3<f32>, cell: vec3<f32>, corner: vec3<f32>, unskew: f32, seed: u32) -> f32 {
    let d = x - corner + unskew;
    let fall = max(0.6 - dot(d, d), 0.0);
    return fall * fall * fall * fall * dot(d, gradient(cell + corner, seed));
}

// Simplex noise (Perlin 2001; the kernel (0.6 - r²)⁴ of Gustavson 2005), mean 0, within [-1, 1].
fn simplex(p: vec3<f32>, seed: u32) -> f32 {
    let cell = floor(p + (p.x + p.y + p.z) * (1.0 / 3.0));
    let x = p - (cell - (cell.x + cell.y + cell.z) * (1.0 / 6.0));
    let xy = select(0.0, 1.0, x.x >= x.y);
    let yz = select(0.0, 1.0, x.y >= x.z);
    let zx = select(0.0, 1.0, x.z >= x.x);
    let rank = vec3(xy + (1.0 - zx), (1.0 - xy) + yz, (1.0 - yz) + zx);
    let first = select(vec3(0.0), vec3(1.0), rank >= vec3(2.0));
    let second = select(vec3(0.0), vec3(1.0), rank >= vec3(1.0));
    return 32.0 * (corner_part(x, cell, vec3(0.0), 0.0, seed) + corner_part(x, cell, first, 1.0 / 6.0, seed)
        + corner_part(x, cell, second, 1.0 / 3.0, seed) + corner_part(x, cell, vec3(1.0), 0.5, seed));
}
