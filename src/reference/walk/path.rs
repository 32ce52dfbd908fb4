//! One path from the eye through fur to light.

use super::Bounces;
use super::site::{Site, Sites};
use super::space::{Scratch, Space, unit};
use crate::math::DVec3;
use crate::math::hash::Stream;
use crate::reference::bvh::DRay;
use crate::reference::light::Arriving;
use crate::reference::sum::luminance;
use crate::volume::scene::Lighting;

/// Scatterings from which on a path goes on as often as light is left on it.
const SURE: u32 = 3;

/// How often a path goes on at most: between mirrors and white walls it ends some day.
const MOST: f64 = 0.9995;

/// Follows paths.
pub struct Walker<'a> {
    /// What they lead through.
    pub space: Space<'a>,
    /// What they meet.
    pub sites: Sites<'a>,
    /// The lights.
    pub lighting: &'a Lighting,
    /// How many scatterings are followed.
    pub bounces: Bounces,
}

impl<'a> Walker<'a> {
    /// What is seen along a ray from the eye: how far, m, and the place; none where it leaves the scene.
    pub fn first(
        &self,
        ray: &DRay,
        random: &mut Stream,
        scratch: &mut Scratch,
    ) -> Option<(f64, super::space::Met, Site<'a>)> {
        let (at_m, met) = self.space.next(ray, None, random, scratch)?;
        let site = self.sites.site(&self.space, ray, at_m, &met, random)?;
        Some((at_m, met, site))
    }

    /// One guess, right in the mean, at the radiance that a site sends to the eye.
    pub fn radiance(&self, mut site: Site<'a>, random: &mut Stream, scratch: &mut Scratch) -> DVec3 {
        let ambient = self.lighting.ambient.as_dvec3();
        let (mut sum, mut through) = (DVec3::ZERO, DVec3::ONE);
        for scatterings in 1_u32.. {
            sum += through * self.lit(&site, scatterings == 1, random);
            let (direction, density) = site.sample(random);
            if density.is_nan() || density <= 0.0 {
                break;
            }
            through *= site.scatter(direction) / density;
            if scatterings >= SURE {
                let goes_on = through.max_element().min(MOST);
                if unit(random) >= goes_on {
                    break;
                }
                through /= goes_on;
            }
            let last = self.bounces.end_at(scatterings);
            if through == DVec3::ZERO || last && ambient == DVec3::ZERO {
                break;
            }
            let ray = site.ray(direction);
            let Some((at_m, met)) = self.space.next(&ray, site.leaving(), random, scratch) else {
                sum += through * ambient;
                break;
            };
            if last {
                break;
            }
            let Some(next) = self.sites.site(&self.space, &ray, at_m, &met, random) else { break };
            site = next;
        }
        sum
    }

    /// What a site sends to the eye of light that comes straight from lights: from all, or from one that stands for all.
    fn lit(&self, site: &Site<'_>, all: bool, random: &mut Stream) -> DVec3 {
        let arriving = || self.lighting.all().map(|light| Arriving::new(light, site.at_m()));
        if all || self.lighting.fill.is_empty() {
            return arriving().map(|light| self.lit_by(site, &light)).sum();
        }
        let bright = |light: &Arriving| luminance(light.irradiance);
        let total: f64 = arriving().map(|light| bright(&light)).sum();
        let mut left = unit(random) * total;
        for light in arriving() {
            let share = bright(&light);
            if left < share {
                return self.lit_by(site, &light) * (total / share);
            }
            left -= share;
        }
        DVec3::ZERO
    }

    fn lit_by(&self, site: &Site<'_>, light: &Arriving) -> DVec3 {
        let to_light = light.to_light.normalize();
        let sent = light.irradiance * site.scatter(to_light);
        if sent == DVec3::ZERO {
            return sent;
        }
        sent * self.space.open(&site.ray(to_light), light.distance_m, site.leaving())
    }
}
