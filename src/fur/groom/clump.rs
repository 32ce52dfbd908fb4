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
    let nearer = |a: Vec3, b: Vec3| if b.length_squared() < a.length_squared() { b } else { a };
    to_centres_in_space(root_m, spacing_m, seed).into_iter().fold(Vec3::INFINITY, nearer)
}

/// From `root_m` to the clump centres of its cell and the cells around it, m.
pub fn to_centres_in_space(root_m: Vec3, spacing_m: f32, seed: u64) -> [Vec3; 27] {
    Nearby::default().to_centres(root_m, spacing_m, seed)
}

/// The clump centres around some triangle, for points on it.
#[derive(Clone, Debug)]
pub struct Around {
    /// First cell and how many there are along each axis.
    first: Vec3,
    count: [usize; 3],
    centres_m: Vec<Vec3>,
    spacing_m: f32,
    seed: u64,
}

impl Around {
    /// More centres are not kept.
    const MOST: usize = 1024;

    /// Centres around the triangle between `corners_m`; none are kept where there are too many.
    pub fn new(corners_m: &[Vec3; 3], spacing_m: f32, seed: u64) -> Self {
        let [a, b, c] = corners_m;
        let first = (a.min(*b).min(*c) / spacing_m).floor() - 1.0;
        let last = (a.max(*b).max(*c) / spacing_m).floor() + 1.0;
        let cells = last - first + 1.0;
        let mut around = Self { first, count: [0; 3], centres_m: Vec::new(), spacing_m, seed };
        if cells.x * cells.y * cells.z <= Self::MOST as f32 {
            around.count = cells.to_array().map(|n| n as usize);
            let [x, y, z] = around.count;
            around.centres_m.extend((0..x * y * z).map(|i| {
                let cell = first + Vec3::new((i % x) as f32, (i / x % y) as f32, (i / (x * y)) as f32);
                centre_m(cell, spacing_m, seed)
            }));
        }
        around
    }

    /// As [`to_centre_in_space`].
    pub fn to_centre(&self, root_m: Vec3) -> Vec3 {
        let at = (root_m / self.spacing_m).floor() - self.first;
        let [x, y, z] = at.to_array().map(|v| v as usize);
        let within = |at: f32, count: usize| at >= 1.0 && at as usize + 1 < count;
        if !(within(at.x, self.count[0]) && within(at.y, self.count[1]) && within(at.z, self.count[2])) {
            return to_centre_in_space(root_m, self.spacing_m, self.seed);
        }
        // How far the cells before, around and after the root's are, at least.
        let part = (root_m / self.spacing_m - (at + self.first)) * self.spacing_m;
        let apart = |part: f32| [part * part, 0.0, (self.spacing_m - part) * (self.spacing_m - part)];
        let (apart_y, apart_z) = (apart(part.y), apart(part.z));
        let mut nearest = self.centres_m[(z * self.count[1] + y) * self.count[0] + x] - root_m;
        let mut least = nearest.length_squared();
        for k in 0..3 {
            for j in 0..3 {
                // With room for rounding.
                if (apart_y[j] + apart_z[k]) * 0.999 > least {
                    continue;
                }
                let row = ((z + k - 1) * self.count[1] + y + j - 1) * self.count[0] + x - 1;
                for centre in &self.centres_m[row..row + 3] {
                    let to_centre = *centre - root_m;
                    let squared = to_centre.length_squared();
                    if squared < least {
                        (nearest, least) = (to_centre, squared);
                    }
                }
            }
        }
        nearest
    }
}

fn centre_m(cell: Vec3, spacing_m: f32, seed: u64) -> Vec3 {
    let key = cell.to_array().iter().fold(seed, |key, &c| combine(key, c as i64 as u64));
    let offset = Vec3::new(unit_f32(key), unit_f32(combine(key, 1)), unit_f32(combine(key, 2)));
    (cell + offset) * spacing_m
}

/// The clump centres around a cell, kept for the next point that lies in it.
#[derive(Clone, Copy, Debug)]
pub struct Nearby {
    home: Vec3,
    centres_m: [Vec3; 27],
}

impl Default for Nearby {
    fn default() -> Self {
        Self { home: Vec3::NAN, centres_m: [Vec3::ZERO; 27] }
    }
}

impl Nearby {
    /// As [`to_centres_in_space`]; spacing and seed are those of the calls before.
    pub fn to_centres(&mut self, root_m: Vec3, spacing_m: f32, seed: u64) -> [Vec3; 27] {
        self.centres_m((root_m / spacing_m).floor(), spacing_m, seed).map(|centre| centre - root_m)
    }

    /// The clump centres of cell `home`, which has whole coordinates, and the cells around it, m; spacing and seed are
    /// those of the calls before.
    pub fn centres_m(&mut self, home: Vec3, spacing_m: f32, seed: u64) -> &[Vec3; 27] {
        if home != self.home {
            self.home = home;
            self.centres_m = std::array::from_fn(|i| {
                let cell = home + Vec3::new((i % 3) as f32 - 1.0, (i / 3 % 3) as f32 - 1.0, (i / 9) as f32 - 1.0);
                centre_m(cell, spacing_m, seed)
            });
        }
        &self.centres_m
    }
}
