//! Depth of field: the thin lens' law, and no leaks where near meets far.

use crate::scenes;
use furrier::data::film::Film;
use furrier::math::Vec3;
use furrier::stage::defocus::{Lens, defocus, middle_depth_m};
use furrier::stage::projection::Projection;

pub const SIZE: [usize; 2] = [121, 81];

fn view() -> Projection {
    scenes::view(&scenes::looking(Vec3::Z, Vec3::ZERO, Vec3::Y, 30.0), SIZE)
}

/// A film of opaque things: `what` gives colour and depth along the optical axis of a pixel.
pub fn film(what: impl Fn(usize, usize) -> Option<(Vec3, f32)>) -> Film {
    let mut film = Film::new(SIZE[0], SIZE[1]);
    let view = view();
    for i in 0..film.alpha.len() {
        let (x, y) = (i % SIZE[0], i / SIZE[0]);
        if let Some((colour, z_m)) = what(x, y) {
            let through = furrier::math::Vec2::new(x as f32 + 0.5, y as f32 + 0.5);
            (film.radiance[i], film.alpha[i]) = (colour, 1.0);
            film.depth_m[i] = z_m * view.direction(through).length();
        }
    }
    film
}

/// Greatest departure from a colour and from alpha 1 over some pixels.
pub fn departure(film: &Film, colour: Vec3, counts: impl Fn(usize, usize) -> bool) -> f32 {
    let all = (0..film.alpha.len()).filter(|i| counts(i % SIZE[0], i / SIZE[0]));
    all.map(|i| (film.radiance[i] - colour).abs().max_element().max((film.alpha[i] - 1.0).abs())).fold(0.0, f32::max)
}

#[test]
fn circles_follow_the_thin_lens() {
    let (vfov, focus_m) = (30.0_f64.to_radians(), 0.8_f64);
    // A real lens: focal length such that the sensor, at the sharp image's distance, sees the field of view.
    for f_number in [0.35, 1.4, 4.0] {
        let lens = Lens::of_f_number(f_number, vfov as f32, focus_m as f32);
        let aperture = f64::from(lens.aperture_m);
        let focal = 0.05;
        let image = |z: f64| 1.0 / (1.0 / focal - 1.0 / z);
        let focal_px = f64::from(view().focal_px);
        for z_m in [0.5, 0.7, 1.2, 3.0, 1000.0] {
            let (sharp, at) = (image(focus_m), image(z_m));
            let diameter_px = aperture * (sharp - at).abs() / at * focal_px / sharp;
            let point = film(|x, y| (x == 60 && y == 40).then_some((Vec3::ONE, z_m as f32)));
            let blurred = defocus(&point, &view(), &lens);
            let (mut light, mut spread) = (0.0, 0.0);
            for (i, &alpha) in blurred.alpha.iter().enumerate() {
                light += f64::from(alpha);
                spread += f64::from(alpha) * (i as f64 % SIZE[0] as f64 - 60.0).floor().powi(2);
            }
            // A disc's variance along an axis is r²/4, the pixel's own 1/12.
            let found = 4.0 * (spread / light - 1.0 / 12.0).max(0.0).sqrt();
            println!("f/{f_number} at {z_m} m: {found:.3} px, the lens gives {diameter_px:.3}");
            assert!((light - 1.0).abs() < 1e-3, "light {light}");
            // A circle smaller than a pixel stays in it.
            if diameter_px > 1.5 {
                assert!((found - diameter_px).abs() < 0.02 * diameter_px + 0.3);
            } else {
                assert!(found < 1.5);
            }
        }
        let far = 2.0 * lens.radius_px(focal_px as f32, f32::INFINITY);
        assert!((f64::from(far) - aperture * focal_px / focus_m).abs() < 1e-3);
    }
}

#[test]
fn what_is_whole_stays_whole() {
    let lens = Lens { aperture_m: 0.04, focus_m: 0.9 };
    let grey = Vec3::splat(0.5);
    // A plane on a slant, from well before the sharp depth to well behind it.
    let slant = film(|x, _| Some((grey, 0.6 + 0.01 * x as f32)));
    assert!(departure(&defocus(&slant, &view(), &lens), grey, |_, _| true) < 2e-3);
    // A bar before a wall, both blurred: behind the bar nothing is known, yet nothing shines or darkens through.
    let bar = |x: usize| (50..70).contains(&x);
    for (near, far) in [(0.6, 2.0), (0.6, 0.9), (0.9, 2.0)] {
        let both = film(|x, _| Some((grey, if bar(x) { near } else { far })));
        let worst = departure(&defocus(&both, &view(), &lens), grey, |_, _| true);
        assert!(worst < 5e-3, "{near} m before {far} m: {worst}");
    }
}

#[test]
fn what_is_sharp_takes_nothing_from_behind_it() {
    let lens = Lens { aperture_m: 0.05, focus_m: 0.6 };
    let bar = |x: usize| (50..70).contains(&x);
    let dark = Vec3::splat(0.05);
    let before_light = film(|x, _| Some(if bar(x) { (dark, 0.6) } else { (Vec3::splat(8.0), 2.0) }));
    let blurred = defocus(&before_light, &view(), &lens);
    assert!(departure(&blurred, dark, |x, _| bar(x)) < 1e-3);
    assert!(departure(&blurred, Vec3::splat(8.0), |x, _| !bar(x)) < 0.05);
    // And what is blurred in front covers what is sharp behind by half along its outline.
    let lens = Lens { focus_m: 2.0, ..lens };
    let blurred = defocus(&before_light, &view(), &lens);
    let edge: Vec<f32> = [49, 50].map(|x| blurred.radiance[40 * SIZE[0] + x].x).to_vec();
    let half = 0.5 * (edge[0] + edge[1]);
    assert!((half - 4.0).abs() < 0.5, "{edge:?}");
}

#[test]
fn a_pinhole_changes_nothing_and_bare_pixels_stay_bare() {
    let ball = film(|x, y| ((x as i32 - 60).pow(2) + (y as i32 - 40).pow(2) < 400).then_some((Vec3::ONE, 1.0)));
    assert_eq!(defocus(&ball, &view(), &Lens { aperture_m: 0.0, focus_m: 0.5 }), ball);
    let blurred = defocus(&ball, &view(), &Lens { aperture_m: 0.01, focus_m: 0.5 });
    let light = |film: &Film| film.alpha.iter().sum::<f32>();
    assert!((light(&blurred) / light(&ball) - 1.0).abs() < 1e-3);
    assert!(blurred.alpha[0] == 0.0 && blurred.depth_m == ball.depth_m);
    assert_eq!(middle_depth_m(&ball, &view()), Some(1.0));
    assert_eq!(middle_depth_m(&film(|_, _| None), &view()), None);
}
