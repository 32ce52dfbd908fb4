//! Guard hair and undercoat in one picture: what holds wherever the eye is and whatever the hair is like.

use crate::scenes::{self, Grown};
use furrier::data::camera::Camera;
use furrier::data::film::{Film, Layers};
use furrier::hybrid::resolve::Blending;
use furrier::hybrid::{Settings, draw};
use furrier::math::Vec3;

const SETTINGS: Settings = Settings {
    size: [96, 96],
    halvings: 0,
    blending: Blending::Virtual { fragments: 8 },
    stepping: furrier::volume::march::Stepping { depth: 0.25, layers: 2.0 },
    resolution: furrier::volume::march::content::Resolution {
        layers: 16,
        subelement_px: 1.5,
        most_subdivisions: 7,
        shadow_coarser: 2,
        coarsest_details: f32::INFINITY,
        pattern: None,
    },
    shadow_span: 0.1,
    hair_px: 0.0,
    opaque: 1e-3,
    band_bytes: 256 << 20,
    layers: Layers::All,
};

fn thin() -> Grown {
    let (mut guard, mut undercoat) = scenes::mink();
    guard.density_per_cm2 = 40.0;
    undercoat.density_per_cm2 = 1000.0;
    Grown::new(scenes::bent_skin(1), &guard, &undercoat, Vec3::X, 35.0, 3)
}

fn film(grown: &Grown, camera: &Camera, settings: &Settings) -> Film {
    draw(&grown.scene(), &scenes::studio(), camera, settings).unwrap().film
}

/// Names the first pixel that no film may hold.
fn sane(film: &Film) {
    for i in 0..film.alpha.len() {
        let fine = film.radiance[i].is_finite()
            && film.radiance[i].min_element() >= 0.0
            && (-1e-5..=1.0001).contains(&film.alpha[i])
            && film.depth_m[i].is_finite()
            && film.guard[i] + film.undercoat[i] <= film.alpha[i] + 1e-3;
        assert!(fine, "pixel {i}: {:?}, alpha {}", film.radiance[i], film.alpha[i]);
    }
}

#[test]
fn an_eye_inside_the_coat_sees_hair() {
    let grown = thin();
    for eye_m in [Vec3::new(0.0, 0.043, 0.0), Vec3::new(0.01, 0.0402, 0.001), Vec3::new(0.0, 0.0, 0.0)] {
        for target_m in [Vec3::new(0.3, 0.05, 0.02), Vec3::new(0.0, 1.0, 0.01), Vec3::new(0.0, -1.0, 0.0)] {
            let camera = scenes::looking(eye_m, target_m, Vec3::Z, 57.0);
            sane(&film(&grown, &camera, &SETTINGS));
        }
    }
    let camera = scenes::looking(Vec3::new(0.0, 0.043, 0.0), Vec3::new(0.3, 0.043, 0.0), Vec3::Y, 57.0);
    assert!(film(&grown, &camera, &SETTINGS).undercoat.iter().sum::<f32>() > 500.0);
}

#[test]
fn bare_skin_and_hair_of_no_width_change_nothing() {
    let camera = scenes::camera(0.35);
    let mut grown = thin();
    grown.fields.density.fill(0.0);
    grown.guard_fibre.radius_m = 0.0;
    grown.guard.root_radius_m.fill(0.0);
    let bare = film(&grown, &camera, &SETTINGS);
    sane(&bare);
    assert_eq!(bare.guard.iter().chain(&bare.undercoat).copied().fold(0.0, f32::max), 0.0);
    let mut grown = thin();
    grown.fields.length.fill(0.0);
    sane(&film(&grown, &camera, &SETTINGS));
}

#[test]
fn threads_do_not_show() {
    let (grown, camera) = (thin(), scenes::camera(0.35));
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| film(&grown, &camera, &SETTINGS))
    };
    assert_eq!(with(1), with(4));
}

#[test]
fn all_blendings_cover_what_both_kinds_cover() {
    let (grown, camera) = (thin(), scenes::camera(0.35));
    let exact = film(&grown, &camera, &Settings { blending: Blending::Virtual { fragments: 64 }, ..SETTINGS });
    sane(&exact);
    for fragments in [1, 4, 16] {
        let coarse = film(&grown, &camera, &Settings { blending: Blending::Virtual { fragments }, ..SETTINGS });
        assert!((coarse.coverage() - exact.coverage()).abs() < 0.002, "{fragments} virtual fragments");
    }
    let simplified = Blending::Simplified { attenuation_per_m: 400.0 };
    sane(&film(&grown, &camera, &Settings { blending: simplified, ..SETTINGS }));
}

#[test]
fn shorter_steps_agree_with_longer_ones() {
    let (grown, camera) = (thin(), scenes::camera(0.35));
    let mut scene = grown.scene();
    scene.guard = None;
    let mean = |depth: f32, layers: f32| {
        let stepping = furrier::volume::march::Stepping { depth, layers };
        let settings = Settings { stepping, ..SETTINGS };
        draw(&scene, &scenes::studio(), &camera, &settings).unwrap().film.coverage()
    };
    let (fine, coarse) = (mean(0.02, 0.25), mean(0.25, 2.0));
    assert!((fine - coarse).abs() < 0.003, "coverage {fine} by short steps, {coarse} by long ones");
}

#[test]
fn layers_that_are_not_asked_for_take_no_room_and_change_nothing() {
    let grown = thin();
    let camera = scenes::camera(0.2);
    let of = |layers| film(&grown, &camera, &Settings { layers, halvings: 1, ..SETTINGS });
    let [all, depth, light] = [Layers::All, Layers::LightAndDepth, Layers::Light].map(of);
    for film in [&depth, &light] {
        assert_eq!((&film.radiance, &film.alpha), (&all.radiance, &all.alpha));
        assert!(film.albedo.is_empty() && film.tangent.is_empty() && film.normal.is_empty());
        assert!(film.guard.is_empty() && film.undercoat.is_empty());
    }
    assert_eq!(depth.depth_m, all.depth_m);
    assert!(light.depth_m.is_empty() && all.albedo.len() == all.alpha.len());
}
