//! The renderer against the reference, and the reference against closed forms.

use crate::scenes::{self, Grown};
use crate::undercoat::{Cylinders, depth_of_volume, directions, on_level_skin};
use furrier::data::film::Film;
use furrier::hybrid;
use furrier::math::hash::Stream;
use furrier::math::{DVec3, Vec3};
use furrier::metrics::compare::{Difference, LinearImage, compare};
use furrier::reference::bvh::DRay;
use furrier::reference::cone;
use furrier::reference::medium::{Counted, DMedium};
use furrier::reference::point::DShellPoint;
use furrier::reference::sight::PrismRay;
use furrier::reference::{self, Settings};
use furrier::volume::scene::Lighting;

/// Optical depth of the reference's medium along a ray from above through hair of one length on level skin.
fn depth_of_reference(hairs: &Cylinders, direction: DVec3) -> f64 {
    on_level_skin(hairs, |scene| {
        let normals = scene.skin.smooth_normals();
        let medium = DMedium::new(scene, &normals, None).unwrap();
        // Through a point over the middle, off any lattice line.
        let through = DVec3::new(0.13, 0.29, 1.0) * hairs.length_m;
        let ray = DRay::new(through - direction * (20.0 * hairs.length_m), direction);
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

pub fn thin() -> Grown {
    let (mut guard, mut undercoat) = scenes::mink();
    guard.density_per_cm2 = 60.0;
    undercoat.density_per_cm2 = 1500.0;
    Grown::new(scenes::bent_skin(1), &guard, &undercoat, Vec3::X, 35.0, 3)
}

const SIZE: [usize; 2] = [48, 48];

fn by_reference(size: [usize; 2], grown: &Grown, lighting: &Lighting, lines: usize, seed: u64) -> Film {
    let settings = Settings { lines, lightness_error: f64::INFINITY, seed, ..Settings::new(size) };
    reference::draw(&grown.scene(), lighting, &scenes::camera(0.35), &settings).unwrap()
}

/// The renderer's picture under `lighting` against the reference under the usual light.
pub fn against_reference(lighting: &Lighting) -> Difference {
    changed_against_reference(lighting, |_| ())
}

/// The same after a change to what the renderer made ready.
pub fn changed_against_reference(lighting: &Lighting, change: impl Fn(&mut hybrid::Prepared<'_>)) -> Difference {
    compared(&scenes::studio(), lighting, change)
}

/// The renderer's picture against the reference, both under `lighting`.
pub fn under(lighting: &Lighting) -> Difference {
    compared(lighting, lighting, |_| ())
}

fn compared(usual: &Lighting, lighting: &Lighting, change: impl Fn(&mut hybrid::Prepared<'_>)) -> Difference {
    let grown = thin();
    let film = by_reference(SIZE, &grown, usual, 4, 1);
    let scene = grown.scene();
    let mut prepared = hybrid::prepare(&scene, lighting, &hybrid::Settings::best(SIZE)).unwrap();
    change(&mut prepared);
    let drawn = prepared.draw(&scenes::camera(0.35)).unwrap().film;
    let difference = compare(&LinearImage::from(&film), &LinearImage::from(&drawn)).unwrap();
    println!("{difference:?}");
    difference
}

/// What is off, of a picture of 48² against 4 lines per pixel.
pub fn fault(difference: &Difference) -> Option<&'static str> {
    let [reference, drawn] = difference.coverage;
    [
        (difference.bias.abs() > 0.01, "bias"),
        (difference.flip > 0.02, "flip"),
        ((drawn - reference).abs() > 0.002, "coverage"),
    ]
    .into_iter()
    .find_map(|(off, name)| off.then_some(name))
}

#[test]
fn the_renderer_draws_what_the_reference_draws() {
    assert_eq!(fault(&against_reference(&scenes::studio())), None);
}

#[test]
fn a_reference_has_the_same_bytes_on_any_number_of_threads() {
    let grown = thin();
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| by_reference([10, 10], &grown, &scenes::studio(), 1, 5))
    };
    assert_eq!(with(1), with(3));
}

/// Of random round cones, the largest share of the stretch that a line sees of one by which it begins or ceases elsewhere than
/// where its rays do, where the former are `wider` than the latter.
pub fn largest_gap(wider: f64) -> f64 {
    let mut random = Stream::new(7);
    let mut unit = || f64::from(random.unit());
    let base = DVec3::new(0.0, 0.1, 1.0);
    let step = DVec3::new(0.01, 0.0, 0.0);
    let mut largest = 0.0_f64;
    let mut met = 0;
    while met < 200 {
        let mut point = || DVec3::new(0.005 * unit() - 0.001, 0.05 + 0.003 * (unit() - 0.5), 0.5 + 0.01 * unit());
        let ends = [point(), point()];
        let radii = [1e-4 * unit(), 1e-4 * unit()];
        let Some([from, to]) = cone::extent(ends[0], ends[1], radii.map(|r| r * wider), base, step) else { continue };
        met += 1;
        let meets = |x: f64| cone::enter_and_leave(ends[0], ends[1], radii, (base + step * x).normalize()).is_some();
        // The cone is convex: what its rays see of it is one stretch, too.
        let edge = |mut inside: f64, mut outside: f64| {
            for _ in 0..40 {
                let middle = 0.5 * (inside + outside);
                *(if meets(middle) { &mut inside } else { &mut outside }) = middle;
            }
            inside
        };
        let (middle, length) = (0.5 * (from + to), to - from);
        let gaps = [edge(middle, from - length) - from, to - edge(middle, to + length)];
        largest = gaps.into_iter().fold(largest, |largest, gap| largest.max(gap.abs() / length));
    }
    largest
}

#[test]
fn a_line_sees_a_hair_where_its_rays_meet_it() {
    let gap = largest_gap(1.0);
    assert!(gap < 3e-5, "{gap} of a stretch");
}

/// Of a thousand random points in a scene's shell, how many a ray through them does not find where they are, if it passes
/// `beside` of the shell's height away.
pub fn places_missed(beside: f64) -> usize {
    let grown = thin();
    let scene = grown.scene();
    let normals = scene.skin.smooth_normals();
    let medium = DMedium::new(&scene, &normals, None).unwrap();
    let height_m = f64::from(medium.shell.undercoat.height_m);
    let mut random = Stream::new(11);
    let mut unit = || f64::from(random.unit());
    let missed = |_: &usize| {
        let triangle = (unit() * scene.skin.triangles.len() as f64) as u32;
        let (u, v) = (unit(), unit());
        let b = if u + v < 1.0 { DVec3::new(u, v, 1.0 - u - v) } else { DVec3::new(1.0 - u, 1.0 - v, u + v - 1.0) };
        let point = DShellPoint { triangle, b, t: unit() };
        let direction = DVec3::new(unit() - 0.5, unit() - 0.5, unit() - 0.5).normalize();
        let away = direction.any_orthonormal_vector() * (beside * height_m);
        let at_m = height_m * (1.0 + unit());
        let ray = DRay::new(medium.slabs.position_m(&point) + away - direction * at_m, direction);
        let mut found = false;
        medium.slabs.visit(&ray, [0.0, 3.0 * height_m], f64::INFINITY, |sight, _, [from_m, to_m], _| {
            found |= from_m - 1e-9 <= at_m
                && at_m <= to_m + 1e-9
                && sight.spots(at_m).into_iter().flatten().any(|spot| {
                    let there = spot.point;
                    there.triangle == triangle && (there.b - b).length() < 1e-6 && (there.t - point.t).abs() < 1e-6
                });
        });
        !found
    };
    (0..1000).filter(missed).count()
}

#[test]
fn a_ray_finds_every_place_of_the_shell_that_it_passes() {
    assert_eq!(places_missed(0.0), 0);
}

/// Of random prisms that fold over themselves, the share of what rays pass of them, each sheet by itself, that the stretches of
/// rays `beside` away are off by.
pub fn intervals_missed(beside: f64) -> f64 {
    const STEPS: usize = 2000;
    let mut random = Stream::new(3);
    let mut unit = || f64::from(random.unit());
    let (mut passed, mut off) = (0.0, 0.0);
    for _ in 0..300 {
        let feet = [DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| p + 0.2 * DVec3::new(unit(), unit(), unit()));
        let middle = (feet[0] + feet[1] + feet[2]) / 3.0;
        // Hair leans across the middle: somewhere below the top it crosses.
        let offsets = feet.map(|p| DVec3::Z + (middle - p) * (1.0 + 2.0 * unit()) + DVec3::new(unit(), unit(), unit()));
        let (u, v, t) = (0.5 * unit(), 0.5 * unit(), unit());
        let through: DVec3 = (0..3).map(|i| (feet[i] + offsets[i] * t) * [1.0 - u - v, u, v][i]).sum();
        let direction = DVec3::new(unit() - 0.5, unit() - 0.5, unit() - 0.5).normalize();
        let ray = DRay::new(through - direction * 2.0, direction);
        let away = DRay::new(ray.origin_m + direction.any_orthonormal_vector() * beside, direction);
        let whole = [0.0, 4.0];
        let mut found = 0.0;
        PrismRay::new(&away, 0, &(feet, offsets), [0.0, 1.0]).spans(whole, whole, |[from, to], middle| {
            found += (to - from) * middle.iter().flatten().count() as f64;
        });
        let sight = PrismRay::new(&ray, 0, &(feet, offsets), [0.0, 1.0]);
        let step = whole[1] / STEPS as f64;
        let at = |i: usize| sight.spots(step * (i as f64 + 0.5)).iter().flatten().count();
        let expected = step * (0..STEPS).map(at).sum::<usize>() as f64;
        passed += expected;
        off += (found - expected).abs();
    }
    off / passed
}

#[test]
fn a_ray_is_followed_to_where_a_prism_folds() {
    let missed = intervals_missed(0.0);
    assert!(missed < 5e-3, "{missed}");
}

/// How far two seeds of the reference are apart.
fn between_seeds(lines: usize) -> Difference {
    let grown = thin();
    let [a, b] = [1, 2].map(|seed| by_reference([16, 16], &grown, &scenes::studio(), lines, seed));
    compare(&LinearImage::from(&a), &LinearImage::from(&b)).unwrap()
}

#[test]
fn more_lines_bring_two_seeds_closer() {
    let [few, more] = [1, 4].map(between_seeds);
    println!("FLIP {:.4} of a line, {:.4} of four; bias {:+.4} and {:+.4}", few.flip, more.flip, few.bias, more.bias);
    assert!(more.flip < 0.5 * few.flip);
}
