//! Which prisms hold a point.

use super::Shell;
use super::prism::ShellPoint;
use crate::math::Vec3;
use rayon::prelude::*;

/// The prisms that hold a point, and where in them it lies.
pub fn around(shell: &Shell<'_>, point_m: Vec3) -> Vec<(u32, ShellPoint)> {
    let triangles = (0..shell.skin.triangles.len() as u32).into_par_iter();
    triangles.filter_map(|triangle| Some((triangle, within(shell, triangle, point_m)?))).collect()
}

/// Where in the prism over a triangle a point lies; none where it lies outside.
pub fn within(shell: &Shell<'_>, triangle: u32, point_m: Vec3) -> Option<ShellPoint> {
    let prism = shell.prism(triangle);
    let (low, high) = prism.bounds_m();
    if point_m.cmplt(low).any() || point_m.cmpgt(high).any() {
        return None;
    }
    let point = prism.locate(point_m, ShellPoint { b: [1.0 / 3.0; 2], t: 0.5 })?;
    let inside = point.barycentric().min_element() >= 0.0 && (0.0..=1.0).contains(&point.t);
    inside.then_some(point)
}
