//! The parameters of a coat's hair. One definition serves presets, defaults and help.

pub mod clump;
mod comb;
pub mod fibre;
pub mod fields;
pub mod hair;
pub mod lean;
pub mod maps;
pub mod parted;
pub mod refine;
pub mod unfold;

use crate::math::Vec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use comb::{Comb, Line, Parting, Place, Stroke, Whorl};

/// A length in a preset.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase", deny_unknown_fields)]
pub enum Length {
    /// Millimetres on the animal described.
    Mm(f32),
    /// Share of the bounding diagonal of what is furred.
    Relative(f32),
}

impl Length {
    /// In metres, where what is furred has the bounding diagonal `diagonal_m`.
    pub fn metres(self, diagonal_m: f32) -> f32 {
        match self {
            Self::Mm(mm) => mm * 1e-3,
            Self::Relative(share) => share * diagonal_m,
        }
    }
}

/// Helical curl: the hair winds around its own axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Curl {
    /// Radius of the helix, mm, 0 for straight hair.
    #[schemars(range(min = 0.0, max = 1e3))]
    pub radius_mm: f32,
    /// Windings from root to tip.
    #[schemars(range(min = 0.0, max = 20.0))]
    pub turns: f32,
}

/// Hairs that lean together into cones.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Clump {
    /// Mean distance between clump centres, mm.
    #[schemars(range(min = 1e-2, max = 1e3))]
    pub spacing_mm: f32,
    /// How far tips move towards their clump's centre.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub strength: f32,
}

/// How one kind of hair departs from a straight line along its lean.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Shape {
    /// Standard deviation of length over its mean.
    #[schemars(range(min = 0.0, max = 0.5))]
    pub length_variation: f32,
    /// How much more the tip leans along the comb than the root, degrees.
    #[schemars(range(min = 0.0, max = 120.0))]
    pub bend_deg: f32,
    /// Standard deviation of each hair's own lean in both tangent directions, degrees.
    #[schemars(range(min = 0.0, max = 45.0))]
    pub jitter_deg: f32,
    /// Sideways wander between root and tip over length.
    #[schemars(range(min = 0.0, max = 0.5))]
    pub noise: f32,
    /// Helix.
    pub curl: Curl,
    /// Cones.
    pub clump: Clump,
}

/// Guard hair: the long, thick hairs that are seen one by one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Guard {
    /// Hairs per cm² of skin, 0 for none.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub density_per_cm2: f32,
    /// Mean length along the hair.
    #[schemars(extend("mm" = [1e-3, 1e4], "relative" = [1e-5, 2.0]))]
    pub length: Length,
    /// Diameter at the root, µm.
    #[schemars(range(min = 0.1, max = 1e5))]
    pub diameter_um: f32,
    /// Diameter at the tip over that at the root.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub taper: f32,
    /// Transparency at the very tip; grows exponentially along the hair.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub tip_transparency: f32,
    /// Shape.
    pub shape: Shape,
}

/// Undercoat: the fine, dense hairs that are seen as a volume.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Undercoat {
    /// Hairs per cm² of skin, 0 for none.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub density_per_cm2: f32,
    /// Mean length along the hair.
    #[schemars(extend("mm" = [1e-3, 1e4], "relative" = [1e-5, 2.0]))]
    pub length: Length,
    /// Diameter, µm.
    #[schemars(range(min = 0.1, max = 1e5))]
    pub diameter_um: f32,
    /// Shape.
    pub shape: Shape,
}

/// How hair lies on the skin.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Groom {
    /// Direction of the comb.
    pub comb: Comb,
    /// Mean lean away from the normal along the comb, degrees.
    #[schemars(range(min = 0.0, max = 75.0))]
    pub lean_deg: f32,
    /// How far gravity pulls the lean towards the ground.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub gravity: f32,
    /// Points that hair turns around; where two reach, the nearer in terms of its reach decides.
    pub whorls: Vec<Whorl>,
    /// Brush strokes that comb what lies beside them; where two reach, the earlier decides, and whorls before all.
    pub strokes: Vec<Stroke>,
    /// Lines that hair falls away from; where two reach, the earlier decides, and whorls and strokes before all.
    pub partings: Vec<Parting>,
}

/// Whose hair colour it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum ColourSource {
    /// The asset's base colour (texture, factor, vertex colours) under the root; the preset's tint where it has none.
    Asset,
    /// The preset's tint everywhere.
    Preset,
}

/// Colour of hair and skin, linear RGB in [0, 1].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Colour {
    /// Where hair takes its colour from; a colour map decides before either.
    pub from: ColourSource,
    /// The preset's own hair colour.
    #[schemars(inner(range(min = 0.0, max = 1.0)))]
    pub tint: [f32; 3],
    /// Factors along a guard hair: root, middle, tip.
    #[schemars(inner(inner(range(min = 0.0, max = 1.0))))]
    pub guard: [[f32; 3]; 3],
    /// Factors along an undercoat hair: root, middle, tip.
    #[schemars(inner(inner(range(min = 0.0, max = 1.0))))]
    pub undercoat: [[f32; 3]; 3],
    /// Relative spread of brightness from hair to hair.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub variation: f32,
    /// Factor on the tint for the skin under the hair.
    #[schemars(inner(range(min = 0.0, max = 1.0)))]
    pub skin: [f32; 3],
}

impl Default for Curl {
    fn default() -> Self {
        Self { radius_mm: 0.0, turns: 0.0 }
    }
}

impl Default for Clump {
    fn default() -> Self {
        Self { spacing_mm: 2.5, strength: 0.0 }
    }
}

impl Default for Shape {
    fn default() -> Self {
        Self {
            length_variation: 0.1,
            bend_deg: 0.0,
            jitter_deg: 4.0,
            noise: 0.0,
            curl: Curl::default(),
            clump: Clump::default(),
        }
    }
}

impl Default for Guard {
    fn default() -> Self {
        Self {
            density_per_cm2: 400.0,
            length: Length::Mm(10.0),
            diameter_um: 80.0,
            taper: 0.25,
            tip_transparency: 0.0,
            shape: Shape::default(),
        }
    }
}

impl Default for Undercoat {
    fn default() -> Self {
        Self { density_per_cm2: 10_000.0, length: Length::Mm(5.0), diameter_um: 15.0, shape: Shape::default() }
    }
}

impl Default for Groom {
    fn default() -> Self {
        Self {
            comb: Comb::Tailward,
            lean_deg: 35.0,
            gravity: 0.1,
            whorls: Vec::new(),
            strokes: Vec::new(),
            partings: Vec::new(),
        }
    }
}

impl Default for Colour {
    fn default() -> Self {
        Self {
            from: ColourSource::Asset,
            tint: [0.35, 0.22, 0.12],
            guard: [[0.6; 3], [0.9; 3], [1.0; 3]],
            undercoat: [[0.7; 3], [0.8; 3], [0.9; 3]],
            variation: 0.2,
            skin: [0.5; 3],
        }
    }
}

impl Colour {
    /// The ramp of guard hair as vectors.
    pub fn guard_ramp(&self) -> [Vec3; 3] {
        self.guard.map(Vec3::from)
    }

    /// The ramp of undercoat as vectors.
    pub fn undercoat_ramp(&self) -> [Vec3; 3] {
        self.undercoat.map(Vec3::from)
    }
}
