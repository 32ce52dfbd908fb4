//! The law of light against walks that follow every scattering: flat pelts of guard hair, six colours, 24 pairs of eye and
//! light, and the sky. `cargo bench --bench pelts [-- PATHS [PELT...]]`.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a bench that cannot go on stops, and prints what it found"
)]

#[path = "../tests/walk/pelt.rs"]
#[allow(dead_code, reason = "tests use the rest")]
mod pelt;

use furrier::data::camera::Camera;
use furrier::data::light::Directional;
use furrier::hybrid::{Settings, draw};
use furrier::math::{DVec3, Vec3};
use furrier::reference::walk::{self, Bounces, Ready, draw_ready};
use furrier::volume::scene::{Lighting, Scene};
use pelt::{Light, Pelt, direction, grow};

const VIEWS: [(f64, f64); 4] = [(0.0, 0.0), (45.0, 0.0), (65.0, 0.0), (45.0, 180.0)];
const LIGHTS: [Light; 7] = [
    Light::From(20.0, 90.0),
    Light::From(45.0, 0.0),
    Light::From(45.0, 90.0),
    Light::From(45.0, 180.0),
    Light::From(70.0, 90.0),
    Light::From(70.0, 180.0),
    Light::Sky,
];
/// Two hairs' worth of channels.
const COLOURS: [[f64; 3]; 2] = [[0.95, 0.8, 0.55], [0.2, 0.06, 0.03]];

fn main() {
    let mut words = std::env::args().skip(1).filter(|word| word != "--bench");
    let paths = words.next().map_or(1500, |word| word.parse().unwrap());
    let chosen: Vec<String> = words.collect();
    for pelt in [Pelt::T, Pelt::U, Pelt::F] {
        if !chosen.is_empty() && !chosen.contains(&format!("{pelt:?}")) {
            continue;
        }
        let (mut off, mut all) = ([0.0; 6], [0.0; 6]);
        let (mut sum, mut sky_off) = ([0.0; 6], [0.0; 6]);
        for (half, colour) in COLOURS.iter().enumerate() {
            let grown = grow(pelt, 0.07, *colour);
            let scene = grown.scene();
            let normals = scene.skin.smooth_normals();
            let ready = Ready::new(&scene, &normals, None);
            for light in LIGHTS {
                for view in VIEWS {
                    let truth = followed(&ready, view, light, paths);
                    let law = lawful(&scene, view, light);
                    let ratio = law / truth;
                    println!("{pelt:?} {light:?} from {view:?}: {truth:.4} law {law:.4} ratio {ratio:.2}");
                    for channel in 0..3 {
                        let at = 3 * half + channel;
                        let (t, l) = (truth[channel], law[channel]);
                        if light == Light::Sky {
                            sky_off[at] += 0.25 * (l / t - 1.0);
                        } else {
                            off[at] += (l - t).abs();
                            sum[at] += l;
                            all[at] += t;
                        }
                    }
                }
            }
        }
        let by = |a: [f64; 6], b: [f64; 6], less: f64| [0, 1, 2, 3, 4, 5].map(|i: usize| a[i] / b[i] - less);
        println!(
            "{pelt:?}: |error| {:.3}, by colour {:.3?}",
            off.iter().sum::<f64>() / all.iter().sum::<f64>(),
            by(off, all, 0.0)
        );
        println!("{pelt:?}: bias {:.3?}; sky {sky_off:.3?}", by(sum, all, 1.0));
    }
}

fn camera(view: (f64, f64)) -> Camera {
    let target = DVec3::new(0.0, 0.02, 0.0);
    let up = if view.0 < 1.0 { DVec3::Z } else { DVec3::Y };
    let eye = target + direction(view.0, view.1) * 0.8;
    Camera { eye: eye.to_array(), target: target.to_array(), up: up.to_array(), vfov_deg: 1.0 }
}

fn lighting(light: Light) -> Lighting {
    let (to_light, irradiance, ambient) = match light {
        Light::From(zenith, azimuth) => (direction(zenith, azimuth).as_vec3(), Vec3::ONE, Vec3::ZERO),
        Light::Sky => (Vec3::Y, Vec3::ZERO, Vec3::ONE),
    };
    Lighting { key: Directional { to_light, irradiance }.into(), fill: Vec::new(), ambient, fill_on_undercoat: true }
}

fn followed(ready: &Ready<'_>, view: (f64, f64), light: Light, paths: usize) -> DVec3 {
    let settings = walk::Settings { paths, bounces: Bounces::All, ..walk::Settings::new([1, 1]) };
    draw_ready(ready, &lighting(light), &camera(view), &settings).unwrap().film.radiance[0].as_dvec3()
}

fn lawful(scene: &Scene<'_>, view: (f64, f64), light: Light) -> DVec3 {
    let film = draw(scene, &lighting(light), &camera(view), &Settings::best([32, 32])).unwrap().film;
    let count = film.radiance.len() as f64;
    film.radiance.iter().map(|light| light.as_dvec3()).sum::<DVec3>() / count
}
