//! Undercoat of the skin, laid into a chart: it stands over its roots there, whatever its lean and length.

use super::flatten::axes;
use super::skirt::{Placed, Region};
use crate::coat::shells::deposit::Voxels;
use crate::coat::shells::undercoat::Profile;
use crate::data::fields::Fields;
use crate::data::mesh::Mesh;
use crate::fur::undercoat::Undercoat;
use crate::math::{Vec2, Vec3};

/// Heights between which crowding is taken as the nearest's.
const LAYERS: usize = 16;
/// Most places along a texel's edge that are looked at.
const MOST_PLACES: f32 = 4.0;

/// A skin that undercoat grows on.
pub struct Ground<'a> {
    mesh: &'a Mesh,
    fields: &'a Fields,
    normals: Vec<Vec3>,
    undercoat: Undercoat,
}

/// What stands on a place.
struct Stand {
    /// Hairs per area of the chart over the preset's density, without crowding.
    density: f32,
    tint: Vec3,
    /// Density over its mean, by height.
    crowding: [f32; LAYERS],
}

impl<'a> Ground<'a> {
    /// Of a skin and its undercoat.
    pub fn new(mesh: &'a Mesh, fields: &'a Fields, undercoat: Undercoat) -> Self {
        Self { mesh, fields, normals: mesh.smooth_normals(), undercoat }
    }

    /// Adds the undercoat over a region's texels, each the mean over what of it is skin.
    pub fn add(&self, region: &Region, profile: &Profile, voxels: &mut Voxels, ends: &mut [f32]) {
        let layout = voxels.layout;
        let across = (2.0 * layout.texel_m / self.undercoat.detail_m()).ceil().clamp(1.0, MOST_PLACES) as usize;
        for texel in 0..layout.texels() {
            let corner = Vec2::new((texel % layout.size[0]) as f32, (texel / layout.size[0]) as f32);
            let (mut count, mut density, mut tint, mut by_height) = (0.0, 0.0, Vec3::ZERO, [0.0_f32; LAYERS]);
            for i in 0..across * across {
                let within = (Vec2::new((i % across) as f32, (i / across) as f32) + 0.5) / across as f32;
                let at = corner + within;
                let Some(stand) = region.at(at).and_then(|p| self.stand(&region.placed[p], at, layout.texel_m)) else {
                    continue;
                };
                count += 1.0;
                density += stand.density;
                tint += stand.density * stand.tint;
                by_height.iter_mut().zip(stand.crowding).for_each(|(sum, c)| *sum += stand.density * c);
            }
            if density > 0.0 {
                let amount = by_height.map(|sum| sum / count);
                profile.fill(voxels, ends, texel, tint / density, |part| {
                    amount[((part.t * LAYERS as f32) as usize).min(LAYERS - 1)]
                });
            }
        }
    }

    /// What stands at a point of a placed triangle, in texels of its region.
    fn stand(&self, placed: &Placed, at: Vec2, texel_m: f32) -> Option<Stand> {
        let Self { mesh, fields, undercoat, .. } = self;
        let corners_m = mesh.corners_m(placed.triangle);
        let [x, y] = axes(corners_m, placed.corners.map(|p| p * texel_m))?;
        let [p, q, r] = placed.corners;
        let twice_area = (q - p).perp_dot(r - p);
        let (b, c) = ((at - p).perp_dot(r - p) / twice_area, (q - p).perp_dot(at - p) / twice_area);
        let share = Vec3::new(1.0 - b - c, b, c);
        let corners = mesh.triangles[placed.triangle].map(|v| v as usize);
        let mix3 = |of: [Vec3; 3]| of[0] * share.x + of[1] * share.y + of[2] * share.z;
        let mix = |values: &[f32]| share.dot(Vec3::from(corners.map(|v| values[v])));
        if mix(&fields.length) <= 0.0 {
            return None;
        }
        let normal = mix3(corners.map(|v| self.normals[v])).normalize_or(Vec3::Y);
        let column = undercoat.column(mix3(corners_m), normal, mix(&fields.clump));
        Some(Stand {
            density: mix(&fields.density) * x.cross(y).length(),
            tint: mix3(corners.map(|v| fields.tint[v])),
            crowding: std::array::from_fn(|layer| column.crowding((layer as f32 + 0.5) / LAYERS as f32)),
        })
    }
}
