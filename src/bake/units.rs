//! What a unit of the input means.

use super::extent::{self, Extent};
use crate::asset::{Asset, Part};
use crate::error::{Error, Result};
use crate::preset::Preset;
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

/// Length of a unit of the file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Units {
    /// What is furred is as large as the animal that the preset describes, unless it is a small part of a figure; built-in
    /// samples are in metres.
    #[default]
    #[serde(rename = "auto")]
    Auto,
    /// Metres.
    #[serde(rename = "m")]
    Metres,
    /// Centimetres.
    #[serde(rename = "cm")]
    Centimetres,
    /// Millimetres.
    #[serde(rename = "mm")]
    Millimetres,
    /// Inches.
    #[serde(rename = "in")]
    Inches,
}

/// The chosen scale.
#[derive(Clone, Debug)]
pub struct Scale {
    /// Length of a unit of the file, m.
    pub metres_per_unit: f64,
    /// Bounding diagonal of what is furred at that scale, m.
    pub diagonal_m: f64,
    /// What to tell the user.
    pub note: Option<String>,
    /// What may not be as the user expects, one sentence each.
    pub warnings: Vec<String>,
}

/// From this many times as large as its furred parts on, a figure is not the animal that the preset describes.
const OTHER_CREATURE: f64 = 2.5;
/// Diagonals that figures of animals and people have, m.
const FIGURES_M: RangeInclusive<f64> = 0.1..=10.0;

/// Chooses the scale for fur on the `chosen` parts.
///
/// # Errors
/// When what is furred has no extent.
pub fn scale(units: Units, preset: &Preset, asset: &Asset, chosen: &[usize], sample: bool) -> Result<Scale> {
    let parts: Vec<&Part> = chosen.iter().map(|&i| &asset.parts[i]).collect();
    let furred = Extent::of(&parts);
    let diagonal = furred.diagonal_units();
    if !(diagonal.is_finite() && diagonal > 0.0) {
        return Err(Error::input("what is furred has no extent, so hair has no scale")
            .with_field("bounding diagonal")
            .with_found(diagonal)
            .with_expected("a positive number")
            .with_hint("check that the nodes' scales are not zero"));
    }
    let literal = |metres_per_unit: f64| (metres_per_unit, None, None);
    let (metres_per_unit, note, warning) = match units {
        Units::Auto if sample => literal(1.0),
        Units::Auto => automatic(preset, diagonal, Extent::of(&extent::figure(asset, chosen)).diagonal_units()),
        Units::Metres => literal(1.0),
        Units::Centimetres => literal(0.01),
        Units::Millimetres => literal(0.001),
        Units::Inches => literal(0.0254),
    };
    let specks = furred.with_specks_units.map(|whole| {
        format!(
            "specks far from all other fur are not measured: without them, what is furred is {diagonal:.4} units of the \
             file across, with them {whole:.4}"
        )
    });
    let ground = (units == Units::Auto).then(|| extent::ground(asset, chosen, OTHER_CREATURE)).flatten();
    let ground = ground.map(|(name, times)| {
        format!(
            "material {name:?} is flat and {times:.0} times as large as all else that is furred: if it is the ground, \
             choose what to fur with `material`, as it is measured with the rest"
        )
    });
    let warnings = warning.into_iter().chain(specks).chain(ground).collect();
    Ok(Scale { metres_per_unit, diagonal_m: diagonal * metres_per_unit, note, warnings })
}

/// Length of a unit, m, with a note or a warning, where what is furred and the figure that it belongs to have these
/// diagonals. As large as the preset says is what is furred, if it is most of its figure. A hat is not as large as the animal
/// whose fur it is made of, and of the one who wears it the preset says nothing: then the file's own unit decides.
fn automatic(preset: &Preset, furred: f64, figure: f64) -> (f64, Option<String>, Option<String>) {
    let (name, size_m) = (&preset.name, f64::from(preset.size_m));
    let fitted = size_m / furred;
    let says_otherwise = "`units` m|cm|mm|in says otherwise";
    if figure <= OTHER_CREATURE * furred {
        let note = format!(
            "one unit of the file is taken as {fitted:.4} m, so that what is furred is as large as the {name} that the \
             preset describes ({size_m:.2} m across); {says_otherwise}"
        );
        return (fitted, Some(note), None);
    }
    let times = figure / furred;
    let small = format!("what is furred is a small part of a figure that is {times:.1} times as large");
    let plausible = [(1.0, "metre"), (0.01, "centimetre"), (0.001, "millimetre")]
        .into_iter()
        .find(|(metres, _)| FIGURES_M.contains(&(figure * metres)));
    let Some((metres, unit)) = plausible else {
        let warning = format!(
            "{small}; no unit makes that as large as an animal or a person, so one unit of the file is taken as \
             {fitted:.4} m: what is furred is as large as the {name} that the preset describes ({size_m:.2} m across), and \
             the figure is {:.2} m across; {says_otherwise}",
            figure * fitted
        );
        return (fitted, None, Some(warning));
    };
    let warning = format!(
        "{small}, so the size of the {name} that the preset describes ({size_m:.2} m across) is not taken for it: the figure \
         would be {:.2} m across. One unit of the file is taken as a {unit}: what is furred is {:.2} m and the figure \
         {:.2} m across, and hair is in proportion to the figure. {says_otherwise}; `set` guard.length.mm=… and \
         undercoat.length.mm=… change hair alone",
        figure * fitted,
        furred * metres,
        figure * metres
    );
    (metres, None, Some(warning))
}

/// A warning where hair is so short or so long for what is furred that a unit is probably wrong.
pub fn length_warning(longest_m: f32, diagonal_m: f64) -> Option<String> {
    let share = f64::from(longest_m) / diagonal_m;
    (!(0.002..=0.5).contains(&share)).then(|| {
        format!(
            "the longest hair is {share:.4} of the diagonal of what is furred, outside 0.002 … 0.5: is `units` right?"
        )
    })
}
