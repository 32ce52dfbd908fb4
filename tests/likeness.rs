//! How a coat's picture is judged, on pictures whose difference is known.

use furrier::math::Vec3;
use furrier::math::hash::Stream;
use furrier::metrics::compare::LinearImage;
use furrier::metrics::likeness::bands::Bands;
use furrier::metrics::likeness::{BEHIND, EXPOSED, Judged, blocks, exposure, fringe, judge};
use std::f32::consts::PI;

/// A picture whose pixels are `light` where `alpha` says.
fn picture(size: [usize; 2], light: impl Fn(usize, usize) -> f32, alpha: impl Fn(usize, usize) -> f32) -> LinearImage {
    let [width, height] = size;
    let places: Vec<[usize; 2]> = (0..width * height).map(|i| [i % width, i / width]).collect();
    let alpha: Vec<f32> = places.iter().map(|&[x, y]| alpha(x, y)).collect();
    let tinted = Vec3::new(1.0, 0.8, 0.6);
    let colour = places.iter().zip(&alpha).map(|(&[x, y], a)| tinted * light(x, y) * *a).collect();
    LinearImage { width, height, colour, alpha }
}

/// A striped ball of radius 20 in the middle of 64 × 56 pixels; its border is a pixel wide.
pub fn ball(shift: usize) -> LinearImage {
    let away = |x: usize, y: usize| (x as f32 - 31.5 - shift as f32).hypot(y as f32 - 27.5);
    picture(
        [64, 56],
        |x, y| 0.5 + 0.3 * (1.3 * (x - shift.min(x)) as f32 + 0.4 * y as f32).sin(),
        |x, y| (20.5 - away(x, y)).clamp(0.0, 1.0),
    )
}

/// The ball with its light changed.
pub fn with(change: impl Fn(Vec3) -> Vec3) -> LinearImage {
    let mut changed = ball(0);
    changed.colour.iter_mut().for_each(|c| *c = change(*c));
    changed
}

/// A coat's picture against the ball.
pub fn judged(coat: &LinearImage) -> Judged {
    judge(&ball(0), coat, 8.0).unwrap()
}

#[test]
fn a_coat_against_itself_is_without_error() {
    let same = judged(&ball(0));
    let l = &same.likeness;
    assert_eq!([l.flip, l.flip_p95, l.relmse, l.relmse_8x8, l.bias, l.coverage], [0.0; 6]);
    assert_eq!(l.bias_rgb, [0.0; 3]);
    assert_eq!(l.fringe.map(|fringe| [fringe.flip, fringe.coverage]), Some([0.0; 2]));
    assert_eq!(l.bands.all(), [Some(1.0); 3]);
    assert!(same.flip.iter().all(|&flip| flip == 0.0));
}

#[test]
fn pictures_are_exposed_for_the_fur_and_stand_before_grey() {
    let shown = &judged(&ball(0)).shown[0];
    assert_eq!(shown.colour[0], Vec3::splat(BEHIND));
    let luma = Vec3::new(0.2126, 0.7152, 0.0722);
    let (light, alpha) =
        (ball(0).colour.iter().map(|c| f64::from(c.dot(luma))).sum::<f64>(), ball(0).alpha.iter().sum::<f32>());
    let mean = light / f64::from(alpha) * f64::from(exposure(&ball(0)).unwrap());
    assert!((mean - EXPOSED).abs() < 1e-6, "{mean}");
    // However bright the light was, both pictures are judged alike.
    let [render, coat] = [1.0, 1.1].map(|factor| with(|c| c * 40.0 * factor));
    let bright = judge(&render, &coat, 8.0).unwrap().likeness;
    let dim = judged(&with(|c| c * 1.1)).likeness;
    assert!((bright.flip - dim.flip).abs() < 1e-3 && (bright.relmse - dim.relmse).abs() < 1e-6);
    assert_eq!(exposure(&with(|_| Vec3::ZERO)).unwrap_err().kind, furrier::error::Kind::Usage);
}

#[test]
fn the_fringe_is_a_band_as_wide_as_asked_around_the_outline() {
    for width_px in [2.0_f32, 6.0, 12.0] {
        let band = fringe::band(&ball(0), width_px);
        let away = |&i: &usize| ((i % 64) as f32 - 31.5).hypot((i / 64) as f32 - 27.5) - 20.0;
        let furthest = band.iter().map(away).map(f32::abs).fold(0.0, f32::max);
        let area = 2.0 * PI * 20.0 * width_px;
        assert!(furthest <= 0.5 * width_px + 1.0, "{width_px}: {furthest}");
        assert!((band.len() as f32 / area - 1.0).abs() < 0.15 + 0.3 / width_px, "{width_px}: {} of {area}", band.len());
    }
    // Neither a full nor an empty picture has an outline.
    for alpha in [0.0, 1.0] {
        assert!(fringe::band(&picture([16, 16], |_, _| 0.5, |_, _| alpha), 4.0).is_empty());
    }
    assert!(
        judge(&picture([16, 16], |_, _| 0.5, |_, _| 1.0), &picture([16, 16], |_, _| 0.5, |_, _| 1.0), 4.0)
            .unwrap()
            .likeness
            .fringe
            .is_none()
    );
}

#[test]
fn bands_tell_details_by_their_size() {
    let full = |light: &dyn Fn(usize, usize) -> f32| picture([96, 96], light, |_, _| 1.0);
    let stripes = |period: f32, height: f32| full(&|x, _| 0.5 + height * (2.0 * PI * x as f32 / period).sin());
    // Twice as high is four times the variance, whatever the size.
    for ratio in Bands::new(&stripes(5.0, 0.1), &stripes(5.0, 0.2)).all() {
        assert!((ratio.unwrap() - 4.0).abs() < 0.01, "{ratio:?}");
    }
    // Beside coarse stripes, fine ones add to the fine band most.
    let both = full(&|x, _| {
        let wave = |period: f32| (2.0 * PI * x as f32 / period).sin();
        0.5 + 0.1 * wave(16.0) + 0.1 * wave(3.0)
    });
    let [fine, middle, coarse] = Bands::new(&stripes(16.0, 0.1), &both).all().map(Option::unwrap);
    assert!(fine > 100.0 && fine > 5.0 * middle && middle > coarse && coarse < 2.0, "{fine} {middle} {coarse}");
    // Noise has most in the finest band; the mean over 2 × 2 takes that away first.
    let mut stream = Stream::new(3);
    let noise: Vec<f32> = (0..96 * 96).map(|_| 0.5 + 0.2 * (stream.unit() - 0.5)).collect();
    let at = |x: usize, y: usize| noise[(y % 96) * 96 + x % 96];
    let blurred = full(&|x, y| 0.25 * (at(x, y) + at(x + 1, y) + at(x, y + 1) + at(x + 1, y + 1)));
    let [fine, middle, coarse] = Bands::new(&full(&at), &blurred).all().map(Option::unwrap);
    assert!(fine < 0.3 && fine < middle && middle < coarse && coarse > 0.7, "{fine} {middle} {coarse}");
    // What is not covered does not count, and what has no detail has no ratio.
    assert_eq!(Bands::new(&full(&|_, _| 0.5), &stripes(5.0, 0.1)).all(), [None; 3]);
    assert_eq!(Bands::new(&picture([96, 96], |x, _| x as f32, |_, _| 0.5), &full(&|_, _| 0.5)).all(), [None; 3]);
}

#[test]
fn grain_averages_out_in_blocks_and_bias_does_not() {
    let flat = picture([64, 64], |_, _| 0.5, |_, _| 1.0);
    let mut stream = Stream::new(9);
    let noise: Vec<f32> = (0..64 * 64).map(|_| stream.unit() - 0.5).collect();
    let grainy = picture([64, 64], |x, y| 0.5 + 0.4 * noise[y * 64 + x], |_, _| 1.0);
    let of_pixels = judge(&flat, &grainy, 4.0).unwrap().likeness;
    let ratio = of_pixels.relmse / of_pixels.relmse_8x8;
    assert!((32.0..128.0).contains(&ratio), "{ratio}");
    let brighter = judge(&flat, &picture([64, 64], |_, _| 0.6, |_, _| 1.0), 4.0).unwrap().likeness;
    assert!((brighter.relmse / brighter.relmse_8x8 - 1.0).abs() < 1e-4);
    // Blocks at the border may be smaller.
    let odd = |light: f32| picture([9, 13], move |_, _| light, |_, _| 1.0);
    let expected = judge(&odd(0.5), &odd(0.6), 4.0).unwrap();
    assert!((blocks::rel_mse(&expected.shown[0], &expected.shown[1]) - expected.likeness.relmse).abs() < 1e-6);
}
