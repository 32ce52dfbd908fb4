//! What undercoat sends to the eye.

use crate::math::Vec3;
use crate::math::lanes::{F32s, Isa, Vec3s};
use crate::shade::Angles;
use crate::shade::law::light::WornColour;
use crate::shade::law::{Place, Scattering};
use crate::volume::march::MarchSteps;
use crate::volume::march::content::Content;
use crate::volume::scene::{self, Lighting, Scene, ramps, slant_depths, terminators};
use crate::volume::shell::prisms::Prisms;

/// Shades undercoat. Holds what does not change from step to step.
#[derive(Debug)]
pub struct UndercoatShader<'a> {
    lighting: &'a Lighting,
    eye_m: Vec3,
    hair: &'a Scattering,
    ramp: [Vec3; 3],
    /// Hair area per volume times diameter, where the fields are 1.
    crowding: f32,
}

impl<'a> UndercoatShader<'a> {
    /// For a scene's undercoat, seen from `eye_m`.
    pub fn new(scene: &Scene<'a>, lighting: &'a Lighting, eye_m: Vec3) -> Self {
        Self {
            lighting,
            eye_m,
            hair: &scene.scattering.undercoat,
            ramp: scene.undercoat.map_or([Vec3::ONE; 3], |fibre| fibre.profile.ramp),
            crowding: scene.undercoat.map_or(0.0, scene::crowding),
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
        let worn = self.hair.wear([albedo.x, albedo.y, albedo.z]);
        let above = content.above(prisms, steps);
        let normal = prisms.normal(steps.b);
        let to_eye = steps.direction * F32s::splat(-1.0);
        let normals = [steps.hair.dot(normal), to_eye.dot(normal)];
        let crowding = F32s::splat(self.crowding);
        let middle_m = Vec3s::splat(self.eye_m) + steps.direction * (steps.from_m + steps.length_m * 0.5);
        let site = UndercoatSite { worn, normal, normals, hair: steps.hair, to_eye, above, crowding };
        let (to_light, irradiance) = self.lighting.key.at_lanes(middle_m);
        let mut radiance = self.lit(&site, to_light, shadow).times(irradiance);
        if self.lighting.fill_on_undercoat {
            for light in &self.lighting.fill {
                let (to_light, irradiance) = light.at_lanes(middle_m);
                let depth = slant_depths(above, to_light, normal, steps.hair);
                let open = terminators(to_light, normal);
                radiance = radiance + self.lit(&site, to_light, depth).times(irradiance * open);
            }
        }
        if self.lighting.ambient != Vec3::ZERO {
            let angles = Angles::of_lanes(steps.hair, normal, to_eye);
            let place = Place::new(angles, normals[1], above, above, [normals[0], normals[1], normals[1]]);
            let [x, y, z] = self.hair.sky(&place, &site.worn, crowding);
            radiance = radiance + Vec3s::new(x, y, z).times(Vec3s::splat(self.lighting.ambient));
        }
        (albedo, radiance)
    }

    /// What hair sends to the eye of an irradiance of 1 from `to_light`, through an optical depth.
    #[inline(always)]
    fn lit<I: Isa>(&self, site: &UndercoatSite<I>, to_light: Vec3s<I>, depth: F32s<I>) -> Vec3s<I> {
        let angles = Angles::of_lanes(site.hair, to_light, site.to_eye);
        let normals = [site.normals[0], site.normals[1], to_light.dot(site.normal)];
        let place = Place::new(angles, to_light.dot(site.to_eye), site.above, depth, normals);
        let [x, y, z] = self.hair.light(angles, &place, &site.worn, site.crowding);
        Vec3s::new(x, y, z)
    }
}

/// Undercoat to be lit.
struct UndercoatSite<I: Isa> {
    worn: WornColour<F32s<I>>,
    normal: Vec3s<I>,
    /// Cosines of hair and eye to it.
    normals: [F32s<I>; 2],
    hair: Vec3s<I>,
    to_eye: Vec3s<I>,
    /// Hair area above per skin area.
    above: F32s<I>,
    crowding: F32s<I>,
}
