//! Fibres whose laws are known: those of built-in presets, solved once. Others are solved when they are asked for.

use super::colour::Colouring;
use super::{Law, solve};
use crate::data::coat::LOOK;
use crate::error::Result;
use crate::shade::fibre::sample::Sampler;
use crate::shade::fibre::{Fibre, FibreModel, FibreParameters};
use serde::{Deserialize, Serialize};

/// Photons for a law that is not known.
pub const PHOTONS: usize = 400_000;

/// A hair's look: how its fibre scatters, what colours it can wear, and the law of fur of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Scattering {
    /// The fibre.
    pub fibre: Fibre,
    /// From colours to absorption.
    pub colouring: Colouring,
    /// What was scattered more than once.
    pub law: Law,
}

impl Scattering {
    /// Its numbers in the order in which shaders have them.
    pub fn packed(&self) -> [[f32; 4]; LOOK] {
        let mut numbers = [0.0_f32; 4 * LOOK];
        let (fibre, colouring, law) =
            (bytemuck::bytes_of(&self.fibre), bytemuck::bytes_of(&self.colouring), bytemuck::bytes_of(&self.law));
        let bytes: &mut [u8] = bytemuck::cast_slice_mut(&mut numbers);
        let end = bytes.len() - law.len();
        bytes[..fibre.len()].copy_from_slice(fibre);
        bytes[fibre.len()..fibre.len() + colouring.len()].copy_from_slice(colouring);
        bytes[end..].copy_from_slice(law);
        bytemuck::cast(numbers)
    }
}

/// A fibre as it is written, and its look.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Known {
    /// Its model.
    pub model: FibreModel,
    /// Its parameters.
    pub parameters: FibreParameters,
    /// What was found.
    pub scattering: Scattering,
}

impl Known {
    /// Solves a fibre: some seconds.
    pub fn solve(model: FibreModel, parameters: FibreParameters, photons: usize) -> Self {
        let fibre = Fibre::new(model, &parameters);
        let sampler = Sampler::new(&fibre);
        let colouring = Colouring::new(&fibre, &sampler);
        let law = solve::law(&fibre, &sampler, &colouring, photons);
        Self { model, parameters, scattering: Scattering { fibre, colouring, law } }
    }

    /// Whether this is that fibre: parameters count for the model `medulla` alone.
    pub fn is(&self, model: FibreModel, parameters: &FibreParameters) -> bool {
        self.model == model && (model != FibreModel::Medulla || self.parameters == *parameters)
    }
}

/// Those that come with the program, and whatever was solved since.
const KNOWN: &str = include_str!("known.json");

/// What came with the program.
///
/// # Errors
/// Where the table is damaged.
pub fn known() -> Result<Vec<Known>> {
    serde_json::from_str(KNOWN).map_err(|e| {
        crate::error::Error::input("the program's table of fibres is damaged")
            .with_found(e)
            .with_expected("its own JSON")
    })
}

/// The look of a fibre; solved where it did not come with the program.
///
/// # Errors
/// As [`known`].
pub fn scattering(model: FibreModel, parameters: &FibreParameters) -> Result<Scattering> {
    let found = known()?.into_iter().find(|known| known.is(model, parameters));
    Ok(found.unwrap_or_else(|| Known::solve(model, *parameters, PHOTONS)).scattering)
}
