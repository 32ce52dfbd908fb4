//! A fibre as a preset writes it.

use crate::error::{Error, Result};
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
    /// Index of refraction, 1.1 to 2; keratin has 1.55.
    pub index: f32,
    /// Roughness along the hair, 0.1 to 1: the width of highlights (β_m of Chiang et al. 2016).
    pub roughness: f32,
    /// Roughness around the hair, 0.1 to 1 (β_n).
    pub azimuthal_roughness: f32,
    /// Tilt of the cuticle's scales, degrees, 0 to 10.
    pub tilt_deg: f32,
    /// Diameter of the medulla over the hair's, 0 to 0.95.
    pub medulla: f32,
    /// Scatterings per hair radius of way through the medulla, 0 to 20.
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

impl Fibres {
    /// Checks every number against its range.
    ///
    /// # Errors
    /// Names the first key out of range.
    pub fn check(&self) -> Result<()> {
        self.guard.check("fibre.guard")?;
        self.undercoat.check("fibre.undercoat")
    }
}

impl Default for FibreParameters {
    /// A furred animal's: keratin, scales tilted as Marschner et al. 2003 measured, a wide medulla full of air.
    fn default() -> Self {
        Self { index: 1.55, roughness: 0.3, azimuthal_roughness: 0.4, tilt_deg: 3.0, medulla: 0.6, scattering: 1.2 }
    }
}

impl FibreParameters {
    /// Checks every number against its range; `table` is what the preset calls it.
    ///
    /// # Errors
    /// Names the first key out of range.
    pub fn check(&self, table: &str) -> Result<()> {
        for (key, value, low, high) in [
            ("index", self.index, 1.1, 2.0),
            ("roughness", self.roughness, 0.1, 1.0),
            ("azimuthal_roughness", self.azimuthal_roughness, 0.1, 1.0),
            ("tilt_deg", self.tilt_deg, 0.0, 10.0),
            ("medulla", self.medulla, 0.0, 0.95),
            ("scattering", self.scattering, 0.0, 20.0),
        ] {
            if !(low..=high).contains(&value) {
                return Err(Error::usage("a preset value is out of range")
                    .with_field(format!("{table}.{key}"))
                    .with_found(value)
                    .with_expected(format!("a number from {low} to {high}")));
            }
        }
        Ok(())
    }
}
