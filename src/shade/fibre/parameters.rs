//! A fibre as a preset writes it.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Which published model scatters light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FibreModel {
    /// A rough cylinder of keratin around a medulla that scatters (Yan et al. 2017, roughness as Chiang et al. 2016).
    #[default]
    Medulla,
    /// The lobes of Sadeghi et al. 2010, as Andersen et al. 2016 light guard hair.
    Sadeghi,
    /// Kajiya and Kay 1989, as Andersen et al. 2016 light undercoat.
    KajiyaKay,
}

/// What a kind of hair is made of; read by the model `medulla` alone.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FibreParameters {
    /// Index of refraction; keratin has 1.55.
    #[schemars(range(min = 1.1, max = 2.0))]
    pub index: f32,
    /// Roughness along the hair: the width of highlights (β_m of Chiang et al. 2016).
    #[schemars(range(min = 0.1, max = 1.0))]
    pub roughness: f32,
    /// Roughness around the hair (β_n).
    #[schemars(range(min = 0.1, max = 1.0))]
    pub azimuthal_roughness: f32,
    /// Tilt of the cuticle's scales.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub tilt_deg: f32,
    /// Diameter of the medulla over the hair's.
    #[schemars(range(min = 0.0, max = 0.95))]
    pub medulla: f32,
    /// Scatterings per hair radius of way through the medulla.
    #[schemars(range(min = 0.0, max = 20.0))]
    pub scattering: f32,
}

/// Both kinds of hair of a preset.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Fibres {
    /// The model of both: `medulla`, `sadeghi` or `kajiya-kay`.
    pub model: FibreModel,
    /// Guard hair.
    pub guard: FibreParameters,
    /// Undercoat.
    pub undercoat: FibreParameters,
}

impl Default for FibreParameters {
    /// A furred animal's: keratin, scales tilted as Marschner et al. 2003 measured, a wide medulla full of air.
    fn default() -> Self {
        Self { index: 1.55, roughness: 0.3, azimuthal_roughness: 0.4, tilt_deg: 3.0, medulla: 0.6, scattering: 1.2 }
    }
}
