//! The opaque skin in one tile of the picture.

use super::flat::{Flat, pixel_ray};
use super::prepared::Prepared;
use super::resolve::Appearance;
use crate::math::Vec3;
use crate::math::fast::exp_negative;
use crate::stage::projection::Projection;
use crate::volume::bins::TILE;
use crate::volume::scene::{sky_depth, slant_depth, terminator};
use std::f32::consts::FRAC_1_PI;

/// No triangle.
pub const NONE: u32 = u32::MAX;

/// Nearest skin per pixel of a tile, rows from the top.
#[derive(Clone, Debug)]
pub struct SkinTile {
    /// Depth along the optical axis, m; infinite where there is none.
    pub z_m: Vec<f32>,
    /// Triangle, or [`NONE`].
    pub triangle: Vec<u32>,
    /// Greatest of `z_m`.
    pub far_m: f32,
}

impl SkinTile {
    /// Draws `triangles` of the camera-space corners that `corners` gives into the tile at (`column`, `row`).
    ///
    /// Both sides are opaque. Of equal depths the triangle with the lower index stays.
    pub fn draw(
        view: &Projection,
        column: usize,
        row: usize,
        triangles: &[u32],
        corners: impl Fn(u32) -> [Vec3; 3],
        reach: impl Fn(u32) -> [std::ops::Range<usize>; 2],
    ) -> Self {
        let mut tile = Self { z_m: vec![f32::INFINITY; TILE * TILE], triangle: vec![NONE; TILE * TILE], far_m: 0.0 };
        let (x0, y0) = (column * TILE, row * TILE);
        for &t in triangles {
            let flat = Flat::new(corners(t));
            let [columns, rows] = reach(t);
            for y in rows.start.max(y0)..rows.end.min(y0 + TILE) {
                for x in columns.start.max(x0)..columns.end.min(x0 + TILE) {
                    let at = (y - y0) * TILE + x - x0;
                    if let Some(meeting) = flat.meet(pixel_ray(view, x, y))
                        && meeting.z_m > view.near_m
                        && meeting.z_m < tile.z_m[at]
                    {
                        tile.z_m[at] = meeting.z_m;
                        tile.triangle[at] = t;
                    }
                }
            }
        }
        tile.far_m = tile.z_m.iter().copied().fold(0.0, f32::max);
        tile
    }
}

/// What skin looks like where a ray from the eye along `direction` meets triangle `t`: diffuse, under all of its hair.
pub fn shade(prepared: &Prepared<'_>, t: u32, barycentric: Vec3, direction: Vec3, z_m: f32) -> Appearance {
    let Prepared { scene, lighting, normals, mean, .. } = prepared;
    let corners = scene.skin.triangles[t as usize].map(|v| v as usize);
    let b = barycentric;
    let mix3 = |values: &[Vec3]| values[corners[0]] * b.x + values[corners[1]] * b.y + values[corners[2]] * b.z;
    let mix1 = |values: &[f32]| values[corners[0]] * b.x + values[corners[1]] * b.y + values[corners[2]] * b.z;
    let outside = mix3(normals).normalize_or(Vec3::Y);
    let back = direction.dot(outside) > 0.0;
    let normal = if back { -outside } else { outside };
    let lean = mix3(&scene.fields.lean).normalize_or(normal);
    let albedo = mix3(&scene.fields.tint) * scene.skin_factor;
    let (density, length) = (mix1(&scene.fields.density), mix1(&scene.fields.length));
    // The back of the skin is bare.
    let above = if back { 0.0 } else { prepared.above.at(0.0, density, length) };
    let mut radiance = lighting.ambient * albedo * exp_negative(-sky_depth(above));
    let at_m = mix3(&scene.skin.positions_m);
    for (i, light) in lighting.all().map(|light| light.at(at_m)).enumerate() {
        let cosine = light.to_light.dot(normal);
        if cosine > 0.0 {
            let depth = match mean {
                Some(mean) if i == 0 && !back => mean.depth(t, b, 0.0),
                _ => slant_depth(above, light.to_light, normal, lean),
            };
            let shadow = exp_negative(-depth);
            radiance += light.irradiance * albedo * (FRAC_1_PI * cosine * shadow * terminator(light.to_light, normal));
        }
    }
    Appearance { z_m, radiance, albedo, tangent: Vec3::ZERO, normal }
}
