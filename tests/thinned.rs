//! Fewer, wider hairs stand for many thin ones.

use crate::scenes::{self, Grown};
use furrier::data::film::Film;
use furrier::hybrid::strands::thin::Thinning;
use furrier::hybrid::{Settings, draw};
use furrier::math::Vec3;
use furrier::metrics::compare::{LinearImage, compare};

const SIZE: [usize; 2] = [64, 64];

fn dense() -> Grown {
    let (mut guard, mut undercoat) = scenes::mink();
    guard.density_per_cm2 = 200.0;
    undercoat.density_per_cm2 = 4000.0;
    Grown::new(scenes::bent_skin(1), &guard, &undercoat, Vec3::X, 35.0, 3)
}

fn film(grown: &Grown, settings: &Settings) -> Film {
    draw(&grown.scene(), &scenes::studio(), &scenes::camera(0.35), settings).unwrap().film
}

/// All hairs, and a third of them, of which each is drawn `error` times as wide as it should be.
pub fn whole_and_thinned(error: f32) -> (Film, Film) {
    let mut grown = dense();
    let settings = Settings { size: SIZE, ..Settings::default() };
    let whole = film(&grown, &settings);
    let view = scenes::view(&scenes::camera(0.35), SIZE);
    let mut left = Thinning::new(&view, 0.5).of(&grown.guard).unwrap();
    assert!(left.len() * 2 < grown.guard.len(), "{} of {} hairs are left", left.len(), grown.guard.len());
    left.root_radius_m.iter_mut().for_each(|r| *r *= error);
    grown.guard = left;
    (whole, film(&grown, &settings))
}

/// How much more of the picture guard hair covers in the second film, over the first.
pub fn more_guard(whole: &Film, thinned: &Film) -> f32 {
    let guard = |film: &Film| film.guard.iter().sum::<f32>();
    guard(thinned) / guard(whole) - 1.0
}

#[test]
fn fewer_hairs_cover_as_much_and_are_as_bright() {
    let (whole, thinned) = whole_and_thinned(1.0);
    let more = more_guard(&whole, &thinned);
    assert!(more.abs() < 0.02, "guard hair covers {more} more");
    let difference = compare(&LinearImage::from(&whole), &LinearImage::from(&thinned)).unwrap();
    println!("{more} {difference:?}");
    assert!(difference.bias.abs() < 0.02 && difference.flip < 0.08, "{difference:?}");
    assert!((thinned.coverage() - whole.coverage()).abs() < 0.005);
}

#[test]
fn a_picture_draws_the_hairs_that_are_left() {
    let mut grown = dense();
    let settings = Settings { size: SIZE, hair_px: 0.5, ..Settings::default() };
    let at_once = film(&grown, &settings);
    grown.guard = Thinning::new(&scenes::view(&scenes::camera(0.35), SIZE), 0.5).of(&grown.guard).unwrap();
    assert_eq!(at_once, film(&grown, &Settings { hair_px: 0.0, ..settings }));
}

#[test]
fn hairs_come_and_go_slowly_and_keep_their_whole_width() {
    let grown = dense();
    let mut before: Option<Vec<f32>> = None;
    for step in 0..60 {
        let camera = scenes::camera(0.2 * 1.01_f32.powi(step * 4));
        let thinning = Thinning::new(&scenes::view(&camera, SIZE), 0.5);
        let widths: Vec<f32> = (0..grown.guard.len()).map(|i| thinning.widening(&grown.guard, i)).collect();
        let mean = widths.iter().sum::<f32>() / widths.len() as f32;
        assert!((mean - 1.0).abs() < 0.01, "hairs are {mean} as wide in the mean");
        if let Some(before) = before {
            let widest = before.iter().copied().fold(0.0, f32::max);
            for (a, b) in before.iter().zip(&widths) {
                // An eye 4 % farther away leaves 4 % fewer hairs; an eighth of them is fading.
                assert!((a - b).abs() < 0.5 * widest, "{a} became {b}, where the widest was {widest}");
                assert!(*a > 0.0 || *b == 0.0, "a hair came back as the eye went away");
            }
        }
        before = Some(widths);
    }
}

#[test]
fn hair_as_wide_as_pixels_show_is_drawn_as_it_is() {
    let grown = dense();
    let thinning = Thinning::new(&scenes::view(&scenes::camera(0.35), SIZE), 1e-4);
    assert!((0..grown.guard.len()).all(|i| thinning.widening(&grown.guard, i) == 1.0));
    assert!(Thinning::new(&scenes::view(&scenes::camera(0.35), SIZE), 0.0).of(&grown.guard).is_none());
}
