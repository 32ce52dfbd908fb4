//! The renderer against the reference, and the reference against closed forms.

use crate::pelts::{self, Grown};
use crate::undercoat::{Cylinders, depth_of_volume, directions, on_level_skin};
use furrier::data::film::Film;
use furrier::math::{DVec3, Vec3};
use furrier::metrics::compare::{Difference, Light, compare};
use furrier::render::pelt::Lighting;
use furrier::render::picture::{self, draw};
use furrier::render::reference::bvh::Ray;
use furrier::render::reference::medium::{Counted, Medium};
use furrier::render::reference::{self, Settings};

/// Optical depth of the reference's medium along a ray from above through hair of one length on level skin.
fn depth_of_reference(hairs: &Cylinders, direction: DVec3) -> f64 {
    on_level_skin(hairs, |pelt| {
        let normals = pelt.skin.smooth_normals();
        let medium = Medium::new(pelt, &normals, None).unwrap();
        // Through a point over the middle, off any lattice line.
        let through = DVec3::new(0.13, 0.29, 1.0) * hairs.length_m;
        let ray = Ray::new(through - direction * (20.0 * hairs.length_m), direction);
        medium.depth_along(&ray, 0.0, f64::INFINITY, Counted::Undercoat, f64::INFINITY)
    })
}

#[test]
fn optical_depth_of_the_reference_is_the_closed_form() {
    let hairs = Cylinders { per_m2: 2e8, diameter_m: 1e-5, length_m: 16e-5, lean: DVec3::Z };
    for direction in directions() {
        let tangent = direction.x.abs() / direction.z.abs();
        let end = std::f64::consts::FRAC_PI_4 * hairs.diameter_m * hairs.diameter_m;
        let expected = hairs.per_m2 * (hairs.diameter_m * hairs.length_m * tangent + end);
        let found = depth_of_reference(&hairs, direction);
        assert!((found / expected - 1.0).abs() < 2e-3, "along {direction}: {found}, closed form {expected}");
    }
}

#[test]
fn volume_and_reference_find_the_same_optical_depth_in_leaning_hair() {
    let lean = DVec3::new(0.5_f64.sqrt(), 0.0, 0.5_f64.sqrt());
    let hairs = Cylinders { per_m2: 2e8, diameter_m: 1e-5, length_m: 48e-5, lean };
    for direction in directions() {
        let (volume, found) = (depth_of_volume(&hairs, direction), depth_of_reference(&hairs, direction));
        assert!((found / volume - 1.0).abs() < 0.01, "along {direction}: {found}, by the march {volume}");
    }
}

fn thin() -> Grown {
    let (mut guard, mut undercoat) = pelts::mink();
    guard.density_per_cm2 = 60.0;
    undercoat.density_per_cm2 = 1500.0;
    Grown::new(pelts::bent_pelt(1), &guard, &undercoat, Vec3::X, 35.0, 3)
}

const SIZE: [usize; 2] = [48, 48];

fn by_reference(grown: &Grown, lighting: &Lighting, samples: usize, seed: u64) -> Film {
    let settings = Settings { samples, lightness_error: 0.0, seed, ..Settings::new(SIZE) };
    reference::draw(&grown.pelt(), lighting, &pelts::camera(0.35), &settings).unwrap()
}

/// The renderer's picture under `lighting` against the reference under the usual light.
pub fn against_reference(lighting: &Lighting) -> Difference {
    let grown = thin();
    let film = by_reference(&grown, &pelts::studio(), 48, 1);
    let drawn = draw(&grown.pelt(), lighting, &pelts::camera(0.35), &picture::Settings::best(SIZE)).unwrap().film;
    let difference = compare(&Light::from(&film), &Light::from(&drawn)).unwrap();
    println!("{difference:?}");
    difference
}

/// What is off, of a picture of 48² against 48 rays per pixel.
pub fn fault(difference: &Difference) -> Option<&'static str> {
    let [reference, drawn] = difference.coverage;
    [
        (difference.bias.abs() > 0.03, "bias"),
        (difference.flip > 0.08, "flip"),
        ((drawn - reference).abs() > 0.01, "coverage"),
    ]
    .into_iter()
    .find_map(|(off, name)| off.then_some(name))
}

#[test]
fn the_renderer_draws_what_the_reference_draws() {
    assert_eq!(fault(&against_reference(&pelts::studio())), None);
}

#[test]
fn a_reference_has_the_same_bytes_on_any_number_of_threads() {
    let grown = thin();
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| by_reference(&grown, &pelts::studio(), 2, 5))
    };
    assert_eq!(with(1), with(3));
}
