//! Light in undercoat: the key light's shadow, stored by sub-element, and what a step sends to the eye.

use super::columns::{Columns, Site};
use super::prisms::Prisms;
use super::volume::{OTHER_NS, Volume};
use super::{Journey, Start, Stepping, Steps};
use crate::math::Vec3;
use crate::math::lanes::{F32s, Isa, Vec3s};
use crate::render::mean::MeanShadow;
use crate::render::pelt::{Lighting, Pelt, ramps, sky_depths, slant_depths, terminators, through};
use crate::render::shell::lattice::{self, Lattice};
use crate::render::shell::prism::Place;
use crate::render::shell::{Shell, block};
use crate::shade::kajiya_kay::KajiyaKay;
use crate::shade::light::Directional;
use crate::shade::{Angles, shadow_power};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// Optical depth beyond which no light is left.
const DARK: f32 = 8.0;

/// The same beside an open border: what is seen there lies between the border, where there is no shadow, and the next
/// stored depth, which must not be cut short.
const DARK_AT_BORDERS: f32 = 15.0;

/// Steps towards the light. Long ones miss the beginnings of clumps that they step into: by those of four layers, a depth of
/// one, undercoat was 6 % too bright.
const TOWARDS_LIGHT: Stepping = Stepping { depth: 0.5, layers: 0.5 };

/// How much longer they become with each optical depth passed: what lies in deep shadow has little light to be wrong about.
const HASTE: f32 = 0.25;

/// Optical depth of undercoat, and of guard hair in the mean, between the corners of sub-elements and the key light, filled
/// prism by prism when first needed.
#[derive(Debug)]
pub struct Shadows {
    to_light: Vec3,
    lattices: Vec<OnceLock<Lattice>>,
    columns: Columns,
    /// Time spent filling, summed over threads, ns.
    pub(super) spent_ns: AtomicU64,
}

impl Shadows {
    /// None filled yet.
    pub fn new(to_light: Vec3, shell: &Shell<'_>) -> Self {
        let lattices = std::iter::repeat_with(OnceLock::new).take(shell.skin.triangles.len()).collect();
        Self { to_light, lattices, columns: Columns::new(shell), spent_ns: AtomicU64::new(0) }
    }

    /// Bytes filled.
    pub fn bytes(&self) -> usize {
        self.lattices.iter().filter_map(OnceLock::get).map(Lattice::bytes).sum()
    }

    /// Optical depths towards the light in a prism of `volume`, whose pelt `mean` is of.
    #[inline]
    pub fn lattice(&self, volume: &Volume<'_>, mean: Option<&MeanShadow<'_>>, triangle: u32) -> &Lattice {
        let cell = &self.lattices[triangle as usize];
        if let Some(lattice) = cell.get() {
            return lattice;
        }
        cell.get_or_init(|| {
            let (start, before_ns) = (Instant::now(), OTHER_NS.get());
            let lattice = self.fill(volume, mean, triangle);
            let other_ns = OTHER_NS.get() - before_ns;
            self.spent_ns.fetch_add((start.elapsed().as_nanos() as u64).saturating_sub(other_ns), Ordering::Relaxed);
            lattice
        })
    }

    fn fill(&self, volume: &Volume<'_>, mean: Option<&MeanShadow<'_>>, triangle: u32) -> Lattice {
        let shell = volume.shell();
        let (d, last) = (volume.shadow_subdivisions(triangle), volume.layers());
        let levels = last as usize + 1;
        let sites: Vec<Site<'_>> = lattice::places(d).map(|b| self.columns.site(shell, triangle, b)).collect();
        let waiting: Vec<usize> = (0..sites.len()).filter(|&i| sites[i].stored().is_none()).collect();
        let t_of = |level: usize| level as f32 / last as f32;
        let journey = |site: &Site<'_>, level: usize| {
            let place = Place { b: [site.b.y, site.b.z], t: t_of(level) };
            let start = Start { at_m: 0.0, triangle: site.triangle, place };
            let origin_m = shell.prism(site.triangle).jacobian(&place).at_m;
            Journey { origin_m, direction: self.to_light, start, far_m: f32::INFINITY }
        };
        let journeys: Vec<Journey> = (0..levels)
            .flat_map(|level| waiting.iter().map(move |&i| (i, level)))
            .map(|(i, level)| journey(&sites[i], level))
            .collect();
        let enough = if shell.neighbours.at_border(triangle) { DARK_AT_BORDERS } else { DARK };
        let depths = volume.depths_along(&journeys, &TOWARDS_LIGHT, HASTE, enough);
        let mut codes = vec![0; sites.len() * levels];
        for (site, codes) in sites.iter().zip(codes.chunks_exact_mut(levels)) {
            if let Some(stored) = site.stored() {
                codes.copy_from_slice(stored);
            }
        }
        for (k, &i) in waiting.iter().enumerate() {
            let (site, codes) = (&sites[i], &mut codes[i * levels..][..levels]);
            for (level, code) in codes.iter_mut().enumerate() {
                let other = mean.map_or(0.0, |mean| mean.other_depth(site.triangle, site.b, t_of(level)));
                *code = block::code(depths[level * waiting.len() + k] + other);
            }
            if let Some(cell) = site.shared {
                // Whoever was first has found the same.
                let _ = cell.set((&*codes).into());
            }
        }
        Lattice::of_codes(d, codes)
    }
}

/// Shades undercoat. Holds what does not change from step to step.
#[derive(Debug)]
pub struct UndercoatShader<'a> {
    lighting: &'a Lighting,
    /// The key light's shadow in the mean.
    pub mean: Option<&'a MeanShadow<'a>>,
    scatter: KajiyaKay<f32>,
    albedo_share: f32,
    ramp: [Vec3; 3],
}

impl<'a> UndercoatShader<'a> {
    /// For a pelt's undercoat.
    pub fn new(pelt: &Pelt<'_>, lighting: &'a Lighting, mean: Option<&'a MeanShadow<'a>>) -> Self {
        let hair = &pelt.hair;
        Self {
            lighting,
            mean,
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
        let above = volume.above(prisms, steps);
        let normal = prisms.normal(steps.b);
        let mut radiance = share.times(Vec3s::splat(self.lighting.ambient)).times(through(power, sky_depths(above)));
        let spot = Spot { albedo, power, normal, hair: steps.hair, to_eye: steps.direction * F32s::splat(-1.0) };
        radiance = radiance + self.lit(&spot, &self.lighting.key, shadow);
        if self.lighting.fill_on_undercoat {
            for light in &self.lighting.fill {
                let depth = slant_depths(above, Vec3s::splat(light.to_light), normal, steps.hair);
                radiance = radiance + self.lit(&spot, light, depth);
            }
        }
        (albedo, radiance)
    }

    /// What a light gives through an optical depth.
    #[inline(always)]
    fn lit<I: Isa>(&self, spot: &Spot<I>, light: &Directional, depth: F32s<I>) -> Vec3s<I> {
        let to_light = Vec3s::splat(light.to_light);
        let open = terminators(to_light, spot.normal);
        let angles = Angles::of_lanes(spot.hair, to_light, spot.to_eye);
        let (tinted, plain) = self.scatter.map(F32s::splat).scatter(angles);
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
