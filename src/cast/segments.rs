//! Hair cut into segments for a hierarchy: short enough that a segment's box holds little but the segment.

use super::Geometry;
use super::bvh::Bvh;
use super::cone::Cone;
use crate::data::strands::Strands;
use crate::math::{Mat3, Vec3};
use rayon::prelude::*;

/// Widest box of a segment, in hair radii: a box of long leaning hair is full of other hairs, which every ray through it
/// must try.
const WIDEST: f32 = 24.0;
/// Most segments between two points of a strand.
const MOST: f32 = 12.0;

/// A segment of a hair, or a triangle of the skin.
#[derive(Clone, Copy, Debug)]
pub struct Segment {
    /// The segment, in the world; of no use for a triangle.
    pub cone: Cone,
    /// 0 guard hair, 1 undercoat, 2 skin.
    pub set: u8,
    /// Hair or triangle.
    pub index: u32,
    /// Where along the hair it begins and ends, in [0, 1].
    pub span: [f32; 2],
}

/// The segments of a geometry in the order of their hierarchy's leaves, and the hierarchy.
pub fn build(geometry: &Geometry<'_>) -> (Vec<Segment>, Bvh) {
    let upright = geometry.upright_from_world;
    let mut segments = Vec::new();
    for (set, strands) in [geometry.guard, geometry.undercoat].into_iter().enumerate() {
        let Some(strands) = strands else { continue };
        let of_strand = |strand: usize| {
            let mut segments = Vec::new();
            cut(strands, strand, set as u8, &upright, &mut segments);
            segments
        };
        segments.par_extend((0..strands.len()).into_par_iter().flat_map_iter(of_strand));
    }
    let mut bounds: Vec<(Vec3, Vec3)> = segments.par_iter().map(|segment| bounds_of(&segment.cone, &upright)).collect();
    if let Some(skin) = geometry.skin {
        let nothing = Cone { from_m: Vec3::ZERO, to_m: Vec3::ZERO, from_radius_m: 0.0, to_radius_m: 0.0 };
        for t in 0..skin.triangles.len() {
            let [a, b, c] = skin.corners_m(t).map(|corner| upright * corner);
            bounds.push((a.min(b).min(c), a.max(b).max(c)));
            segments.push(Segment { cone: nothing, set: 2, index: t as u32, span: [0.0, 1.0] });
        }
    }
    let mut bvh = Bvh::new(&bounds);
    let order = bvh.take_order();
    (order.into_iter().map(|i| segments[i as usize]).collect(), bvh)
}

fn cut(strands: &Strands, strand: usize, set: u8, upright: &Mat3, segments: &mut Vec<Segment>) {
    let last = (strands.points_per_strand - 1) as f32;
    let radius_m = |s: f32| strands.root_radius_m[strand] * strands.profile.radius_factor(s);
    for (i, pair) in strands.points_of_m(strand).windows(2).enumerate() {
        let across = (*upright * (pair[1] - pair[0])).abs();
        // The second longest side: the longest is the segment's own way.
        let wide = across.x.max(across.y).min(across.x.min(across.y).max(across.z));
        let count = (wide / (WIDEST * strands.root_radius_m[strand])).ceil().clamp(1.0, MOST);
        for part in 0..count as usize {
            let [begin, end] = [part as f32 / count, (part + 1) as f32 / count];
            let span = [begin, end].map(|t| (i as f32 + t) / last);
            segments.push(Segment {
                cone: Cone {
                    from_m: pair[0].lerp(pair[1], begin),
                    to_m: pair[0].lerp(pair[1], end),
                    from_radius_m: radius_m(span[0]),
                    to_radius_m: radius_m(span[1]),
                },
                set,
                index: strand as u32,
                span,
            });
        }
    }
}

/// Box of a cone's image under a linear map; a sphere's image reaches as far as its radius times each row's length.
fn bounds_of(cone: &Cone, map: &Mat3) -> (Vec3, Vec3) {
    let rows = map.transpose();
    let reach = Vec3::new(rows.x_axis.length(), rows.y_axis.length(), rows.z_axis.length());
    let (from, to) = (*map * cone.from_m, *map * cone.to_m);
    (
        (from - reach * cone.from_radius_m).min(to - reach * cone.to_radius_m),
        (from + reach * cone.from_radius_m).max(to + reach * cone.to_radius_m),
    )
}
