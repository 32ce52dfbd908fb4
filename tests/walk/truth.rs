//! Paths through pelts against another path tracer's radiances.
//!
//! They are Mitsuba 3.9.1's (`path`, all scatterings, B-spline curves), of pelts 10 m wide as ours are 10 cm and their tips near the
//! origin: its rays leave a surface by 9e-5 of a unit and more, 1.5 diameters of a hair in metres, which took away a tenth of the
//! light of one scattering where eye and light are close. Two pixels in three hundred thousand paths tell the noise given here.

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
