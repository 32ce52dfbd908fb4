//! What a unit of the input means.

use crate::asset::Asset;
use crate::error::{Error, Result};
use crate::preset::Preset;

/// Length of a unit of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Units {
    /// The asset is as large as the animal that the preset describes; built-in samples are in metres.
    Auto,
    /// Metres.
    Metres,
    /// Centimetres.
    Centimetres,
    /// Millimetres.
    Millimetres,
    /// Inches.
    Inches,
}

/// The chosen scale.
#[derive(Clone, Debug)]
pub struct Scale {
    /// Length of a unit of the file, m.
    pub metres_per_unit: f64,
    /// Bounding diagonal of the asset at that scale, m.
    pub diagonal_m: f64,
    /// What to tell the user.
    pub note: Option<String>,
}

/// Chooses the scale.
///
/// # Errors
/// When the asset has no extent.
pub fn scale(units: Units, preset: &Preset, asset: &Asset, sample: bool) -> Result<Scale> {
    let diagonal = asset.diagonal_units;
    if !(diagonal.is_finite() && diagonal > 0.0) {
        return Err(Error::input("the asset has no extent, so hair has no scale")
            .with_field("bounding diagonal")
            .with_found(diagonal)
            .with_expected("a positive number")
            .with_hint("check that the nodes' scales are not zero"));
    }
    let metres_per_unit = match units {
        Units::Auto if sample => 1.0,
        Units::Auto => f64::from(preset.size_m) / diagonal,
        Units::Metres => 1.0,
        Units::Centimetres => 0.01,
        Units::Millimetres => 0.001,
        Units::Inches => 0.0254,
    };
    let diagonal_m = diagonal * metres_per_unit;
    let note = (units == Units::Auto && !sample).then(|| {
        format!(
            "one unit of the file is taken as {metres_per_unit:.4} m, so that the asset is as large as the {} that the \
             preset describes ({:.2} m across); `units` m|cm|mm|in says otherwise",
            preset.name, preset.size_m
        )
    });
    Ok(Scale { metres_per_unit, diagonal_m, note })
}

/// A warning where hair is so short or so long for its asset that a unit is probably wrong.
pub fn length_warning(longest_m: f32, diagonal_m: f64) -> Option<String> {
    let share = f64::from(longest_m) / diagonal_m;
    (!(0.002..=0.5).contains(&share)).then(|| {
        format!("the longest hair is {share:.4} of the asset's diagonal, outside 0.002 … 0.5: is `units` right?")
    })
}
