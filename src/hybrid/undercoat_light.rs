//! What undercoat sends to the eye.

use crate::math::Vec3;
use crate::math::lanes::{F32s, Isa, Vec3s};
use crate::shade::kajiya_kay::KajiyaKay;
use crate::shade::{Angles, shadow_power};
use crate::volume::march::MarchSteps;
use crate::volume::march::content::Content;
use crate::volume::scene::{Lighting, Scene, ramps, sky_depths, slant_depths, terminators, through};
use crate::volume::shell::prisms::Prisms;

/// Shades undercoat. Holds what does not change from step to step.
#[derive(Debug)]
pub struct UndercoatShader<'a> {
    lighting: &'a Lighting,
    eye_m: Vec3,
    scatter: KajiyaKay<f32>,
    albedo_share: f32,
    ramp: [Vec3; 3],
}

impl<'a> UndercoatShader<'a> {
    /// For a scene's undercoat, seen from `eye_m`.
    pub fn new(scene: &Scene<'_>, lighting: &'a Lighting, eye_m: Vec3) -> Self {
        let hair = &scene.scattering;
        Self {
            lighting,
            eye_m,
            scatter: KajiyaKay::new(hair.undercoat_diffuse, hair.undercoat_specular, hair.undercoat_exponent),
            albedo_share: hair.undercoat_diffuse as f32,
            ramp: scene.undercoat.map_or([Vec3::ONE; 3], |fibre| fibre.profile.ramp),
        }
    }

    /// Colours of the hair at steps and the radiance they send back along the rays. `shadow` holds the key light's
    /// optical depth.
    #[inline(always)]
    pub fn shade<I: Isa>(
        &self,
        content: &Content<'_>,
        prisms: &Prisms,
        steps: &MarchSteps<I>,
        shadow: F32s<I>,
    ) -> (Vec3s<I>, Vec3s<I>) {
        let albedo = prisms.tint(steps.b).times(ramps(&self.ramp, steps.t));
        let share = albedo * F32s::splat(self.albedo_share);
        let power = Vec3s::new(shadow_power(share.x), shadow_power(share.y), shadow_power(share.z));
        let above = content.above(prisms, steps);
        let normal = prisms.normal(steps.b);
        let mut radiance = share.times(Vec3s::splat(self.lighting.ambient)).times(through(power, sky_depths(above)));
        let site =
            UndercoatSite { albedo, power, normal, hair: steps.hair, to_eye: steps.direction * F32s::splat(-1.0) };
        let middle_m = Vec3s::splat(self.eye_m) + steps.direction * (steps.from_m + steps.length_m * 0.5);
        radiance = radiance + self.lit(&site, self.lighting.key.at_lanes(middle_m), shadow);
        if self.lighting.fill_on_undercoat {
            for light in &self.lighting.fill {
                let arriving = light.at_lanes(middle_m);
                let depth = slant_depths(above, arriving.0, normal, steps.hair);
                radiance = radiance + self.lit(&site, arriving, depth);
            }
        }
        (albedo, radiance)
    }

    /// What a light gives through an optical depth.
    #[inline(always)]
    fn lit<I: Isa>(
        &self,
        site: &UndercoatSite<I>,
        (to_light, irradiance): (Vec3s<I>, Vec3s<I>),
        depth: F32s<I>,
    ) -> Vec3s<I> {
        let open = terminators(to_light, site.normal);
        let angles = Angles::of_lanes(site.hair, to_light, site.to_eye);
        let (tinted, plain) = self.scatter.map(F32s::splat).scatter(angles);
        let irradiance = irradiance * (angles.cos_in() * open);
        (site.albedo * tinted).plus(plain).times(through(site.power, depth)).times(irradiance)
    }
}

/// Undercoat to be lit.
struct UndercoatSite<I: Isa> {
    albedo: Vec3s<I>,
    power: Vec3s<I>,
    normal: Vec3s<I>,
    hair: Vec3s<I>,
    to_eye: Vec3s<I>,
}
