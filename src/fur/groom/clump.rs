//! Where clumps have their centres: one in each cell of a grid, moved about at random (Worley 1996).

use crate::math::hash::{combine, unit_f32};
use crate::math::{Vec2, Vec3};

/// From `root_m` on a toroidal tile to the nearest clump centre, m.
pub fn to_centre_on_tile(root_m: Vec2, edge_m: f32, spacing_m: f32, seed: u64) -> Vec2 {
    let cells = (edge_m / spacing_m).round().max(1.0) as i64;
    let size = edge_m / cells as f32;
    let home = (root_m / size).floor();
    let mut nearest = Vec2::splat(f32::INFINITY);
    for dy in -1..=1 {
        for dx in -1..=1 {
            let (x, y) = (home.x as i64 + dx, home.y as i64 + dy);
            let key = combine(combine(seed, x.rem_euclid(cells) as u64), y.rem_euclid(cells) as u64);
            let centre = Vec2::new(x as f32 + unit_f32(key), y as f32 + unit_f32(combine(key, 1))) * size;
            if (centre - root_m).length_squared() < nearest.length_squared() {
                nearest = centre - root_m;
            }
        }
    }
    nearest
}

/// From `root_m` in space to the nearest clump centre, m. The grid is in space, so a surface needs no coordinates.
pub fn to_centre_in_space(root_m: Vec3, spacing_m: f32, seed: u64) -> Vec3 {
    let home = (root_m / spacing_m).floor();
    let mut nearest = Vec3::splat(f32::INFINITY);
    for i in 0..27 {
        let cell = home + Vec3::new((i % 3 - 1) as f32, (i / 3 % 3 - 1) as f32, (i / 9 - 1) as f32);
        let key = cell.to_array().iter().fold(seed, |key, &c| combine(key, c as i64 as u64));
        let offset = Vec3::new(unit_f32(key), unit_f32(combine(key, 1)), unit_f32(combine(key, 2)));
        let to = (cell + offset) * spacing_m - root_m;
        if to.length_squared() < nearest.length_squared() {
            nearest = to;
        }
    }
    nearest
}
