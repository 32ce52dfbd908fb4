//! Light in undercoat: the key light's shadow, stored by sub-element, and what a step sends to the eye.

use super::volume::Volume;
use super::{Start, Step, Stepping};
use crate::math::Vec3;
use crate::math::fast::exp_negative;
use crate::render::pelt::{Lighting, Pelt, sky_depth, slant_depth, terminator};
use crate::render::shell::block::Block;
use crate::render::shell::prism::Place;
use crate::shade::kajiya_kay::KajiyaKay;
use crate::shade::{Angles, shadow_power};
use std::sync::OnceLock;

/// Optical depth beyond which no light is left.
const DARK: f32 = 6.0;

/// Steps towards the light may be long: what they miss is blurred by the shadow's own resolution.
const TOWARDS_LIGHT: Stepping = Stepping { depth: 1.0, layers: 4.0 };

/// Optical depth of undercoat between each sub-element and the key light, filled prism by prism when first needed.
#[derive(Debug)]
pub struct Shadows {
    to_light: Vec3,
    blocks: Vec<OnceLock<Block>>,
}

impl Shadows {
    /// None filled yet.
    pub fn new(to_light: Vec3, triangles: usize) -> Self {
        Self { to_light, blocks: std::iter::repeat_with(OnceLock::new).take(triangles).collect() }
    }

    /// Bytes filled.
    pub fn bytes(&self) -> usize {
        self.blocks.iter().filter_map(OnceLock::get).map(Block::bytes).sum()
    }

    /// Optical depth towards the light at a place of `volume`'s shell.
    pub fn depth(&self, volume: &Volume<'_>, triangle: u32, b: Vec3, t: f32) -> f32 {
        self.blocks[triangle as usize].get_or_init(|| self.fill(volume, triangle)).between_layers(b, t)
    }

    fn fill(&self, volume: &Volume<'_>, triangle: u32) -> Block {
        let prism = volume.shell().prism(triangle);
        Block::fill(volume.shadow_subdivisions(triangle), volume.layers(), |b| {
            move |t| {
                let place = Place { b: [b.y, b.z], t };
                let origin_m = prism.jacobian(&place).at_m;
                let start = Start { at_m: 0.0, triangle, place };
                volume.depth_along(origin_m, self.to_light, start, &TOWARDS_LIGHT, DARK)
            }
        })
    }
}

/// Shades undercoat. Holds what does not change from step to step.
#[derive(Debug)]
pub struct UndercoatShader<'a> {
    lighting: &'a Lighting,
    scatter: KajiyaKay<f32>,
    albedo_share: f32,
    ramp: [Vec3; 3],
}

impl<'a> UndercoatShader<'a> {
    /// For a pelt's undercoat.
    pub fn new(pelt: &Pelt<'_>, lighting: &'a Lighting) -> Self {
        let hair = &pelt.hair;
        Self {
            lighting,
            scatter: KajiyaKay::new(hair.undercoat_diffuse, hair.undercoat_specular, hair.undercoat_exponent),
            albedo_share: hair.undercoat_diffuse as f32,
            ramp: pelt.undercoat.map_or([Vec3::ONE; 3], |fibre| fibre.profile.ramp),
        }
    }

    /// Colour of the hair at a step and the radiance it sends along −`direction`.
    pub fn look(&self, volume: &Volume<'_>, step: &Step, direction: Vec3) -> (Vec3, Vec3) {
        let (shell, triangle) = (volume.shell(), step.triangle);
        let (b, t) = (step.place.barycentric(), step.place.t);
        let ramp = if t < 0.5 {
            self.ramp[0].lerp(self.ramp[1], 2.0 * t)
        } else {
            self.ramp[1].lerp(self.ramp[2], 2.0 * t - 1.0)
        };
        let albedo = shell.vector(&shell.fields.tint, triangle, b) * ramp;
        let power = (albedo * self.albedo_share).map(shadow_power);
        let through = |depth: f32| (power * -depth).map(exp_negative);
        let [own, above] = volume.above(triangle, b, t);
        let normal = volume.normal(triangle, b);
        let mut radiance = self.lighting.ambient * albedo * self.albedo_share * through(sky_depth(above));

        let key = &self.lighting.key;
        let open = terminator(key.to_light, normal);
        if open > 0.0 {
            let depth = volume.shadows.depth(volume, triangle, b, t)
                + slant_depth(above - own, key.to_light, normal, step.hair);
            let angles = Angles::of_vectors(step.hair, key.to_light, -direction);
            let (tinted, plain) = self.scatter.scatter(angles);
            radiance += key.irradiance * (albedo * tinted + plain) * through(depth) * (angles.cos_in() * open);
        }
        if self.lighting.fill_on_undercoat {
            for light in &self.lighting.fill {
                let open = terminator(light.to_light, normal);
                let angles = Angles::of_vectors(step.hair, light.to_light, -direction);
                let (tinted, plain) = self.scatter.scatter(angles);
                let depth = slant_depth(above, light.to_light, normal, step.hair);
                radiance += light.irradiance * (albedo * tinted + plain) * through(depth) * (angles.cos_in() * open);
            }
        }
        (albedo, radiance)
    }
}
