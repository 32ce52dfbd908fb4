//! Smooth noise in space.

use super::Vec3;

/// Simplex noise (Perlin 2001; the kernel (0.6 − r²)⁴ of Gustavson 2005), mean 0, within [−1, 1], features about 1 apart.
pub fn simplex(p: Vec3, seed: u32) -> f32 {
    let skewed = p + (p.x + p.y + p.z) * (1.0 / 3.0);
    let cell = skewed.floor();
    let x0 = p - (cell - (cell.x + cell.y + cell.z) * (1.0 / 6.0));
    // The two middle corners of the tetrahedron that holds the point, by the order of its coordinates.
    let ge = |a: f32, b: f32| f32::from(u8::from(a >= b));
    let (xy, yz, zx) = (ge(x0.x, x0.y), ge(x0.y, x0.z), ge(x0.z, x0.x));
    let rank = Vec3::new(xy + (1.0 - zx), (1.0 - xy) + yz, (1.0 - yz) + zx);
    let first = Vec3::new(ge(rank.x, 2.0), ge(rank.y, 2.0), ge(rank.z, 2.0));
    let second = Vec3::new(ge(rank.x, 1.0), ge(rank.y, 1.0), ge(rank.z, 1.0));
    let corners = [(Vec3::ZERO, 0.0), (first, 1.0 / 6.0), (second, 1.0 / 3.0), (Vec3::ONE, 0.5)];
    let mut sum = 0.0;
    for (corner, unskew) in corners {
        let d = x0 - corner + unskew;
        let fall = 0.6 - d.length_squared();
        if fall > 0.0 {
            sum += fall * fall * fall * fall * d.dot(gradient(cell + corner, seed));
        }
    }
    32.0 * sum
}

/// One of the twelve edge directions of a cube.
fn gradient(corner: Vec3, seed: u32) -> Vec3 {
    let mut h = seed;
    for c in corner.to_array() {
        h = (h ^ (c as i32 as u32)).wrapping_mul(0x9E37_79B1);
        h ^= h >> 15;
    }
    h = h.wrapping_mul(0x85EB_CA77);
    let sign = |bit: u32| if h >> bit & 1 == 0 { 1.0 } else { -1.0 };
    let (u, v) = (sign(31), sign(30));
    match (h >> 8) % 3 {
        0 => Vec3::new(u, v, 0.0),
        1 => Vec3::new(u, 0.0, v),
        _ => Vec3::new(0.0, u, v),
    }
}
