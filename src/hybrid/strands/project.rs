//! Strands to ribbon points on the picture.

use super::RibbonPoint;
use crate::data::strands::Strands;
use crate::math::Vec3;
use crate::stage::projection::Projection;
use crate::volume::bins::Reach;

/// The ribbon points of one strand, drawn `widening` times as wide as it is, into `out`, one for each of its points.
pub fn ribbon_points(strands: &Strands, strand: usize, widening: f32, view: &Projection, out: &mut [RibbonPoint]) {
    let points = strands.points_of_m(strand);
    let last = points.len() - 1;
    for (i, (&point, out)) in points.iter().zip(out).enumerate() {
        let radius_m = widening * strands.root_radius_m[strand] * strands.profile.radius_factor(i as f32 / last as f32);
        let mut p = view.camera_from_world(point);
        if p.z <= view.near_m {
            // The end of a segment that reaches behind the near plane is drawn where it passes it.
            let before = |other: Vec3| (other.z > view.near_m).then_some(other);
            let neighbours = [i.saturating_sub(1), (i + 1).min(last)].map(|n| view.camera_from_world(points[n]));
            p = match neighbours.into_iter().find_map(before) {
                Some(other) => p.lerp(other, (view.near_m - p.z) / (other.z - p.z)).with_z(view.near_m),
                None => p,
            };
        }
        *out = ribbon_point(view, p, radius_m);
    }
}

fn ribbon_point(view: &Projection, camera_m: Vec3, radius_m: f32) -> RibbonPoint {
    if camera_m.z < view.near_m {
        return RibbonPoint { z_m: camera_m.z, ..RibbonPoint::default() };
    }
    let pixel = view.pixel(camera_m);
    RibbonPoint { x: pixel.x, y: pixel.y, z_m: camera_m.z, half_px: radius_m * view.focal_px / camera_m.z }
}

/// What the segments between the ribbon points of a strand may touch together.
pub fn whole_reach(view: &Projection, ribbon_points: &[RibbonPoint]) -> Reach {
    let mut all = Reach::NOTHING;
    if ribbon_points.iter().all(|k| k.z_m > view.near_m) {
        ribbon_points.iter().for_each(|k| all.add(k.x, k.y, k.half_px * std::f32::consts::SQRT_2));
        return all;
    }
    for pair in ribbon_points.windows(2) {
        let segment = reach(view, &pair[0], &pair[1]);
        all.from = [all.from[0].min(segment.from[0]), all.from[1].min(segment.from[1])];
        all.to = [all.to[0].max(segment.to[0]), all.to[1].max(segment.to[1])];
    }
    all
}

/// What the segment between two ribbon points may touch; nothing where both lie behind the near plane or on it.
pub fn reach(view: &Projection, a: &RibbonPoint, b: &RibbonPoint) -> Reach {
    let mut reach = Reach::NOTHING;
    if a.z_m.min(b.z_m) >= view.near_m && a.z_m.max(b.z_m) > view.near_m {
        for k in [a, b] {
            reach.add(k.x, k.y, k.half_px * std::f32::consts::SQRT_2);
        }
    }
    reach
}
