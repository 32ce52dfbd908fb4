//! Strands to knots on the picture.

use super::Knot;
use crate::data::strands::Strands;
use crate::math::Vec3;
use crate::stage::projection::View;
use crate::volume::bins::Reach;

/// The knots of one strand, drawn `widening` times as wide as it is, into `out`, one for each of its points.
pub fn knots(strands: &Strands, strand: usize, widening: f32, view: &View, out: &mut [Knot]) {
    let points = strands.points_of_m(strand);
    let last = points.len() - 1;
    for (i, (&point, out)) in points.iter().zip(out).enumerate() {
        let radius_m = widening * strands.root_radius_m[strand] * strands.profile.radius_factor(i as f32 / last as f32);
        let mut p = view.camera_from_world(point);
        if p.z <= view.near_m {
            // The end of a piece that reaches behind the near plane is drawn where it passes it.
            let before = |other: Vec3| (other.z > view.near_m).then_some(other);
            let neighbours = [i.saturating_sub(1), (i + 1).min(last)].map(|n| view.camera_from_world(points[n]));
            p = match neighbours.into_iter().find_map(before) {
                Some(other) => p.lerp(other, (view.near_m - p.z) / (other.z - p.z)).with_z(view.near_m),
                None => p,
            };
        }
        *out = knot(view, p, radius_m);
    }
}

fn knot(view: &View, camera_m: Vec3, radius_m: f32) -> Knot {
    if camera_m.z < view.near_m {
        return Knot { z_m: camera_m.z, ..Knot::default() };
    }
    let pixel = view.pixel(camera_m);
    Knot { x: pixel.x, y: pixel.y, z_m: camera_m.z, half_px: radius_m * view.focal_px / camera_m.z }
}

/// What the pieces between the knots of a strand may touch together.
pub fn whole_reach(view: &View, knots: &[Knot]) -> Reach {
    let mut all = Reach::NOTHING;
    if knots.iter().all(|k| k.z_m > view.near_m) {
        knots.iter().for_each(|k| all.add(k.x, k.y, k.half_px * std::f32::consts::SQRT_2));
        return all;
    }
    for pair in knots.windows(2) {
        let piece = reach(view, &pair[0], &pair[1]);
        all.from = [all.from[0].min(piece.from[0]), all.from[1].min(piece.from[1])];
        all.to = [all.to[0].max(piece.to[0]), all.to[1].max(piece.to[1])];
    }
    all
}

/// What the piece between two knots may touch; nothing where both lie behind the near plane or on it.
pub fn reach(view: &View, a: &Knot, b: &Knot) -> Reach {
    let mut reach = Reach::NOTHING;
    if a.z_m.min(b.z_m) >= view.near_m && a.z_m.max(b.z_m) > view.near_m {
        for k in [a, b] {
            reach.add(k.x, k.y, k.half_px * std::f32::consts::SQRT_2);
        }
    }
    reach
}
