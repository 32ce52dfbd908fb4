//! How hair stands on the skin: its own axes, whichever way patches lie there (`docs/steps/patch.md`, "Axes").

use crate::data::mesh::Mesh;
use crate::data::patches::Patches;
use crate::math::{Mat2, Mat3, Vec3};
use crate::runtime::cpu::View;

/// The tile's x axis at each skin vertex, unit tangent vectors in world axes: the comb, and where it is zero (hair
/// upright all around) the mean of +u over the triangles there, whatever their patch. The same for all vertices at one
/// place; zero only where no triangle has area.
pub fn axes(mesh: &Mesh, comb: &[Vec3], patches: &Patches) -> Vec<Vec3> {
    if comb.iter().all(|c| *c != Vec3::ZERO) {
        return comb.to_vec();
    }
    let mut sums = vec![Vec3::ZERO; mesh.positions_m.len()];
    for (t, triangle) in patches.triangles.iter().enumerate() {
        let [a, b, c] = mesh.corners_m(t);
        let [p, q, r] = triangle.map(|v| patches.uv[v as usize]);
        let area = (q - p).perp_dot(r - p);
        let along = ((b - a) * (r - p).y - (c - a) * (q - p).y) * area.signum();
        let along = along.normalize_or_zero() * mesh.area_m2(t);
        mesh.triangles[t].iter().for_each(|&v| sums[mesh.position_class[v as usize] as usize] += along);
    }
    let normals = mesh.smooth_normals();
    let mean = |v: usize| sums[mesh.position_class[v] as usize].reject_from_normalized(normals[v]).normalize_or_zero();
    (0..comb.len()).map(|v| if comb[v] == Vec3::ZERO { mean(v) } else { comb[v] }).collect()
}

/// What one metre of the skin is at a place: a step along the texture's u and v over the tile's edge, which way its hair
/// stands, and how much wider it is than at the root.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stand {
    /// Unit normal.
    pub normal: Vec3,
    /// The tile's x axis, as [`axes`] has it.
    pub axis: Vec3,
    /// Root to the top of the stack, over its height.
    pub up: Vec3,
    /// A step along the texture's u and v.
    pub texture: [Vec3; 2],
    /// Square root of the area here over that on the skin.
    pub spread: f32,
}

impl Stand {
    /// How it is seen along the unit direction `ray`, which points in, through a pixel of `pixel` tile edges: the law as
    /// shaders have it.
    pub fn view(&self, ray: Vec3, pixel: f32) -> View {
        let Self { normal, up, texture, spread, .. } = *self;
        let x = self.axis.reject_from_normalized(normal).normalize_or(texture[0].normalize_or_zero());
        let rise = up.dot(normal);
        let up = up + normal * (rise.max(1e-3) - rise);
        let hair = Mat3::from_cols(x * spread, normal.cross(x) * spread, up);
        let texture = Mat3::from_cols(texture[0], texture[1], up);
        let sound = texture.determinant().abs() > 1e-9;
        let map = if sound { texture.inverse() * hair } else { Mat3::IDENTITY };
        let texture_from_tile = Mat2::from_cols(map.x_axis.truncate(), map.y_axis.truncate());
        View { texture_from_tile, ..View::new(ray, hair, pixel) }
    }
}
