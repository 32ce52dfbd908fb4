//! Strands to knots on the picture.

use super::Knot;
use crate::data::strands::Strands;
use crate::math::Vec3;
use crate::render::bins::Reach;
use crate::render::view::View;

/// Appends the knots of one strand.
pub fn knots(strands: &Strands, strand: usize, view: &View, out: &mut Vec<Knot>) {
    let points = strands.points_of_m(strand);
    let last = (points.len() - 1) as f32;
    for (i, &point) in points.iter().enumerate() {
        let radius_m = strands.root_radius_m[strand] * strands.profile.radius_factor(i as f32 / last);
        out.push(knot(view, point, radius_m));
    }
}

fn knot(view: &View, point_m: Vec3, radius_m: f32) -> Knot {
    let p = view.camera_from_world(point_m);
    if p.z <= view.near_m {
        return Knot { z_m: p.z, ..Knot::default() };
    }
    let pixel = view.pixel(p);
    Knot { x: pixel.x, y: pixel.y, z_m: p.z, half_px: radius_m * view.focal_px / p.z }
}

/// What the piece between two knots may touch. Pieces that reach behind the near plane are left out: they are closer to
/// the eye than a ten thousandth of the picture's distance.
pub fn reach(view: &View, a: &Knot, b: &Knot) -> Reach {
    let mut reach = Reach::NOTHING;
    if a.z_m > view.near_m && b.z_m > view.near_m {
        for k in [a, b] {
            reach.add(k.x, k.y, k.half_px * std::f32::consts::SQRT_2);
        }
    }
    reach
}
