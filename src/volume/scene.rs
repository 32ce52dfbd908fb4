//! What a picture shows: skin with its hair, and how much hair lies over a point of it.

use crate::data::fields::Fields;
use crate::data::light::{Directional, Light};
use crate::data::mesh::Mesh;
use crate::data::strands::Strands;
use crate::error::Result;
use crate::fur::groom::fibre::{Fibre, LENGTH_SPREAD};
use crate::math::Vec3;
use crate::math::lanes::{F32s, Isa, Vec3s};
use crate::math::table::Table;
use crate::shade::fibre::{FibreModel, FibreParameters, Fibres, Film};
use crate::shade::law::known::{self, Scattering};
use crate::stage::light::Lit;
use std::sync::LazyLock;

/// Skin and hair of a picture.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    /// The skin.
    pub skin: &'a Mesh,
    /// What varies over it.
    pub fields: &'a Fields,
    /// Factor on the fields' tint for the skin under the hair.
    pub skin_factor: Vec3,
    /// Guard hairs as grown, and what they were grown from.
    pub guard: Option<(&'a Strands, &'a Fibre)>,
    /// Undercoat, as a volume.
    pub undercoat: Option<&'a Fibre>,
    /// How hairs scatter.
    pub scattering: &'a HairScattering,
}

/// How both kinds of hair scatter light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HairScattering {
    /// Guard hair.
    pub guard: Scattering,
    /// Undercoat.
    pub undercoat: Scattering,
}

impl HairScattering {
    /// That of no hair, for what is asked of its opacity alone.
    pub fn none() -> &'static Self {
        static NONE: LazyLock<HairScattering> = LazyLock::new(HairScattering::default);
        &NONE
    }

    /// Of a preset's fibres under a film of water; those that do not come with the program are solved.
    ///
    /// # Errors
    /// As [`known::scattering`].
    pub fn new(fibres: &Fibres, film: &Film) -> Result<Self> {
        Self::each(fibres, film, known::scattering)
    }

    /// The same at once, for pictures that a better one follows: where a fibre does not come with the program, only what is scattered once
    /// is its own; the rest is that of the nearest fibre which does.
    ///
    /// # Errors
    /// As [`known::nearest`].
    pub fn draft(fibres: &Fibres, film: &Film) -> Result<Self> {
        Self::each(fibres, film, known::nearest)
    }

    fn each(
        fibres: &Fibres,
        film: &Film,
        find: fn(FibreModel, &FibreParameters) -> Result<Scattering>,
    ) -> Result<Self> {
        let of = |dry| find(fibres.model, dry).map(|found| found.wet(film, fibres.model, dry));
        Ok(Self { guard: of(&fibres.guard)?, undercoat: of(&fibres.undercoat)? })
    }
}

/// The lights of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Lighting {
    /// The light whose shadow is followed through the undercoat.
    pub key: Light,
    /// Further lights, shadowed by the hair right above each point; the environment's, as a rule.
    pub fill: Vec<Light>,
    /// Radiance from everywhere, linear RGB.
    pub ambient: Vec3,
    /// Whether the further lights fall on undercoat too (Andersen et al. 2016 §5 leave them out).
    pub fill_on_undercoat: bool,
}

impl Lighting {
    /// The first light is the key; without any it is dark.
    pub fn new(lit: &Lit) -> Self {
        let mut lights = lit.lights.iter().copied();
        let dark = Directional { to_light: Vec3::Y, irradiance: Vec3::ZERO };
        Self {
            key: lights.next().unwrap_or(dark.into()),
            fill: lights.collect(),
            ambient: lit.ambient,
            fill_on_undercoat: lit.fill_on_undercoat,
        }
    }
}

/// Hair area above heights per skin area, of both kinds, as flat skin carries them: what is left of each hair above, as wide and
/// as opaque as it is there.
#[derive(Clone, Debug, PartialEq)]
pub struct Above {
    /// Height that no hair exceeds where the length field is 1, m along the lean.
    pub top_m: f32,
    table: Table,
}

impl Above {
    /// Of guard hair and undercoat.
    pub fn new(kinds: [Option<&Fibre>; 2]) -> Self {
        let top_m = kinds.iter().flatten().map(|fibre| fibre.height_m()).fold(f32::MIN_POSITIVE, f32::max);
        let kinds: Vec<Kind> = kinds.into_iter().flatten().map(Kind::new).collect();
        Self { top_m, table: Table::new(|share| kinds.iter().map(|kind| kind.above(share * top_m)).sum()) }
    }

    /// At heights from the skin to `top_m` in even steps, where the fields are 1.
    pub fn values(&self) -> &[f32] {
        self.table.values()
    }

    /// Above a height, m along the lean, where the fields say `density` and `length`.
    pub fn at(&self, height_m: f32, density: f32, length: f32) -> f32 {
        density * length * self.table.at(height_m / (self.top_m * length).max(f32::MIN_POSITIVE))
    }

    /// [`Self::at`] in lanes.
    #[inline(always)]
    pub fn at_lanes<I: Isa>(&self, height_m: F32s<I>, density: f32, length: f32) -> F32s<I> {
        let share = height_m * (1.0 / (self.top_m * length).max(f32::MIN_POSITIVE));
        self.table.at_lanes(share) * (density * length)
    }
}

/// A kind of hair, as [`Above`] adds it up.
struct Kind {
    density_per_m2: f32,
    length_m: f32,
    /// Height over length along the hair.
    rise: f32,
    variation: f32,
    /// ∫ of a hair's opaque width from s to the tip, m, for s in even steps.
    left_m: [f32; STEPS + 1],
}

/// Steps along a hair, and over the lengths of hairs.
const STEPS: usize = 64;

impl Kind {
    fn new(fibre: &Fibre) -> Self {
        let width_m = |s: f32| 2.0 * fibre.radius_m * fibre.profile.radius_factor(s) * fibre.profile.opacity_at(s);
        let mut left_m = [0.0; STEPS + 1];
        for i in (0..STEPS).rev() {
            left_m[i] = left_m[i + 1] + width_m((i as f32 + 0.5) / STEPS as f32) / STEPS as f32;
        }
        Self {
            density_per_m2: fibre.density_per_m2,
            length_m: fibre.length_m,
            rise: (fibre.height_m() / fibre.longest_m().max(f32::MIN_POSITIVE)).max(1e-3),
            variation: fibre.shape.length_variation,
            left_m,
        }
    }

    /// Over lengths of normal distribution; those beyond the longest and shortest hairs count there.
    fn above(&self, height_m: f32) -> f32 {
        let of = |z: f32| {
            let length_m = self.length_m * (1.0 + z * self.variation);
            let at = (height_m / (length_m * self.rise).max(f32::MIN_POSITIVE) * STEPS as f32).clamp(0.0, STEPS as f32);
            let low = (at as usize).min(STEPS - 1);
            length_m * (self.left_m[low] + (at - low as f32) * (self.left_m[low + 1] - self.left_m[low]))
        };
        let step = 2.0 * LENGTH_SPREAD / STEPS as f32;
        let beyond = 0.5 * libm::erfcf(LENGTH_SPREAD * std::f32::consts::FRAC_1_SQRT_2);
        let ends = beyond * (of(-LENGTH_SPREAD) + of(LENGTH_SPREAD));
        let within = (0..STEPS).map(|i| {
            let z = -LENGTH_SPREAD + (i as f32 + 0.5) * step;
            0.398_942_3 * libm::expf(-0.5 * z * z) * step * of(z)
        });
        self.density_per_m2 * (ends + within.sum::<f32>())
    }
}

/// Hair area per volume times diameter, on skin where the fields are 1: how much of a hair's light and shadow are its neighbours'.
pub fn crowding(fibre: &Fibre) -> f32 {
    let mean_diameter_m = fibre.radius_m * (1.0 + fibre.profile.taper);
    let rise = (fibre.height_m() / fibre.longest_m().max(f32::MIN_POSITIVE)).max(1e-3);
    fibre.density_per_m2 * mean_diameter_m * mean_diameter_m / rise
}

/// Optical depth from hair area `above` per skin area towards `to_light`, hair along `lean`: a flat layer crossed on a
/// slant. Lights below the horizon count as on it; what the body hides is [`terminator`]'s part.
pub fn slant_depth(above: f32, to_light: Vec3, normal: Vec3, lean: Vec3) -> f32 {
    let along = to_light.dot(lean);
    (above * (1.0 - along * along).max(0.0).sqrt() / to_light.dot(normal).max(HORIZON)).min(DEEPEST_HAIR)
}

/// Greatest optical depth of a flat layer: hair deeper than this is hidden as well as it is dark; where it is seen all the
/// same, at a border or in a parting, light finds the way that the eye found.
pub const DEEPEST_HAIR: f32 = 2.5;

/// [`slant_depth`] in lanes.
#[inline(always)]
pub fn slant_depths<I: Isa>(above: F32s<I>, to_light: Vec3s<I>, normal: Vec3s<I>, lean: Vec3s<I>) -> F32s<I> {
    let along = to_light.dot(lean);
    let sine = (F32s::splat(1.0) - along * along).max(F32s::splat(0.0)).sqrt();
    (above * sine / to_light.dot(normal).max(F32s::splat(HORIZON))).min(F32s::splat(DEEPEST_HAIR))
}

/// [`terminator`] in lanes.
#[inline(always)]
pub fn terminators<I: Isa>(to_light: Vec3s<I>, normal: Vec3s<I>) -> F32s<I> {
    let x = ((to_light.dot(normal) + 0.35) * (1.0 / 0.35)).within(0.0, 1.0);
    x * x * (F32s::splat(3.0) - x * 2.0)
}

/// Colours at root, middle and tip, linear in between, where s ∈ [0, 1] goes along the hair.
#[inline(always)]
pub fn ramps<I: Isa>(ramp: &[Vec3; 3], s: F32s<I>) -> Vec3s<I> {
    let [root, middle, tip] = [Vec3s::splat(ramp[0]), Vec3s::splat(ramp[1]), Vec3s::splat(ramp[2])];
    let (one, twice) = (F32s::splat(1.0), s * 2.0);
    let lower = root + (middle - root) * twice;
    let upper = middle + (tip - middle) * (twice - one);
    lower.select(twice.lt(one), upper)
}

/// Least cosine between normal and light for which hair shadows as a flat layer.
pub const HORIZON: f32 = 0.08;

/// Share of a light that the body itself lets pass to hair above skin with this normal: hair stands out of the skin's
/// shadow a little past the horizon.
pub fn terminator(to_light: Vec3, normal: Vec3) -> f32 {
    let x = ((to_light.dot(normal) + 0.35) / 0.35).clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

/// Optical depth towards the whole sky under hair area `above`: exp(−1.5 τ) stands in for the mean of exp(−τ/cos θ) over
/// the hemisphere (2 E₃(τ), within 0.05), with the mean sine π/4 between hair and light.
pub fn sky_depth(above: f32) -> f32 {
    (1.5 * std::f32::consts::FRAC_PI_4 * above).min(DEEPEST_HAIR)
}
