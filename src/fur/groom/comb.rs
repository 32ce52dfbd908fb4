//! What a preset says of the comb: a rule for all of the skin, and whorls, strokes and partings where it needs a hand.

use super::Length;
use crate::error::{Error, Result};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Where the comb direction comes from when neither map, mesh, whorl nor stroke gives one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Comb {
    /// Hair stands along the normal; beside maps, whorls and strokes it continues them.
    Upright,
    /// Towards the ground.
    Gravity,
    /// From head to tail: along −z, the rear of a glTF model, and a little down.
    Tailward,
    /// Continues what maps, whorls and strokes say as smoothly as can be; towards the ground where they say nothing.
    Smooth,
}

/// A place on the asset.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase", deny_unknown_fields)]
pub enum Place {
    /// Shares of the asset's bounding box: [0, 0, 0] is left, bottom, tail; [1, 1, 1] right, top, nose (x, y, z).
    Relative([f32; 3]),
    /// World coordinates of the file, rest pose, in its own units.
    Units([f64; 3]),
}

/// Places along a line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase", deny_unknown_fields)]
pub enum Line {
    /// Shares of the asset's bounding box, as those of a whorl.
    Relative(Vec<[f32; 3]>),
    /// World coordinates of the file, rest pose, in its own units.
    Units(Vec<[f64; 3]>),
}

impl Line {
    /// The places, one by one.
    pub fn places(&self) -> Vec<Place> {
        match self {
            Self::Relative(points) => points.iter().copied().map(Place::Relative).collect(),
            Self::Units(points) => points.iter().copied().map(Place::Units).collect(),
        }
    }
}

/// A point that hair turns around: a crown, a swirl.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Whorl {
    /// Its middle, on or near the skin.
    pub at: Place,
    /// How far it reaches; beyond, the comb decides.
    #[serde(default = "reach")]
    #[schemars(extend("mm" = [1e-3, 1e6], "relative" = [1e-4, 2.0]))]
    pub reach: Length,
    /// Angle between the hair and the way out from the middle, counter-clockwise seen from
    /// outside: 0 points away from the middle, 90 makes a ring, 180 points to it.
    #[serde(default = "spin_deg")]
    #[schemars(range(min = -180.0, max = 180.0))]
    pub spin_deg: f32,
}

/// A brush stroke: hair beside it lies along it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Stroke {
    /// The line that the brush takes, on or near the skin, from where hair comes to where it goes: two points and more.
    pub points: Line,
    /// How far to either side it combs.
    #[serde(default = "reach")]
    #[schemars(extend("mm" = [1e-3, 1e6], "relative" = [1e-4, 2.0]))]
    pub reach: Length,
}

/// A line from which hair falls away to both sides, beside it and not beyond its ends.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Parting {
    /// The line, on or near the skin: two points and more.
    pub points: Line,
    /// How far to either side hair falls away from it.
    #[serde(default = "reach")]
    #[schemars(extend("mm" = [1e-3, 1e6], "relative" = [1e-4, 2.0]))]
    pub reach: Length,
    /// Width of the bare strip along the line, 0 for none; what grew there stands beside it.
    #[serde(default = "width")]
    #[schemars(extend("mm" = [0.0, 1e6], "relative" = [0.0, 2.0]))]
    pub width: Length,
    /// Angle between the hair and the way straight off the line: 90 lies along the line, -90 against it.
    #[serde(default)]
    #[schemars(range(min = -90.0, max = 90.0))]
    pub angle_deg: f32,
}

fn width() -> Length {
    Length::Relative(0.01)
}

fn reach() -> Length {
    Length::Relative(0.1)
}

fn spin_deg() -> f32 {
    60.0
}

/// Shares of the bounding box further out than this are a mistake.
const OUTSIDE: std::ops::RangeInclusive<f32> = -0.5..=1.5;

fn fault(field: String, found: impl std::fmt::Display, expected: &str) -> Error {
    Error::usage("a preset value is out of range").with_field(field).with_found(found).with_expected(expected)
}

fn check_point(field: String, place: Place) -> Result<()> {
    match place {
        Place::Relative(p) if !p.iter().all(|x| OUTSIDE.contains(x)) => {
            Err(fault(format!("{field}.relative"), format!("{p:?}"), "three shares of the bounding box, -0.5 to 1.5")
                .with_hint("0 to 1 is inside the box; `units` takes coordinates of the file instead"))
        }
        Place::Units(p) if !p.iter().all(|x| x.is_finite()) => {
            Err(fault(format!("{field}.units"), format!("{p:?}"), "three finite numbers"))
        }
        _ => Ok(()),
    }
}

fn check_line(field: &str, line: &Line) -> Result<()> {
    let places = line.places();
    if places.len() < 2 {
        return Err(fault(format!("{field}.points"), format!("{} points", places.len()), "two points and more"));
    }
    for (i, pair) in places.windows(2).enumerate() {
        if pair[0] == pair[1] {
            let twice = format!("points {i} and {} in one place", i + 1);
            return Err(fault(format!("{field}.points"), twice, "points that lead from one to the next"));
        }
    }
    for (i, &place) in places.iter().enumerate() {
        check_point(format!("{field}.points[{i}]"), place)?;
    }
    Ok(())
}

impl Whorl {
    /// Checks where it is; `field` names the whorl.
    ///
    /// # Errors
    /// Names the key out of range.
    pub fn check(&self, field: &str) -> Result<()> {
        check_point(format!("{field}.at"), self.at)
    }
}

impl Stroke {
    /// Checks that the line leads somewhere; `field` names the stroke.
    ///
    /// # Errors
    /// Names the key out of range.
    pub fn check(&self, field: &str) -> Result<()> {
        check_line(field, &self.points)
    }
}

impl Parting {
    /// Checks that the line leads somewhere; `field` names the parting.
    ///
    /// # Errors
    /// Names the key out of range.
    pub fn check(&self, field: &str) -> Result<()> {
        check_line(field, &self.points)
    }
}
