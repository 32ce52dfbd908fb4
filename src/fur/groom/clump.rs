//! Where clumps have their centres: one in each cell of a grid in space, moved about at random (Worley 1996). A surface
//! needs no coordinates for it.

use crate::math::Vec3;
use crate::math::hash::{combine, unit_f32};

/// A grid of clump centres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClumpGrid {
    /// Edge of a cell: the mean distance between centres, m.
    pub spacing_m: f32,
    /// Cells after which it repeats along x and along y; none in space.
    pub period: Option<f32>,
}

impl ClumpGrid {
    /// A grid that goes on without end.
    pub fn in_space(spacing_m: f32) -> Self {
        Self { spacing_m, period: None }
    }

    /// A grid that repeats after `edge_m`: the spacing becomes a whole part of it.
    pub fn on_torus(spacing_m: f32, edge_m: f32) -> Self {
        let cells = (edge_m / spacing_m).round().max(1.0);
        Self { spacing_m: edge_m / cells, period: Some(cells) }
    }

    /// From `root_m` to the nearest centre, m.
    pub fn to_centre_m(&self, root_m: Vec3) -> Vec3 {
        let centres_m = self.centres_m((root_m / self.spacing_m).floor());
        let nearer = |a: Vec3, b: Vec3| if b.length_squared() < a.length_squared() { b } else { a };
        centres_m.into_iter().map(|centre_m| centre_m - root_m).fold(Vec3::INFINITY, nearer)
    }

    /// The centres of cell `home`, which has whole coordinates, and of the cells around it, m.
    fn centres_m(&self, home: Vec3) -> [Vec3; 27] {
        std::array::from_fn(|i| {
            self.centre_m(home + Vec3::new((i % 3) as f32 - 1.0, (i / 3 % 3) as f32 - 1.0, (i / 9) as f32 - 1.0))
        })
    }

    /// The centre of a cell, m.
    fn centre_m(&self, cell: Vec3) -> Vec3 {
        let wrapped = |c: f32| self.period.map_or(c, |cells| c.rem_euclid(cells));
        let key = [wrapped(cell.x), wrapped(cell.y), cell.z].iter().fold(0, |key, &c| combine(key, c as i64 as u64));
        let offset = Vec3::new(unit_f32(key), unit_f32(combine(key, 1)), unit_f32(combine(key, 2)));
        (cell + offset) * self.spacing_m
    }
}

/// The clump centres around some triangle, for points on it.
#[derive(Clone, Debug)]
pub struct Around {
    /// First cell and how many there are along each axis.
    first: Vec3,
    count: [usize; 3],
    centres_m: Vec<Vec3>,
    grid: ClumpGrid,
}

impl Around {
    /// More centres are not kept.
    const MOST: usize = 1024;

    /// Centres around the triangle between `corners_m`; none are kept where there are too many.
    pub fn new(corners_m: &[Vec3; 3], grid: ClumpGrid) -> Self {
        let [a, b, c] = corners_m;
        let first = (a.min(*b).min(*c) / grid.spacing_m).floor() - 1.0;
        let last = (a.max(*b).max(*c) / grid.spacing_m).floor() + 1.0;
        let cells = last - first + 1.0;
        let mut around = Self { first, count: [0; 3], centres_m: Vec::new(), grid };
        if cells.x * cells.y * cells.z <= Self::MOST as f32 {
            around.count = cells.to_array().map(|n| n as usize);
            let [x, y, z] = around.count;
            around.centres_m.extend(
                (0..x * y * z).map(|i| {
                    grid.centre_m(first + Vec3::new((i % x) as f32, (i / x % y) as f32, (i / (x * y)) as f32))
                }),
            );
        }
        around
    }

    /// As [`ClumpGrid::to_centre_m`].
    pub fn to_centre_m(&self, root_m: Vec3) -> Vec3 {
        let at = (root_m / self.grid.spacing_m).floor() - self.first;
        let [x, y, z] = at.to_array().map(|v| v as usize);
        let within = |at: f32, count: usize| at >= 1.0 && at as usize + 1 < count;
        if !(within(at.x, self.count[0]) && within(at.y, self.count[1]) && within(at.z, self.count[2])) {
            return self.grid.to_centre_m(root_m);
        }
        // How far the cells before, around and after the root's are, at least.
        let part = (root_m / self.grid.spacing_m - (at + self.first)) * self.grid.spacing_m;
        let apart = |part: f32| [part * part, 0.0, (self.grid.spacing_m - part) * (self.grid.spacing_m - part)];
        let (apart_y, apart_z) = (apart(part.y), apart(part.z));
        let mut nearest = self.centres_m[(z * self.count[1] + y) * self.count[0] + x] - root_m;
        let mut least = nearest.length_squared();
        for (k, apart_z) in apart_z.into_iter().enumerate() {
            for (j, apart_y) in apart_y.into_iter().enumerate() {
                // With room for rounding.
                if (apart_y + apart_z) * 0.999 > least {
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

/// The clump centres around a cell, kept for the next point that lies in it.
#[derive(Clone, Copy, Debug)]
pub struct Nearby {
    home: Vec3,
    grid: Option<ClumpGrid>,
    centres_m: [Vec3; 27],
}

impl Default for Nearby {
    fn default() -> Self {
        Self { home: Vec3::NAN, grid: None, centres_m: [Vec3::ZERO; 27] }
    }
}

impl Nearby {
    /// The centres of cell `home`, which has whole coordinates, and of the cells around it, m.
    pub fn centres_m(&mut self, home: Vec3, grid: &ClumpGrid) -> &[Vec3; 27] {
        if home != self.home || self.grid != Some(*grid) {
            (self.home, self.grid) = (home, Some(*grid));
            self.centres_m = grid.centres_m(home);
        }
        &self.centres_m
    }
}
