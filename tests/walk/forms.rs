//! Paths through fur where the answer is known in closed form, or by the same hairs drawn otherwise.

use super::chiang::Lambert;
use crate::scenes::{self, Grown};
use crate::undercoat::{Cylinders, on_level_skin};
use furrier::data::camera::Camera;
use furrier::data::film::Film;
use furrier::data::light::Directional;
use furrier::data::strands::{Profile, Root, Strands};
use furrier::math::hash::Stream;
use furrier::math::{DVec3, Vec3};
use furrier::reference::walk::scatter::Meeting;
use furrier::reference::walk::scatter::Scatter;
use furrier::reference::walk::{Bounces, FibreWalk, Fibres, Ready, Settings, Walked, draw_with};
use furrier::shade::Angles;
use furrier::volume::scene::{Lighting, Scene};
use std::f64::consts::{FRAC_1_PI, PI};

/// Hair that scatters this share of light the same to all sides.
struct Even(f64);

impl Scatter for Even {
    fn scatter(&self, at: &Meeting, _: DVec3, to_light: DVec3, _: DVec3) -> DVec3 {
        let sine = at.hair.dot(to_light);
        DVec3::splat(self.0 * FRAC_1_PI * FRAC_1_PI * (1.0 - sine * sine).max(0.0).sqrt())
    }

    fn sample(&self, at: &Meeting, _: DVec3, _: DVec3, random: [f64; 4]) -> (DVec3, f64) {
        let (sine, azimuth) = (2.0 * random[0] - 1.0, 2.0 * PI * random[1]);
        let (x, y) = at.hair.any_orthonormal_pair();
        let level = x * azimuth.cos() + y * azimuth.sin();
        (at.hair * sine + level * (1.0 - sine * sine).max(0.0).sqrt(), 0.25 * FRAC_1_PI)
    }
}

const WHITE: Lambert = Lambert { of_colour: |_| DVec3::ONE };

fn walk(scene: &Scene<'_>, fibre: &dyn Scatter, lighting: &Lighting, camera: &Camera, settings: &Settings) -> Walked {
    let normals = scene.skin.smooth_normals();
    let ready = Ready::new(scene, &normals, None);
    draw_with(&ready, Fibres { guard: fibre, undercoat: fibre }, lighting, camera, settings).unwrap()
}

fn from(to_light: DVec3) -> Lighting {
    let key = Directional { to_light: to_light.as_vec3(), irradiance: Vec3::ONE };
    Lighting { key: key.into(), fill: Vec::new(), ambient: Vec3::ZERO, fill_on_undercoat: true }
}

/// Thin fur of both kinds, on a bent skin.
fn thin() -> Grown {
    let mut grown = crate::oracle::thin();
    grown.fields.tint.fill(Vec3::ONE);
    grown
}

/// Radiance over alpha of thin fur whose hair and skin send all light back, in a white sky.
pub fn furnace(skin: f32) -> f64 {
    let grown = thin();
    let scene = Scene { skin_factor: Vec3::splat(skin), ..grown.scene() };
    let sky = Lighting { ambient: Vec3::ONE, ..from(DVec3::Y) };
    let sky = Lighting { key: Directional { to_light: Vec3::Y, irradiance: Vec3::ZERO }.into(), ..sky };
    let settings = Settings { paths: 16, ..Settings::new([24, 24]) };
    let film = walk(&scene, &WHITE, &sky, &scenes::camera(0.35), &settings).film;
    let alpha: f32 = film.alpha.iter().sum();
    f64::from(film.radiance.iter().map(|r| r.y).sum::<f32>() / alpha)
}

#[test]
fn a_walk_through_white_fur_in_a_white_sky_sees_white() {
    let white = furnace(1.0);
    assert!((white - 1.0).abs() < 6e-3, "{white}");
    let grey = furnace(0.9);
    assert!(grey < 0.99, "{grey}: skin that takes a tenth is found out");
}

/// Straight hairs of one width and colour on a skin.
fn straight(hairs: impl Iterator<Item = [DVec3; 2]>, radius_m: f64) -> Strands {
    let points_m: Vec<Vec3> = hairs.flatten().map(|p| p.as_vec3()).collect();
    let count = points_m.len() / 2;
    Strands {
        points_per_strand: 2,
        points_m,
        roots: vec![Root::default(); count],
        root_radius_m: vec![radius_m as f32; count],
        tint: vec![Vec3::ONE; count],
        id: (0..count as u32).collect(),
        profile: Profile { taper: 1.0, ramp: [Vec3::ONE; 3], tip_transparency: 0.0, tip_exponent: 1.0 },
    }
}

#[test]
fn a_walk_of_one_scattering_sees_a_hair_as_its_formula_has_it() {
    let ends = [DVec3::new(-3e-3, 0.0, 2e-3), DVec3::new(4e-3, 5e-4, 4e-3)];
    let strands = straight(std::iter::once(ends), 2e-4);
    let look = &scenes::scattering().guard;
    let fibre = FibreWalk::new(look);
    let middle = ends[0].lerp(ends[1], 0.5);
    let to_eye = DVec3::new(0.2, 0.5, 0.7).normalize();
    let camera = scenes::looking((middle + to_eye * 0.05).as_vec3(), middle.as_vec3(), Vec3::Y, 1.0);
    let settings = Settings { paths: 4, bounces: Bounces::Most(1), ..Settings::new([33, 33]) };
    for to_light in [DVec3::new(0.5, 0.2, 1.0), DVec3::new(-0.3, -1.0, 0.6)].map(DVec3::normalize) {
        let film = on_level_skin(&HAIRS, |scene| {
            let grown = scene.undercoat.unwrap();
            let scene = Scene { guard: Some((&strands, grown)), undercoat: None, ..*scene };
            walk(&scene, &fibre, &from(to_light), &camera, &settings).film
        });
        let angles = Angles::of_dvectors((ends[1] - ends[0]).normalize(), to_light, to_eye);
        let [worn, ..] = look.wear([1.0, 1.0, 1.0]);
        let expected = look.fibre.lit(angles).through(worn.absorption) * angles.cos_in();
        let at = 16 * 33 + 16;
        let found = f64::from(film.radiance[at].y);
        assert_eq!(film.guard[at], 1.0);
        assert!((found / expected - 1.0).abs() < 2e-3, "{found}, by hand {expected}");
    }
}

/// Undercoat of level skin seen along `to_eye`, lit from `to_light`: radiance over a square of some lengths of hair.
fn of_volume(hairs: &Cylinders, fibre: &dyn Scatter, ways: [DVec3; 2], settings: &Settings) -> (f64, f64) {
    on_level_skin(hairs, |scene| {
        let scene = Scene { skin_factor: Vec3::splat(0.3), ..*scene };
        let walked = walk(&scene, fibre, &from(ways[1]), &above(hairs, ways[0]), settings);
        mean(&walked)
    })
}

fn above(hairs: &Cylinders, to_eye: DVec3) -> Camera {
    // 1° from as far away as shows a few lengths of hair.
    let target = DVec3::new(0.07, 0.03, 0.0) * hairs.length_m;
    scenes::looking((target + to_eye * (200.0 * hairs.length_m)).as_vec3(), target.as_vec3(), Vec3::Y, 1.0)
}

fn mean(walked: &Walked) -> (f64, f64) {
    let all: f64 = walked.film.radiance.iter().map(|r| f64::from(r.y)).sum();
    (all / walked.film.radiance.len() as f64, walked.noise.mean)
}

const HAIRS: Cylinders = Cylinders { per_m2: 2e8, diameter_m: 1e-5, length_m: 96e-5, lean: DVec3::Z };

#[test]
fn a_walk_of_one_scattering_sees_upright_undercoat_as_the_closed_form_has_it() {
    let diffuse = Even(0.8);
    let settings = Settings { paths: 4096, bounces: Bounces::Most(1), ..Settings::new([4, 4]) };
    let ways = [DVec3::new(0.5, 0.3, 1.0), DVec3::new(-0.4, 0.5, 0.8)].map(DVec3::normalize);
    let (found, noise) = of_volume(&HAIRS, &diffuse, ways, &settings);
    // Both depths, of sides and, once at the top, of ends; the ends' layer is thin, and its light is scattered as from sides.
    let Cylinders { per_m2, diameter_m, length_m, .. } = HAIRS;
    let depth = |way: DVec3| {
        let side = per_m2 * diameter_m * length_m * (1.0 - way.z * way.z).sqrt() / way.z;
        side + per_m2 * 0.25 * PI * diameter_m * diameter_m
    };
    let [eye, light] = ways.map(depth);
    let sine = ways[1].z;
    let sent = 0.8 / (PI * PI) * (1.0 - sine * sine).sqrt();
    let left = (-eye - light).exp();
    let expected = sent * eye / (eye + light) * (1.0 - left) + left * 0.3 * FRAC_1_PI * sine;
    assert!((found / expected - 1.0).abs() < 0.005 + 3.0 * noise, "{found} ± {noise}, closed form {expected}");
}

#[test]
fn a_walk_through_a_volume_is_one_through_its_hairs() {
    let fibre = Even(0.9);
    let hairs = Cylinders { lean: DVec3::new(0.6, 0.0, 0.8), ..HAIRS };
    let settings = Settings { paths: 1024, ..Settings::new([4, 4]) };
    let ways = [DVec3::new(0.5, 0.3, 1.0), DVec3::new(-0.6, -0.5, 0.8)].map(DVec3::normalize);
    let volume = of_volume(&hairs, &fibre, ways, &settings);
    let each = on_level_skin(&hairs, |scene| {
        let edge_m = 24.0 * hairs.length_m;
        let mut random = Stream::new(7);
        let mut place = || (f64::from(random.unit()) - 0.5) * edge_m;
        let count = (hairs.per_m2 * edge_m * edge_m) as usize;
        let roots: Vec<DVec3> = (0..count).map(|_| DVec3::new(place(), place(), 0.0)).collect();
        let ends = roots.into_iter().map(|root| [root, root + hairs.lean * hairs.length_m]);
        let strands = straight(ends, 0.5 * hairs.diameter_m);
        let fibre_of = scene.undercoat.unwrap();
        let skin_factor = Vec3::splat(0.3);
        let scene = Scene { skin_factor, guard: Some((&strands, fibre_of)), undercoat: None, ..*scene };
        mean(&walk(&scene, &fibre, &from(ways[1]), &above(&hairs, ways[0]), &settings))
    });
    println!("volume {volume:?}, hairs {each:?}");
    let noise = volume.1.hypot(each.1);
    assert!((volume.0 / each.0 - 1.0).abs() < 0.03 + 3.0 * noise, "volume {volume:?}, hair by hair {each:?}");
}

fn small(bounces: Bounces, seed: u64) -> Film {
    let grown = thin();
    let settings = Settings { paths: 3, bounces, seed, ..Settings::new([24, 24]) };
    furrier::reference::walk::draw(&grown.scene(), &scenes::studio(), &scenes::camera(0.35), &settings).unwrap().film
}

#[test]
fn a_walk_has_the_same_bytes_on_any_number_of_threads_and_others_by_another_seed() {
    let on = |threads: usize, seed: u64| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| small(Bounces::All, seed))
    };
    let one = on(1, 4);
    assert_eq!(one, on(3, 4));
    assert_ne!(one, on(3, 5));
}

#[test]
fn more_scatterings_never_take_light_away() {
    let films = [Bounces::Most(1), Bounces::Most(2), Bounces::Most(5), Bounces::All].map(|bounces| small(bounces, 2));
    for pair in films.windows(2) {
        let pixels = pair[0].radiance.iter().zip(&pair[1].radiance);
        assert!(pixels.clone().all(|(fewer, more)| fewer.cmple(*more).all()));
        assert!(pixels.clone().any(|(fewer, more)| fewer.y < more.y));
    }
    let all = films[0].alpha.iter().zip(&films[3].alpha);
    assert!(all.clone().all(|(one, all)| one == all));
}
