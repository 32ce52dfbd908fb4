//! Hair on skin: roots by area and density, each hair grown from its root's key alone.

mod parted;
pub mod skin;
pub mod tile;

use crate::data::strands::Strands;
use crate::fur::groom::fibre::{Fibre, LENGTH_SPREAD};
use crate::fur::groom::hair;
use crate::math::hash::{Stream, combine};
use crate::math::{Vec2, Vec3};

/// An empty set of this kind of hair with room for `count`.
fn empty(fibre: &Fibre, count: usize) -> Strands {
    let points_per_strand = hair::points_per_strand(&fibre.shape);
    Strands {
        points_per_strand,
        points_m: Vec::with_capacity(count * points_per_strand),
        roots: Vec::with_capacity(count),
        root_radius_m: Vec::with_capacity(count),
        tint: Vec::with_capacity(count),
        id: Vec::with_capacity(count),
        profile: fibre.profile,
    }
}

/// Length and brightness of the hair with this key: length in m for a mean of `mean_m`, brightness a factor ≤ 1.
fn individual(fibre: &Fibre, mean_m: f32, key: u64) -> (f32, f32) {
    let mut random = Stream::new(combine(key, 0x6861_6972));
    let spread = random.normal().clamp(-LENGTH_SPREAD, LENGTH_SPREAD);
    let brightness = 1.0 - fibre.variation * random.unit();
    (mean_m * (1.0 + spread * fibre.shape.length_variation), brightness)
}

/// The points of the hair with this key in shell space, root at the origin, m.
fn course(fibre: &Fibre, length_m: f32, clump: f32, to_clump_m: Vec2, key: u64, points_m: &mut [Vec3]) {
    hair::shape_hair(&fibre.shape, length_m, combine(key, 0x7368_6170), to_clump_m * clump, points_m);
}
