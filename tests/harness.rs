//! Planted faults: a comparison that does not catch one checks nothing.

use crate::laws::shading::furnace;
use furrier::shade::kajiya_kay::KajiyaKay;

#[test]
fn the_furnace_sees_a_highlight_without_its_normalisation() {
    let hair = KajiyaKay::<f64>::new(0.0, 0.5, 20.0);
    let sent = furnace(0.0, |angles| hair.scatter(angles).1 * 2.0 * std::f64::consts::PI);
    assert!((sent - 0.5).abs() > 0.1, "{sent}");
}

#[test]
fn areas_tell_a_ribbon_from_one_a_tenth_wider() {
    use furrier::render::strands::Knot;
    let knot = |x: f32, half_px: f32| Knot { x, y: 3.0 * x, z_m: 1.0, half_px };
    let wider = crate::ribbons::covered(&knot(0.2, 0.055), &knot(6.2, 0.055));
    let area = 2.0 * 0.05 * 6.0_f64.hypot(18.0);
    assert!((wider - area).abs() > 2e-3 * area + 1e-5);
}

#[test]
fn blocks_tell_hair_moved_by_a_pixel() {
    let (mut ribbons, rays) = crate::ribbons::ribbons_and_rays();
    ribbons.guard.rotate_right(2);
    assert!(crate::ribbons::worst_block(&ribbons, &rays) > 0.03);
}
