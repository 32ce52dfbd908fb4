//! Hair that grew on the skin, laid into a chart: lean and length removed, as a coat's offsets will put them back.

use super::chart_region::ChartRegion;
use crate::coat::primitive::offset_over_height;
use crate::data::fields::Fields;
use crate::data::mesh::Mesh;
use crate::data::strands::Strands;
use crate::math::{Mat3, Vec2, Vec3};
use std::ops::Range;

/// Share of the product of its columns' lengths below which a frame's volume is rounding.
const FLAT: f32 = 1e-4;

/// The hairs of each triangle: growth sets them down triangle by triangle.
pub fn by_triangle(strands: &Strands, triangles: usize) -> Vec<Range<usize>> {
    let mut ranges = vec![0..0; triangles];
    let mut start = 0;
    for hairs in strands.roots.chunk_by(|a, b| a.triangle == b.triangle) {
        ranges[hairs[0].triangle as usize] = start..start + hairs.len();
        start += hairs.len();
    }
    ranges
}

/// The hair that belongs to a region: every point p of a hair rooted at r is where M⁻¹ (p − r) is from its root in the chart, M being
/// the frame that a runtime will use there (`docs/steps/shells.md`, "Applied to a skin"). x and y in m from the region's first texel.
pub fn flatten(
    strands: &Strands,
    ranges: &[Range<usize>],
    (mesh, fields): (&Mesh, &Fields),
    region: &ChartRegion,
    texel_m: f32,
) -> Strands {
    let mut flat = strands.none_alike();
    for (index, placed) in region.placed.iter().enumerate() {
        let corners_m = mesh.corners_m(placed.triangle);
        let offsets = mesh.triangles[placed.triangle].map(|v| offset_over_height(fields, v as usize));
        let Some(axes) = axes(corners_m, placed.corners.map(|p| p * texel_m)) else { continue };
        for hair in ranges[placed.triangle].clone() {
            let [b0, b1] = strands.roots[hair].barycentric;
            let b = [b0, b1, 1.0 - b0 - b1];
            let root: Vec2 = (0..3).map(|i| placed.corners[i] * b[i]).sum();
            // A place around the chart that another triangle has already grows that one's hair.
            if index >= region.own && region.at(root) != Some(index) {
                continue;
            }
            let rise: Vec3 = (0..3).map(|i| offsets[i] * b[i]).sum();
            let frame = Mat3::from_cols(axes[0], axes[1], rise);
            let bulk = axes[0].length() * axes[1].length() * rise.length();
            if frame.determinant() <= FLAT * bulk {
                continue;
            }
            let chart_from_world = frame.inverse();
            let root_m = strands.points_of_m(hair)[0];
            let at_m = (root * texel_m).extend(0.0);
            let moved = |&p: &Vec3| at_m + chart_from_world * (p - root_m);
            flat.push_alike(strands, hair, strands.points_of_m(hair).iter().map(moved), 1.0);
        }
    }
    flat
}

/// What a metre along the chart's x and y is on a triangle; `None` where the chart shows it without area.
pub fn axes(corners_m: [Vec3; 3], chart_m: [Vec2; 3]) -> Option<[Vec3; 2]> {
    let (e1, e2) = (corners_m[1] - corners_m[0], corners_m[2] - corners_m[0]);
    let (d1, d2) = (chart_m[1] - chart_m[0], chart_m[2] - chart_m[0]);
    let area = d1.perp_dot(d2);
    let axes = [(e1 * d2.y - e2 * d1.y) / area, (e2 * d1.x - e1 * d2.x) / area];
    (area > 0.0 && axes.iter().all(|axis| axis.is_finite())).then_some(axes)
}
