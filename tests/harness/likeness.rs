//! Faults planted in a coat's picture are seen by the measure that they concern.

use crate::likeness::{ball, judged, with};
use furrier::math::Vec3;
use furrier::metrics::likeness::fringe;

#[test]
fn planted_faults_are_seen_by_what_they_concern() {
    let brighter = judged(&with(|c| c * 1.1)).likeness;
    assert!((brighter.bias - 0.1).abs() < 1e-5 && brighter.flip > 0.01 && brighter.coverage == 0.0, "{brighter:?}");
    let redder = judged(&with(|c| c * Vec3::new(1.2, 1.0, 0.9))).likeness.bias_rgb;
    let errors = [0.2, 0.0, -0.1].map(|expected: f64| expected).into_iter().zip(redder).map(|(e, b)| (e - b).abs());
    assert!(errors.fold(0.0, f64::max) < 1e-5, "{redder:?}");
    let shifted = judged(&ball(3)).likeness;
    let edge = shifted.fringe.unwrap();
    assert!(shifted.flip > 0.1 && edge.flip > 0.1 && shifted.relmse > 0.05 && shifted.bias.abs() < 0.05, "{shifted:?}");
    // Hair that is missing at the border and nowhere else: light goes with it, so that what is left is as bright.
    let mut bare = ball(0);
    for i in fringe::band(&ball(0), 8.0) {
        bare.alpha[i] *= 0.5;
        bare.colour[i] *= 0.5;
    }
    let bare = judged(&bare).likeness;
    let edge = bare.fringe.unwrap();
    assert!(edge.coverage < -20.0 && bare.coverage > edge.coverage && bare.coverage < -5.0, "{bare:?}");
    assert!(edge.flip > bare.flip && bare.bias.abs() < 0.05, "{bare:?}");
}
