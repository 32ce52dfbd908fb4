//! Fibres whose laws are known: those of built-in presets, solved once. Others are solved when they are asked for.

use super::colour::Colouring;
use super::{Law, solve};
use crate::data::coat::LOOK;
use crate::error::{Error, Result};
use crate::shade::fibre::sample::Sampler;
use crate::shade::fibre::{Fibre, FibreModel, FibreParameters};
use serde::{Deserialize, Serialize};
use std::sync::{LazyLock, Mutex, MutexGuard, PoisonError};

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

/// Those that come with the program.
const KNOWN: &str = include_str!("known.json");

/// Those and what was solved since the program began.
static LEARNT: LazyLock<Result<Mutex<Vec<Known>>>> = LazyLock::new(|| known().map(Mutex::new));

fn learnt() -> Result<MutexGuard<'static, Vec<Known>>> {
    // A list that somebody panicked over is still whole: it only ever grows by whole entries.
    LEARNT.as_ref().map(|list| list.lock().unwrap_or_else(PoisonError::into_inner)).map_err(Clone::clone)
}

/// What comes with the program.
///
/// # Errors
/// Where the table is damaged.
pub fn known() -> Result<Vec<Known>> {
    let damaged = |error| {
        Error::input("the program's table of fibres is damaged").with_found(error).with_expected("its own JSON")
    };
    serde_json::from_str(KNOWN).map_err(damaged)
}

/// The look of a fibre that is known already.
///
/// # Errors
/// As [`known`].
pub fn find(model: FibreModel, parameters: &FibreParameters) -> Result<Option<Scattering>> {
    Ok(learnt()?.iter().find(|known| known.is(model, parameters)).map(|known| known.scattering))
}

/// Takes note of a look that was solved before, so that nobody solves it again.
///
/// # Errors
/// As [`known`].
pub fn learn(model: FibreModel, parameters: &FibreParameters, scattering: Scattering) -> Result<()> {
    let mut learnt = learnt()?;
    if !learnt.iter().any(|known| known.is(model, parameters)) {
        learnt.push(Known { model, parameters: *parameters, scattering });
    }
    Ok(())
}

/// The look of a fibre; solved, which takes seconds, where it is not known.
///
/// # Errors
/// As [`known`].
pub fn scattering(model: FibreModel, parameters: &FibreParameters) -> Result<Scattering> {
    if let Some(found) = find(model, parameters)? {
        return Ok(found);
    }
    let solved = Known::solve(model, *parameters, PHOTONS).scattering;
    learn(model, parameters, solved)?;
    Ok(solved)
}

/// The look of a fibre at once: where it is not known, its colours and its law are those of the fibre most like it that is.
///
/// # Errors
/// As [`known`].
pub fn nearest(model: FibreModel, parameters: &FibreParameters) -> Result<Scattering> {
    if let Some(found) = find(model, parameters)? {
        return Ok(found);
    }
    let unlike = |known: &Known| unlikeness(&known.parameters, parameters);
    let learnt = learnt()?;
    let of_model = learnt.iter().filter(|known| known.model == model);
    let nearest = of_model.min_by(|a, b| unlike(a).total_cmp(&unlike(b))).map(|known| known.scattering);
    Ok(Scattering { fibre: Fibre::new(model, parameters), ..nearest.unwrap_or_default() })
}

/// How far two fibres are from each other: 1 for what makes another animal of it.
fn unlikeness(a: &FibreParameters, b: &FibreParameters) -> f32 {
    let apart = [
        (a.index - b.index) / 0.1,
        (a.roughness - b.roughness) / 0.2,
        (a.azimuthal_roughness - b.azimuthal_roughness) / 0.2,
        (a.tilt_deg - b.tilt_deg) / 5.0,
        (a.medulla - b.medulla) / 0.3,
        (a.scattering - b.scattering) / 1.0,
    ];
    apart.iter().map(|x| x * x).sum()
}
