//! Hair on a flat toroidal tile, lean removed: x and y along the skin, z the height.

use super::{course, empty, individual};
use crate::data::strands::{Root, Strands};
use crate::fur::groom::clump::ClumpGrid;
use crate::fur::groom::fibre::Fibre;
use crate::math::hash::{combine, mix};
use crate::math::{Vec3, sampling};

/// Grows one kind of hair on a tile with edge `edge_m`.
///
/// Roots lie in [0, edge)²; hairs may reach beyond it and continue on the other side.
pub fn grow(fibre: &Fibre, edge_m: f32, seed: u64) -> Strands {
    let count = (fibre.density_per_m2 * edge_m * edge_m).round() as u64;
    let mut strands = empty(fibre, count as usize);
    let mut points = vec![Vec3::ZERO; strands.points_per_strand];
    let clumps = ClumpGrid::on_torus(fibre.shape.clump.spacing_mm * 1e-3, edge_m);
    for i in 0..count {
        let root = sampling::r2(i, mix(seed)) * edge_m;
        let key = combine(seed, i);
        let (length_m, brightness) = individual(fibre, fibre.length_m, key);
        let to_clump = clumps.to_centre_m(root.extend(0.0)).truncate();
        course(fibre, length_m, 1.0, to_clump, key, &mut points);
        strands.points_m.extend(points.iter().map(|&p| p + root.extend(0.0)));
        strands.roots.push(Root::default());
        strands.root_radius_m.push(fibre.radius_m);
        strands.tint.push(Vec3::splat(brightness));
        strands.id.push(i as u32);
    }
    strands
}
