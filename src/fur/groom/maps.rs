//! Groom maps: images over a mesh's UV set, sampled at its vertices.

use crate::data::image::{Image8, linear_from_srgb};
use crate::data::mesh::Mesh;
use crate::math::{Vec2, Vec3, Vec4};

/// Decoded maps; each is RGBA.
#[derive(Clone, Debug, Default)]
pub struct Maps {
    /// Red: factor on density.
    pub density: Option<Image8>,
    /// Red: factor on length.
    pub length: Option<Image8>,
    /// Red along +u, green along −v (up in the image), 128 for zero; alpha: factor on length.
    pub comb: Option<Image8>,
    /// Hair colour in sRGB coding.
    pub colour: Option<Image8>,
    /// Red: factor on clump strength.
    pub clump: Option<Image8>,
}

impl Maps {
    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        [&self.density, &self.length, &self.comb, &self.colour, &self.clump].iter().all(|map| map.is_none())
    }
}

/// Bilinear sample at `uv` (v down, repeating), each channel in [0, 1].
pub fn sample(image: &Image8, uv: Vec2) -> Vec4 {
    let size = Vec2::new(image.width as f32, image.height as f32);
    let p = (uv - uv.floor()) * size - 0.5;
    let (low, t) = (p.floor(), p - p.floor());
    let texel = |dx: i64, dy: i64| {
        let x = (low.x as i64 + dx).rem_euclid(i64::from(image.width)) as u32;
        let y = (low.y as i64 + dy).rem_euclid(i64::from(image.height)) as u32;
        let bytes = image.pixel(x, y);
        Vec4::new(f32::from(bytes[0]), f32::from(bytes[1]), f32::from(bytes[2]), f32::from(bytes[3])) / 255.0
    };
    texel(0, 0).lerp(texel(1, 0), t.x).lerp(texel(0, 1).lerp(texel(1, 1), t.x), t.y)
}

/// An sRGB-coded sample as linear colour.
pub fn sample_colour(image: &Image8, uv: Vec2) -> Vec3 {
    sample(image, uv).truncate().map(linear_from_srgb)
}

/// The comb direction that `map` paints at every vertex, world axes; zero where it paints none or the UVs have no
/// direction.
pub fn comb_directions(mesh: &Mesh, uv: &[Vec2], map: &Image8) -> Vec<Vec3> {
    let mut along_u = vec![Vec3::ZERO; uv.len()];
    let mut along_v = vec![Vec3::ZERO; uv.len()];
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        let [a, b, c] = mesh.corners_m(t);
        let [ua, ub, uc] = triangle.map(|v| uv[v as usize]);
        let (e1, e2, d1, d2) = (b - a, c - a, ub - ua, uc - ua);
        let determinant = d1.perp_dot(d2);
        // Times the determinant's sign instead of divided by it: weights by area, and slivers stay finite.
        let sign = if determinant < 0.0 { -1.0 } else { 1.0 };
        for &v in triangle {
            along_u[v as usize] += (e1 * d2.y - e2 * d1.y) * sign;
            along_v[v as usize] += (e2 * d1.x - e1 * d2.x) * sign;
        }
    }
    let direction = |v: usize| {
        let painted = sample(map, uv[v]);
        let (right, up) = (painted.x * 255.0 - 128.0, painted.y * 255.0 - 128.0);
        if right.abs().max(up.abs()) < 1.5 {
            return Vec3::ZERO;
        }
        let normal = mesh.normals[v];
        let wish = along_u[v].normalize_or_zero() * right - along_v[v].normalize_or_zero() * up;
        (wish - normal * wish.dot(normal)).normalize_or_zero()
    };
    (0..uv.len()).map(direction).collect()
}
