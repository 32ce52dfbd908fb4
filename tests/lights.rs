//! Point and spot lights: what arrives, what the renderers make of it, and what is refused.

use crate::coats;
use crate::oracle::{self, thin};
use crate::scenes::{self, Grown};
use furrier::data::film::Film;
use furrier::data::light::{Directional, InWorld, Light, Point, Spot};
use furrier::fur::groom::{Guard, Undercoat};
use furrier::gpu::{Choice, Gpu};
use furrier::hybrid::{Settings, draw};
use furrier::math::{DVec3, Vec3};
use furrier::runtime::gpu::Renderer;
use furrier::runtime::{Frame, Show};
use furrier::stage::background::Background;
use furrier::stage::tone::{Development, develop};
use furrier::volume::scene::{Lighting, Scene};

/// The studio's key at `diagonals` of the skin from the middle of its bounds, as bright there as it is from infinitely far away.
pub fn lamp(grown: &Grown, diagonals: f32) -> Lighting {
    let far = scenes::studio();
    let Light::Directional(Directional { to_light, irradiance }) = far.key else { unreachable!("it is far away") };
    let (low_m, high_m) = grown.mesh.bounds_m();
    let distance_m = diagonals * grown.mesh.diagonal_m();
    let position_m = 0.5 * (low_m + high_m) + to_light * distance_m;
    let key = Point::new(position_m, irradiance * (distance_m * distance_m), None).unwrap();
    Lighting { key: key.into(), ..far }
}

/// Largest difference between two pictures in eight bits.
fn largest_step(a: &Film, b: &Film) -> u8 {
    let coded = |film: &Film| {
        develop(film, &Development { background: Background::Colour(Vec3::splat(0.2)), ..Development::default() })
            .pixels
    };
    coded(a).iter().zip(coded(b)).map(|(a, b)| a.abs_diff(b)).max().unwrap()
}

#[test]
fn a_lamp_far_away_is_a_directional_light() {
    let (grown, camera) = (thin(), scenes::camera(0.35));
    let settings = Settings { size: [64, 64], ..Settings::default() };
    let of = |lighting: &Lighting| draw(&grown.scene(), lighting, &camera, &settings).unwrap().film;
    let mut far = scenes::studio();
    let mut near = lamp(&grown, 1000.0);
    (far.fill, near.fill) = (vec![far.key], vec![near.key]);
    (far.fill_on_undercoat, near.fill_on_undercoat) = (true, true);
    let step = largest_step(&of(&far), &of(&near));
    assert!(step <= 1, "{step} of 255");
    // The comparison tells a lamp nearby.
    assert!(largest_step(&of(&far), &of(&lamp(&grown, 2.0))) > 10);
}

/// Bare skin, a square of 0.4 m around the origin, seen from above.
fn bare(lighting: &Lighting) -> Film {
    let (guard, undercoat) = (Guard::default(), Undercoat::default());
    let mesh = scenes::grid(8, 8, |u, v| Vec3::new(u - 0.5, 0.0, 0.5 - v) * 0.4);
    let grown = Grown::new(mesh, &Guard { density_per_cm2: 0.0, ..guard }, &undercoat, Vec3::X, 0.0, 1);
    let scene = Scene { guard: None, undercoat: None, ..grown.scene() };
    let camera = scenes::looking(Vec3::new(0.0, 1.0, 0.0), Vec3::ZERO, Vec3::NEG_Z, 16.0);
    draw(&scene, lighting, &camera, &Settings { size: [65, 65], ..Settings::default() }).unwrap().film
}

fn only(key: impl Into<Light>) -> Lighting {
    Lighting { key: key.into(), fill: Vec::new(), ambient: Vec3::ZERO, fill_on_undercoat: false }
}

fn above(height_m: f32) -> Point {
    Point::new(Vec3::new(0.0, height_m, 0.0), Vec3::splat(0.1), None).unwrap()
}

/// Where the middle of a pixel of [`bare`] lies from the origin, m.
fn from_middle_m(i: usize) -> f32 {
    let px = [i % 65, i / 65].map(|p| p as f32 - 32.0);
    px[0].hypot(px[1]) / 32.5 * 8_f32.to_radians().tan()
}

#[test]
fn bare_skin_is_lit_by_the_inverse_square_and_the_cosine() {
    let (unit, film) = (bare(&only(above(1.0))), bare(&only(above(0.1))));
    let full = unit.radiance[32 * 65 + 32].x;
    assert!(full > 0.0);
    for i in 0..65 * 65 {
        // I cos θ / d² = I h / (h² + r²)^1.5
        let of = |h: f32| h * (h * h + from_middle_m(i).powi(2)).powf(-1.5);
        for (found, expected) in [(unit.radiance[i].x, full * of(1.0)), (film.radiance[i].x, full * of(0.1))] {
            assert!((found / expected - 1.0).abs() < 2e-3, "pixel {i}: {found}, not {expected}");
        }
    }
}

#[test]
fn a_lamp_ends_at_its_range() {
    let film = bare(&only(Point { range_m: Some(0.12), ..above(0.1) }));
    let endless = bare(&only(above(0.1)));
    for i in 0..65 * 65 {
        let square_m2 = 0.1 * 0.1 + from_middle_m(i).powi(2);
        let window = (1.0 - (square_m2 / (0.12 * 0.12)).powi(2)).max(0.0);
        let found = film.radiance[i].x / endless.radiance[i].x;
        assert!((found - window).abs() < 2e-3, "pixel {i}: {found}, not {window}");
    }
}

#[test]
fn a_cone_has_its_edges_where_it_says() {
    let (inner, outer) = (0.4_f32, 0.8_f32);
    let film = bare(&only(Spot::new(above(0.1), Vec3::NEG_Y * 3.0, inner, outer).unwrap()));
    let all = bare(&only(above(0.1)));
    let mut count = [0; 3];
    for i in 0..65 * 65 {
        let angle = (from_middle_m(i) / 0.1).atan();
        let found = film.radiance[i].x / all.radiance[i].x;
        let share = ((angle.cos() - outer.cos()) / (inner.cos() - outer.cos())).clamp(0.0, 1.0);
        assert!((found - share * share).abs() < 2e-3, "at {angle} rad: {found}, not {}", share * share);
        count[usize::from(angle > inner) + usize::from(angle > outer)] += 1;
    }
    assert!(count.iter().all(|&count| count > 100), "{count:?}");
    // A beam so narrow that its edges' cosines hardly differ is as bright within.
    let beam = Light::from(Spot::new(above(1.0), Vec3::NEG_Y, 0.01, 0.02).unwrap());
    assert_eq!(beam.at(Vec3::ZERO).irradiance, Vec3::splat(0.1));
    assert_eq!(beam.at(Vec3::X * 0.03).irradiance, Vec3::ZERO);
}

#[test]
fn lights_and_lanes_agree() {
    use furrier::math::hash::Stream;
    use furrier::math::lanes::{Scalar, Vec3s};
    let mut random = Stream::new(3);
    let mut vector = || Vec3::new(random.unit(), random.unit(), random.unit()) * 2.0 - 1.0;
    for _ in 0..500 {
        let point = Point::new(vector(), Vec3::new(1.0, 2.0, 3.0), Some(1.5)).unwrap();
        let spot = Spot::new(point, vector(), 0.3, 1.2).unwrap();
        for light in [Light::from(point), spot.into(), Directional::travelling(vector(), Vec3::ONE).unwrap().into()] {
            let p = vector();
            let expected = light.at(p);
            let (to_light, irradiance) = light.at_lanes::<Scalar>(Vec3s::splat(p));
            assert!((to_light.rows().lane(0) - expected.to_light).length() < 1e-6);
            let off = (irradiance.rows().lane(0) - expected.irradiance).length();
            assert!(off <= 1e-5 * (1.0 + expected.irradiance.length()), "{light:?} at {p}");
        }
    }
}

#[test]
fn places_in_large_worlds_keep_their_millimetres() {
    let place_m = DVec3::new(1e6, 2e6, -3e6) + DVec3::splat(0.001);
    let light = Light::from(Point::new(Vec3::X, Vec3::ONE, None).unwrap());
    let near = InWorld { place_m, light }.relative_to(DVec3::new(1e6, 2e6, -3e6)).unwrap();
    assert!((near.position_m().unwrap() - Vec3::new(1.001, 0.001, 0.001)).length() < 1e-6);
    assert!(InWorld { place_m: DVec3::splat(1e300), light }.relative_to(DVec3::ZERO).is_err());
    assert!(InWorld { place_m: DVec3::NAN, light }.relative_to(DVec3::ZERO).is_err());
}

#[test]
fn lights_that_cannot_be_are_refused_by_name() {
    let point = |at, intensity, range| Point::new(at, intensity, range).map(|_| ());
    let spot = |direction, inner, outer| Spot::new(above(1.0), direction, inner, outer).map(|_| ());
    let directional = |direction, irradiance| Directional::travelling(direction, irradiance).map(|_| ());
    let (zero, one, nan, down) = (Vec3::ZERO, Vec3::ONE, Vec3::NAN, Vec3::NEG_Y);
    for (field, result) in [
        ("position", point(nan, one, None)),
        ("position", point(Vec3::INFINITY, one, None)),
        ("intensity", point(zero, nan, None)),
        ("intensity", point(zero, -one, None)),
        ("range", point(zero, one, Some(0.0))),
        ("range", point(zero, one, Some(-1.0))),
        ("range", point(zero, one, Some(f32::NAN))),
        ("range", point(zero, one, Some(f32::INFINITY))),
        ("direction", spot(zero, 0.1, 0.2)),
        ("direction", spot(nan, 0.1, 0.2)),
        ("inner and outer angle", spot(down, 0.2, 0.2)),
        ("inner and outer angle", spot(down, -0.1, 0.2)),
        ("inner and outer angle", spot(down, 0.1, 1.6)),
        ("inner and outer angle", spot(down, f32::NAN, 0.2)),
        ("inner and outer angle", spot(down, 0.1, f32::NAN)),
        ("direction", directional(zero, one)),
        ("direction", directional(Vec3::INFINITY, one)),
        ("irradiance", directional(down, -one)),
    ] {
        let error = result.expect_err(field);
        assert_eq!(error.field.as_deref(), Some(field), "{error}");
        assert!(error.found.is_some() && error.expected.is_some(), "{error}");
    }
    assert!(spot(down, 0.0, std::f32::consts::FRAC_PI_2).is_ok());
    // In the lamp itself, light comes from somewhere and is finite.
    let inside = Light::from(above(1.0)).at(Vec3::Y);
    assert!(inside.to_light.is_normalized() && inside.irradiance.is_finite());
}

#[test]
fn coats_are_lit_by_lamps_as_by_the_sun() {
    let gpu = Gpu::open(&Choice::Auto).unwrap();
    let tiles = [coats::tile(&coats::fox(), 0.008, 8, 64, 1)];
    let ball = coats::sphere(0.05, 10, 0.5, &tiles[0]);
    let renderer = Renderer::new(&gpu, &tiles, 1).unwrap();
    let eye = Vec3::new(0.05, 0.05, 0.26);
    let of = |light: Light, show: Show| {
        let frame = Frame { lights: vec![light], ambient: Vec3::ZERO, ..crate::runtime::look(eye, [64, 64]) };
        renderer.prepare(&ball.scene(&tiles)).unwrap().draw(&frame, show).unwrap().picture
    };
    let to_light = Vec3::new(-0.5, 0.7, 0.6).normalize();
    let sun = of(Directional { to_light, irradiance: Vec3::splat(3.0) }.into(), Show::default());
    let lamp =
        |distance_m: f32| Point::new(to_light * distance_m, Vec3::splat(3.0 * distance_m * distance_m), None).unwrap();
    let far = of(lamp(100.0).into(), Show::default());
    let largest = sun.pixels.iter().zip(&far.pixels).map(|(a, b)| (a[1] - b[1]).abs()).fold(0.0, f32::max);
    assert!(largest < 1.0 / 255.0, "{largest}");
    // A cone around a point of the ball leaves the rest in the dark.
    let spot = Spot::new(lamp(0.3), -to_light, 0.02, 0.04).unwrap();
    let lit = of(spot.into(), Show::default()).pixels.iter().filter(|pixel| pixel[1] > 0.01).count();
    let seen = sun.pixels.iter().filter(|pixel| pixel[1] > 0.01).count();
    assert!(lit > 10 && lit < seen / 4, "{lit} of {seen} pixels");
}

#[test]
fn the_shadow_of_a_lamp_is_as_wrong_as_the_manual_says() {
    for (diagonals, most) in [(1.0, [0.05, 0.03]), (4.0, [0.025, 0.012])] {
        let difference = oracle::under(&lamp(&thin(), diagonals));
        assert!(difference.flip < most[0] && difference.bias.abs() < most[1], "{diagonals}: {difference:?}");
    }
}

#[test]
fn a_lamp_too_near_for_its_shadow_is_told() {
    let grown = thin();
    let notes = |diagonals: f32| lamp(&grown, diagonals).notes(&grown.mesh);
    assert!(notes(0.6)[0].contains("0.60 diagonals"), "{:?}", notes(0.6));
    assert!(notes(10.0).is_empty());
    assert!(scenes::studio().notes(&grown.mesh).is_empty());
}
