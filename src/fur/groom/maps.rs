//! The comb that a map paints, at a mesh's vertices.

use crate::data::image::Image8;
use crate::data::maps::{painted_comb, uv_axes};
use crate::data::mesh::Mesh;
use crate::math::{Vec2, Vec3};

/// The comb direction that `map` paints at every vertex, world axes; zero where it paints none or the UVs have no
/// direction.
pub fn comb_directions(mesh: &Mesh, uv: &[Vec2], map: &Image8) -> Vec<Vec3> {
    let mut along_u = vec![Vec3::ZERO; uv.len()];
    let mut along_v = vec![Vec3::ZERO; uv.len()];
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        let [u, v] = uv_axes(mesh.corners_m(t), triangle.map(|v| uv[v as usize]));
        for &corner in triangle {
            along_u[corner as usize] += u;
            along_v[corner as usize] += v;
        }
    }
    let direction = |v: usize| {
        let [right, up] = painted_comb(map, uv[v]);
        let normal = mesh.normals[v];
        let wish = along_u[v].normalize_or_zero() * right - along_v[v].normalize_or_zero() * up;
        (wish - normal * wish.dot(normal)).normalize_or_zero()
    };
    (0..uv.len()).map(direction).collect()
}
