//! Planted faults: a comparison that does not catch one checks nothing.

use crate::laws::shading::furnace;
use furrier::shade::kajiya_kay::KajiyaKay;

#[test]
fn the_furnace_sees_a_highlight_without_its_normalisation() {
    let hair = KajiyaKay::<f64>::new(0.0, 0.5, 20.0);
    let sent = furnace(0.0, |angles| hair.scatter(angles).1 * 2.0 * std::f64::consts::PI);
    assert!((sent - 0.5).abs() > 0.1, "{sent}");
}
