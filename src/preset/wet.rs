//! Water in fur: what `[wet]` makes of a coat that is described dry.

use super::Preset;
use crate::fur::groom::Shape;
use crate::shade::fibre::Film;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Wet fur. Water draws hair together into locks, as far as the hair's stiffness lets it (Bico, Roman, Moulin and Boudaoud 2004,
/// "Elastocapillary coalescence in wet hair", Nature 432); its weight lays them down; its film keeps light in, which makes hair
/// darker (Ångström 1925), and is smooth, which makes it shine. How far each goes is by eye.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Wet {
    /// How wet: 0 dry, 1 soaked.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub amount: f32,
    /// Mean distance between the middles of soaked locks.
    #[schemars(range(min = 0.1, max = 1e3))]
    pub lock_mm: f32,
    /// Mean lean of soaked hair, where it does not lean more when dry.
    #[schemars(range(min = 0.0, max = 75.0))]
    pub soaked_lean_deg: f32,
    /// How much of the fibre's roughness and of its scales' tilt a whole film takes away.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub gloss: f32,
}

impl Default for Wet {
    fn default() -> Self {
        Self { amount: 0.0, lock_mm: 6.0, soaked_lean_deg: 62.0, gloss: 0.6 }
    }
}

/// Gravity of soaked hair, see [`crate::fur::groom::Groom::gravity`].
const GRAVITY: f32 = 0.4;
/// What is left in a soaked lock of each hair's own jitter and of its bend.
const LEFT: f32 = 0.3;

impl Wet {
    /// The water on each hair.
    pub fn film(&self) -> Film {
        Film { amount: self.amount, gloss: self.gloss }
    }

    fn shape(&self, dry: Shape) -> Shape {
        let towards = |dry: f32, soaked: f32| dry + self.amount * (soaked - dry);
        let mut wet = dry;
        wet.clump.strength = towards(dry.clump.strength, 1.0);
        wet.clump.spacing_mm = towards(dry.clump.spacing_mm, self.lock_mm);
        wet.jitter_deg = towards(dry.jitter_deg, LEFT * dry.jitter_deg);
        wet.bend_deg = towards(dry.bend_deg, LEFT * dry.bend_deg);
        wet.noise = towards(dry.noise, 0.0);
        wet
    }
}

impl Preset {
    /// The preset whose hair is shaped and laid as the wet hair of this one; what light finds on it is told by [`Wet::film`]. Dry, it is the same.
    pub fn wetted(&self) -> Self {
        let wet = &self.wet;
        let mut preset = self.clone();
        if wet.amount == 0.0 {
            return preset;
        }
        let towards = |dry: f32, soaked: f32| dry + wet.amount * (soaked - dry);
        preset.guard.shape = wet.shape(self.guard.shape);
        preset.undercoat.shape = wet.shape(self.undercoat.shape);
        // A lock ends in a point that lets nothing through.
        preset.guard.tip_transparency = towards(self.guard.tip_transparency, 0.0);
        let groom = &mut preset.groom;
        groom.lean_deg = towards(groom.lean_deg, groom.lean_deg.max(wet.soaked_lean_deg));
        groom.gravity = towards(groom.gravity, groom.gravity.max(GRAVITY));
        preset.colour.skin = self.colour.skin.map(|factor| wet.film().darkened(factor));
        preset
    }
}
