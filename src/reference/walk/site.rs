//! A place where light is scattered: hair or skin, its colour, and how it scatters.

use super::hairs::Leaving;
use super::scatter::{Meeting, Scatter};
use super::space::{Met, Space, unit};
use crate::math::hash::Stream;
use crate::math::{DVec3, Vec3};
use crate::reference::bvh::DRay;
use crate::reference::guard::{Crossing, GuardCones};
use crate::reference::medium::DMedium;
use crate::reference::point::DShellPoint;
use crate::volume::scene::Scene;
use std::f64::consts::{FRAC_1_PI, TAU};

/// How the two kinds of hair scatter.
#[derive(Clone, Copy)]
pub struct Fibres<'a> {
    /// Guard hair.
    pub guard: &'a dyn Scatter,
    /// Undercoat.
    pub undercoat: &'a dyn Scatter,
}

/// What scatters at a site.
enum Kind<'a> {
    Hair {
        fibre: &'a dyn Scatter,
        meeting: Meeting,
    },
    /// Lambert's law on both sides. `face` is the side of the triangle that the eye sees: nothing comes through it.
    Skin {
        face: DVec3,
    },
}

/// Where light is scattered.
pub struct Site<'a> {
    at_m: DVec3,
    to_eye: DVec3,
    leaving: Option<Leaving>,
    kind: Kind<'a>,
    /// Colour of the hair or the skin.
    pub colour: DVec3,
    /// Direction of the hair, in the mean, or zero.
    pub tangent: DVec3,
    /// Normal of the skin on the eye's side, or zero.
    pub normal: DVec3,
}

impl Site<'_> {
    /// Where it is, m.
    pub fn at_m(&self) -> DVec3 {
        self.at_m
    }

    /// The hair that rays from here leave first.
    pub fn leaving(&self) -> Option<Leaving> {
        self.leaving
    }

    /// A ray from here.
    pub fn ray(&self, direction: DVec3) -> DRay {
        DRay::new(self.at_m, direction)
    }

    /// As [`Scatter::scatter`].
    pub fn scatter(&self, to_light: DVec3) -> DVec3 {
        match &self.kind {
            Kind::Hair { fibre, meeting } => fibre.scatter(meeting, self.to_eye, to_light, self.colour),
            Kind::Skin { face } if to_light.dot(*face) > 0.0 => {
                self.colour * (FRAC_1_PI * to_light.dot(self.normal).max(0.0))
            }
            Kind::Skin { .. } => DVec3::ZERO,
        }
    }

    /// As [`Scatter::sample`].
    pub fn sample(&self, random: &mut Stream) -> (DVec3, f64) {
        let random = [0; 4].map(|_| unit(random));
        match &self.kind {
            Kind::Hair { fibre, meeting } => fibre.sample(meeting, self.to_eye, self.colour, random),
            Kind::Skin { .. } => {
                let (radius, angle) = (random[0].sqrt(), TAU * random[1]);
                let cosine = (1.0 - random[0]).sqrt();
                let (x, y) = self.normal.any_orthonormal_pair();
                let direction =
                    x * (radius * libm::cos(angle)) + y * (radius * libm::sin(angle)) + self.normal * cosine;
                (direction, FRAC_1_PI * cosine)
            }
        }
    }
}

/// What tells of a place all that scattering needs.
pub struct Sites<'a> {
    /// The scene.
    pub scene: &'a Scene<'a>,
    /// Smooth normals of the skin.
    pub normals: &'a [Vec3],
    /// How hair scatters.
    pub fibres: Fibres<'a>,
    /// Slope of undercoat's hairs against their mean, standard deviation along each axis.
    pub slope: f64,
}

impl<'a> Sites<'a> {
    /// The site where a ray has met something after `at_m`; none where that is not there.
    pub fn site(&self, space: &Space<'_>, ray: &DRay, at_m: f64, met: &Met, random: &mut Stream) -> Option<Site<'a>> {
        let (place_m, to_eye) = (ray.origin_m + ray.direction * at_m, -ray.direction);
        Some(match met {
            Met::Guard(crossing) => self.guard(&space.guard?.cones, crossing, place_m, to_eye),
            Met::Undercoat(point) => self.undercoat(space.medium?, point, place_m, to_eye, random),
            Met::Skin(point) => self.skin(point, to_eye),
        })
    }

    fn guard(&self, guard: &GuardCones<'_>, crossing: &Crossing, at_m: DVec3, to_eye: DVec3) -> Site<'a> {
        let strands = guard.strands();
        let points = strands.points_of_m(crossing.strand as usize);
        let (last, segment) = (points.len() - 1, crossing.segment as usize);
        let point = |i: usize| points[i.min(last)].as_dvec3();
        let along = crossing.along_strand - segment as f64;
        let way = (point(segment + 1) - point(segment)).normalize_or(DVec3::Y);
        // The hair's direction turns evenly from point to point.
        let at_point = |i: usize| (point(i + 1) - point(i.saturating_sub(1))).normalize_or(way);
        let hair = at_point(segment).lerp(at_point(segment + 1), along).normalize_or(way);
        let out = at_m - point(segment).lerp(point(segment + 1), along);
        let ramp = strands.profile.ramp_at(guard.s(crossing.along_strand) as f32);
        Site {
            at_m,
            to_eye,
            leaving: Some((*crossing).into()),
            kind: Kind::Hair { fibre: self.fibres.guard, meeting: Meeting::new(hair, out, to_eye) },
            colour: strands.tint[crossing.strand as usize].as_dvec3() * ramp.as_dvec3(),
            tangent: hair,
            normal: DVec3::ZERO,
        }
    }

    fn undercoat(
        &self,
        medium: &DMedium<'_>,
        point: &DShellPoint,
        at_m: DVec3,
        to_eye: DVec3,
        random: &mut Stream,
    ) -> Site<'a> {
        let ramp = self.scene.undercoat.map_or(Vec3::ONE, |fibre| fibre.profile.ramp_at(point.t as f32));
        let mean = medium.hair(point);
        let hair = self.slanted(mean, to_eye, random);
        let meeting = Meeting::beside(hair, 2.0 * unit(random) - 1.0, to_eye);
        Site {
            at_m,
            to_eye,
            leaving: None,
            kind: Kind::Hair { fibre: self.fibres.undercoat, meeting },
            colour: medium.vector(&self.scene.fields.tint, point) * ramp.as_dvec3(),
            tangent: mean,
            normal: DVec3::ZERO,
        }
    }

    /// One of the hairs around a mean direction, each met as often as it is wide across the ray.
    fn slanted(&self, mean: DVec3, to_eye: DVec3, random: &mut Stream) -> DVec3 {
        if self.slope <= 0.0 {
            return mean;
        }
        let (x, y) = mean.any_orthonormal_pair();
        // Hairs that are seen end on are seldom met, but some always are.
        for _ in 0..64 {
            let [a, b] = normals([unit(random), unit(random)]);
            let hair = (mean + (x * a + y * b) * self.slope).normalize_or(mean);
            if unit(random) < hair.cross(to_eye).length() {
                return hair;
            }
        }
        mean
    }

    fn skin(&self, point: &DShellPoint, to_eye: DVec3) -> Site<'a> {
        let skin = self.scene.skin;
        let corners = skin.triangles[point.triangle as usize];
        let mean = |values: &[Vec3]| (0..3).map(|i| values[corners[i] as usize].as_dvec3() * point.b[i]).sum::<DVec3>();
        let [a, b, c] = skin.corners_m(point.triangle as usize).map(|p| p.as_dvec3());
        let outside = (b - a).cross(c - a).normalize_or(DVec3::Y);
        let side = if to_eye.dot(outside) < 0.0 { -1.0 } else { 1.0 };
        Site {
            at_m: mean(&skin.positions_m),
            to_eye,
            leaving: None,
            kind: Kind::Skin { face: outside * side },
            colour: mean(&self.scene.fields.tint) * self.scene.skin_factor.as_dvec3(),
            tangent: DVec3::ZERO,
            normal: mean(self.normals).normalize_or(outside) * side,
        }
    }
}

/// Two normal numbers (Box and Muller 1958).
fn normals(random: [f64; 2]) -> [f64; 2] {
    let radius = (-2.0 * libm::log(1.0 - random[0])).sqrt();
    let angle = std::f64::consts::TAU * random[1];
    [radius * libm::cos(angle), radius * libm::sin(angle)]
}
