//! What is drawn of each asset for a report: a picture as a game shows it, and how far that is off its fur.

use crate::asset::Reading;
use crate::asset::coat::read_coat;
use crate::bake::picture::{Only, PictureRequest};
use crate::batch::outcome::Outcome;
use crate::batch::plan::Plan;
use crate::batch::results::Errors;
use crate::cli::report::measure::{Seen, Sight, measure};
use crate::error::{Error, Kind, Result};
use crate::hybrid::device::Device;
use crate::report::coat::keep::Keep;
use crate::report::coat::key::Key;
use crate::report::coat::views::Distance;
use crate::stage::file::Format;
use crate::stage::options::Options;
use crate::stage::rig::Rig;
use crate::viewer::{ViewOptions, turntable};
use std::path::Path;

/// Pixels along a side of each view of a picture; there are four.
const VIEW: u32 = 128;
/// Pixels along a side of what an error is measured from.
const MEASURED: u32 = 192;
/// From how many sides it is measured.
const SIDES: usize = 2;
/// Names the above, so that errors measured otherwise are not taken for these.
const METHOD: &str = "flip over floor, 192 px, 2 sides, studio, 1";

/// Four sides of a coat, as a PNG.
///
/// # Errors
/// Where the file cannot be read or nothing draws.
pub fn picture(file: &Path) -> Result<Vec<u8>> {
    let (asset, coat) = read_coat(file)?;
    let options = ViewOptions { stage: Options { size: [VIEW; 2], ..Options::default() }, ..ViewOptions::default() };
    turntable(&asset, &coat, &options, 4)?.encode(Format::Png)
}

/// How far an outcome's coat is off its fur: FLIP over the floor, as `report coat` has it. What was measured before is not drawn again.
///
/// # Errors
/// Where there is nothing that can be measured, or nothing draws.
pub fn flip(plan: &Plan, outcome: &Outcome) -> Result<f64> {
    let state = plan.state();
    let errors = Errors { state: &state, method: METHOD };
    if let Some(known) = errors.get(outcome) {
        return Ok(known);
    }
    let entry = &plan.entries[outcome.item];
    let recipe = &plan.recipes[entry.recipe];
    if !recipe.presets.is_empty() {
        return Err(Error::usage(
            "fur of several presets on materials is not drawn hair by hair, so its error is not measured",
        )
        .with_file(&entry.input));
    }
    let fur = PictureRequest {
        input: plan.input(entry).to_string_lossy().into_owned(),
        reading: Reading { lods: false, ..recipe.reading() },
        preset: recipe.preset.clone(),
        materials: recipe.materials.clone(),
        units: recipe.units,
        seed: recipe.seed,
        only: Only::Hybrid,
        pose: None,
    };
    let sight = Sight {
        coat: Key::default().with(&outcome.digest),
        fur,
        device: Device::Auto,
        size: [MEASURED; 2],
        lights: vec![Rig::Studio],
        distances: vec![Distance { times: 1.0, views: SIDES }],
    };
    let pictures = tempfile::tempdir()
        .map_err(|error| Error::new(Kind::Output, "a folder for pictures cannot be made").with_found(error))?;
    let Seen { report, .. } = measure(&plan.output(entry), sight, &mut Keep::open(pictures.path())?, &mut |_| {})?;
    let flip = report.summary.excess.flip;
    errors.put(outcome, flip)?;
    Ok(flip)
}
