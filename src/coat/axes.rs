//! How hair stands on the skin: its own axes, whichever way patches lie there (`docs/steps/patch.md`, "Axes").

use crate::data::mesh::Mesh;
use crate::data::patches::Patches;
use crate::data::shell::Incidence;
use crate::data::shell::guards::{LEAST_AXIS, MOST_SPREAD};
use crate::math::{Mat2, Mat3, Vec2, Vec3};

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
    pub fn seen(&self, ray: Vec3, pixel: f32) -> Incidence {
        let Self { normal, up, spread, .. } = *self;
        let [u, v] = self.texture.map(|axis| axis.reject_from_normalized(normal));
        let along = self.axis.reject_from_normalized(normal);
        let told = along.length() > LEAST_AXIS * self.axis.length();
        let x = if told { along } else { u }.normalize_or_zero();
        let y = normal.cross(x);
        let spread = spread.clamp(1.0 / MOST_SPREAD, MOST_SPREAD);
        let seen = Incidence::new(ray, Mat3::from_cols(x * spread, y * spread, up), pixel);
        // The axes as sums of u and v: all four lie along the skin.
        let area = normal.dot(u.cross(v));
        let in_texture = |axis: Vec3| Vec2::new(axis.cross(v).dot(normal), u.cross(axis).dot(normal)) * (spread / area);
        if area.abs() > FLAT { seen.on_texture(Mat2::from_cols(in_texture(x), in_texture(y))) } else { seen }
    }
}

/// A texture that a place of the skin has less of than this share of it has no axes there.
const FLAT: f32 = 1e-9;
