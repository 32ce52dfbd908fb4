//! Turns patches so that the comb runs along +u, and scales them to the tile.

use super::face::Face;
use crate::data::mesh::Mesh;
use crate::math::{DVec2, Vec2, Vec3};

/// Gives each patch the similarity that fits the comb and the tile best: mirrored patches are turned over, the mean
/// comb (weighted by area) becomes +u, and the patch's area becomes that of its skin. Patches without comb keep their
/// angle, those without area their scale.
///
/// `patch_of` has one entry per triangle; `uv` is read in any unit and written in tiles, not moved to any origin.
pub(super) fn align(
    mesh: &Mesh,
    faces: &[Face],
    direction: &[Vec3],
    tile_edge_m: f64,
    triangles: &[[u32; 3]],
    patch_of: &[u32],
    uv: &mut [Vec2],
) {
    #[derive(Clone, Copy, Default)]
    struct Sums {
        skin: f64,
        texture: f64,
        signed: f64,
        comb: DVec2,
        mirrored_comb: DVec2,
    }
    let patches = patch_of.iter().max().map_or(0, |&p| p as usize + 1);
    let mut sums = vec![Sums::default(); patches];
    for (t, face) in faces.iter().enumerate() {
        let Some([x, y]) = face.jacobian(triangles[t].map(|v| uv[v as usize].as_dvec2())) else { continue };
        let sum = &mut sums[patch_of[t] as usize];
        let texture = x.perp_dot(y);
        sum.skin += face.area_m2;
        sum.texture += face.area_m2 * texture.abs();
        sum.signed += face.area_m2 * texture;
        let comb = face.comb(mesh.triangles[t].map(|v| direction[v as usize]));
        let seen = (x * comb.x + y * comb.y).normalize_or_zero() * (face.area_m2 * comb.length());
        sum.comb += seen;
        sum.mirrored_comb += DVec2::new(seen.x, -seen.y);
    }
    let maps: Vec<[DVec2; 2]> = sums
        .iter()
        .map(|sum| {
            let mirror = if sum.signed < 0.0 { -1.0 } else { 1.0 };
            let comb = if mirror < 0.0 { sum.mirrored_comb } else { sum.comb };
            let turn = comb.normalize_or(DVec2::X);
            let scale = if sum.texture > 0.0 { (sum.skin / sum.texture).sqrt() } else { 1.0 } / tile_edge_m;
            [DVec2::new(turn.x, -turn.y) * scale, DVec2::new(turn.y, turn.x) * (mirror * scale)]
        })
        .collect();
    let mut done = vec![false; uv.len()];
    for (t, triangle) in triangles.iter().enumerate() {
        let [x, y] = maps[patch_of[t] as usize];
        for &v in triangle {
            if !std::mem::replace(&mut done[v as usize], true) {
                let p = uv[v as usize].as_dvec2();
                uv[v as usize] = (x * p.x + y * p.y).as_vec2();
            }
        }
    }
}
