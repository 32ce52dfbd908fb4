//! Paths through pelts against another path tracer's radiances.
//!
//! They are Mitsuba 3.9.1's: its `path` with all scatterings, B-spline curves, `hair` half and half with a Lambert cylinder. Under
//! lights, the pelt was a thousand of its units wide and its tips lay near the origin: Mitsuba's rays leave a surface by 9e-5 of a
//! unit and more, which, where a unit is a metre, is 1.5 diameters of a hair. That takes away up to a fifth of the light where light
//! and eye are close, and next to nothing under a sky; those values are of pelts in metres, of less noise.

use super::chiang::{Chiang, Half};
use super::pelt::{Light, Pelt, grow, radiance, smooth};
use furrier::math::DVec3;
use furrier::reference::walk::scatter::{Meeting, Scatter};
use furrier::reference::walk::{Bounces, Ready};
use furrier::volume::scene::Scene;

/// A pelt's radiance in three colours, and its standard error over it.
struct Known {
    view: (f64, f64),
    light: Light,
    radiance: [f64; 3],
    noise: f64,
}

const HIGH: [f64; 3] = [0.95, 0.8, 0.55];

/// A fibre that loses some light at every scattering.
struct Dimmed<'a>(&'a dyn Scatter, f64);

impl Scatter for Dimmed<'_> {
    fn scatter(&self, at: &Meeting, to_eye: DVec3, to_light: DVec3, colour: DVec3) -> DVec3 {
        self.0.scatter(at, to_eye, to_light, colour) * self.1
    }

    fn sample(&self, at: &Meeting, to_eye: DVec3, colour: DVec3, random: [f64; 4]) -> (DVec3, f64) {
        self.0.sample(at, to_eye, colour, random)
    }
}

fn known(pelt: Pelt) -> Vec<Known> {
    let of = |view, light, radiance, noise| Known { view, light, radiance, noise };
    match pelt {
        Pelt::T => vec![
            of((65.0, 0.0), Light::From(45.0, 0.0), [0.28957, 0.27560, 0.22617], 0.006),
            of((45.0, 0.0), Light::From(45.0, 90.0), [0.18990, 0.17297, 0.12289], 0.010),
            of((45.0, 180.0), Light::Sky, [0.69617, 0.52553, 0.24793], 0.003),
        ],
        Pelt::U => vec![
            of((65.0, 0.0), Light::From(70.0, 180.0), [0.08954, 0.08002, 0.05365], 0.020),
            of((45.0, 180.0), Light::Sky, [0.8292, 0.7026, 0.4323], 0.003),
        ],
        Pelt::F => vec![of((45.0, 0.0), Light::From(45.0, 0.0), [0.29289, 0.27763, 0.22546], 0.006)],
    }
}

/// What of a pelt's radiances is off by more than 2 % and three times the noise of both, where a share `kept` of the light is kept
/// at each scattering.
pub fn departures(pelt: Pelt, kept: f64, paths: usize) -> Vec<String> {
    let grown = grow(pelt, 0.07, HIGH);
    let scene = grown.scene();
    let (strands, fibre) = scene.guard.unwrap();
    let strands = smooth(strands, 2);
    let scene = Scene { guard: Some((&strands, fibre)), ..scene };
    let normals = scene.skin.smooth_normals();
    let ready = Ready::new(&scene, &normals, None);
    let hair = Half::new(0.3);
    let mut found = Vec::new();
    for Known { view, light, radiance: expected, noise } in known(pelt) {
        let (seen, own) = radiance(&ready, &Dimmed(&hair, kept), view, light, paths, Bounces::All);
        for channel in 0..3 {
            let (seen, expected) = (seen[channel], expected[channel]);
            let off = seen / expected - 1.0;
            println!("{pelt:?} from {view:?}, {light:?}: {seen:.4} ± {own:.3}, theirs {expected:.4}: {off:+.3}");
            if off.abs() > 0.02 + 3.0 * own.hypot(noise) {
                found.push(format!("{pelt:?} from {view:?}, {light:?}: {seen}, theirs {expected}"));
            }
        }
    }
    found
}

#[test]
fn a_walk_through_pelts_sees_what_another_path_tracer_saw() {
    for pelt in [Pelt::T, Pelt::U, Pelt::F] {
        let found = departures(pelt, 1.0, 3000);
        assert!(found.is_empty(), "{}", found.join("\n"));
    }
}

#[test]
fn hair_that_loses_a_twentieth_of_its_light_is_found_out() {
    assert!(!departures(Pelt::F, 0.95, 1000).is_empty() || !departures(Pelt::U, 0.95, 1000).is_empty());
}

#[test]
fn chiang_s_fibre_sends_what_the_other_s_sends() {
    // `hair` of Mitsuba 3.9.1, of colour 0.8: `eval` for two directions to the eye and to the light, the hair along y, normal z.
    let directions = [
        ([-0.819335938, -0.570875576, 0.0528175855], [-0.810830495, 0.410308365, 0.417373877], 0.0667860731),
        ([0.874541615, -0.459198525, 0.15592844], [0.910754994, 0.288327868, 0.295622024], 0.186888501),
        ([-0.616361617, 0.667057894, 0.4184879], [0.473290085, 0.045734372, 0.879718627], 0.00253705238),
    ];
    for (to_eye, to_light, expected) in directions {
        let [to_eye, to_light] = [to_eye, to_light].map(DVec3::from);
        let at = Meeting::new(DVec3::Y, DVec3::Z, to_eye);
        let found = Chiang::new(0.3).scatter(&at, to_eye, to_light, DVec3::splat(0.8)).x;
        assert!((found / expected - 1.0).abs() < 1e-3, "{found}, theirs {expected}");
    }
}
