//! Light in undercoat: the key light's shadow, stored by sub-element, and what a step sends to the eye.

use super::prisms::Prisms;
use super::volume::{DENSITY_NS, Volume};
use super::{Journey, Start, Stepping, Steps};
use crate::math::Vec3;
use crate::math::lanes::{F32s, Isa, Vec3s};
use crate::render::pelt::{Lighting, Pelt, ramps, sky_depths, slant_depths, terminators, through};
use crate::render::shell::block::Block;
use crate::render::shell::prism::Place;
use crate::render::shell::subelement;
use crate::shade::kajiya_kay::KajiyaKay;
use crate::shade::light::Directional;
use crate::shade::{Angles, shadow_power};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// Optical depth beyond which no light is left.
const DARK: f32 = 6.0;

/// Steps towards the light may be long: what they miss is blurred by the shadow's own resolution.
const TOWARDS_LIGHT: Stepping = Stepping { depth: 1.0, layers: 4.0 };

/// Optical depth of undercoat between each sub-element and the key light, filled prism by prism when first needed.
#[derive(Debug)]
pub struct Shadows {
    to_light: Vec3,
    blocks: Vec<OnceLock<Block>>,
    /// Time spent filling, summed over threads, ns.
    pub(super) spent_ns: AtomicU64,
}

impl Shadows {
    /// None filled yet.
    pub fn new(to_light: Vec3, triangles: usize) -> Self {
        let blocks = std::iter::repeat_with(OnceLock::new).take(triangles).collect();
        Self { to_light, blocks, spent_ns: AtomicU64::new(0) }
    }

    /// Bytes filled.
    pub fn bytes(&self) -> usize {
        self.blocks.iter().filter_map(OnceLock::get).map(Block::bytes).sum()
    }

    /// Optical depths towards the light in the sub-elements of a prism of `volume`.
    #[inline]
    pub fn block(&self, volume: &Volume<'_>, triangle: u32) -> &Block {
        let cell = &self.blocks[triangle as usize];
        if let Some(block) = cell.get() {
            return block;
        }
        cell.get_or_init(|| {
            let (start, density_ns) = (Instant::now(), DENSITY_NS.get());
            let block = self.fill(volume, triangle);
            let other_ns = DENSITY_NS.get() - density_ns;
            self.spent_ns.fetch_add((start.elapsed().as_nanos() as u64).saturating_sub(other_ns), Ordering::Relaxed);
            block
        })
    }

    fn fill(&self, volume: &Volume<'_>, triangle: u32) -> Block {
        let prism = volume.shell().prism(triangle);
        let (d, layers) = (volume.shadow_subdivisions(triangle), volume.layers());
        let journey = |i: u32| {
            let b = subelement::centre(i & ((1 << (2 * d)) - 1), d);
            let place = Place { b: [b.y, b.z], t: ((i >> (2 * d)) as f32 + 0.5) / layers as f32 };
            let start = Start { at_m: 0.0, triangle, place };
            Journey { origin_m: prism.jacobian(&place).at_m, direction: self.to_light, start, far_m: f32::INFINITY }
        };
        let journeys: Vec<Journey> = (0..layers << (2 * d)).map(journey).collect();
        Block::new(d, layers, &volume.depths_along(&journeys, &TOWARDS_LIGHT, DARK))
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

    /// Colours of the hair at steps and the radiance they send back along the rays. `shadow` holds the key light's
    /// optical depth.
    #[inline(always)]
    pub fn look<I: Isa>(
        &self,
        volume: &Volume<'_>,
        prisms: &Prisms,
        steps: &Steps<I>,
        shadow: F32s<I>,
    ) -> (Vec3s<I>, Vec3s<I>) {
        let albedo = prisms.tint(steps.b).times(ramps(&self.ramp, steps.t));
        let share = albedo * F32s::splat(self.albedo_share);
        let power = Vec3s::new(shadow_power(share.x), shadow_power(share.y), shadow_power(share.z));
        let [own, above] = volume.above(prisms, steps);
        let normal = prisms.normal(steps.b);
        let mut radiance = share.times(Vec3s::splat(self.lighting.ambient)).times(through(power, sky_depths(above)));
        let spot = Spot { albedo, power, normal, hair: steps.hair, to_eye: steps.direction * F32s::splat(-1.0) };
        radiance = radiance + self.lit(&spot, &self.lighting.key, above - own, shadow);
        if self.lighting.fill_on_undercoat {
            for light in &self.lighting.fill {
                radiance = radiance + self.lit(&spot, light, above, F32s::splat(0.0));
            }
        }
        (albedo, radiance)
    }

    /// What a light gives, shadowed by a layer of hair area `above` and a known depth.
    #[inline(always)]
    fn lit<I: Isa>(&self, spot: &Spot<I>, light: &Directional, above: F32s<I>, depth: F32s<I>) -> Vec3s<I> {
        let to_light = Vec3s::splat(light.to_light);
        let open = terminators(to_light, spot.normal);
        let angles = Angles::of_lanes(spot.hair, to_light, spot.to_eye);
        let (tinted, plain) = self.scatter.map(F32s::splat).scatter(angles);
        let depth = depth + slant_depths(above, to_light, spot.normal, spot.hair);
        let irradiance = Vec3s::splat(light.irradiance) * (angles.cos_in() * open);
        (spot.albedo * tinted).plus(plain).times(through(spot.power, depth)).times(irradiance)
    }
}

/// Undercoat to be lit.
struct Spot<I: Isa> {
    albedo: Vec3s<I>,
    power: Vec3s<I>,
    normal: Vec3s<I>,
    hair: Vec3s<I>,
    to_eye: Vec3s<I>,
}
